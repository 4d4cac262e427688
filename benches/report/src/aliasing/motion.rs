//! What flickers while the camera moves.

use std::path::PathBuf;

use bevy::math::{DAffine3, DVec2, DVec3, UVec2, dvec2};
use fluid_reference::{
    Camera, Image,
    metrics::{Front, MetricError, mean, mean_difference},
};

use super::{
    OFF,
    truth::{Supersampled, kept_or_drawn},
};
use crate::{Options, ReportError, rig::Rig};

/// Pictures in a row.
const FRAMES: u32 = 16;
/// The same where it is to be quick.
const QUICK_FRAMES: u32 = 4;
/// The first of them, whose truth is drawn.
const TRUE_FRAMES: u32 = 4;
/// Pictures whose mean is the truth of one in a row: fewer than at rest, as there are many.
const JITTERS: u32 = 32;

/// How the camera moves from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    /// A tenth of a pixel sideways, along no row or column.
    Shift,
    /// 0.1° around the liquid.
    Orbit,
}

/// A path, and what is true along it.
pub(super) struct Walk {
    pub(super) path: Path,
    cameras: Vec<Camera>,
    /// Of the first cameras.
    truths: Vec<Supersampled>,
}

/// What is seen from frame to frame, of the pixels that hold liquid.
pub(super) struct Motion {
    /// The mean difference of a frame from the one before, over the truth's.
    ///
    /// A mean of few pictures flickers too: what it changes by falls to the truth's as the inverse of
    /// their number, so that twice that of all less that of a half is near the truth's. (Of the knot
    /// that is 0.0125 for 32 pictures, which alone change by 0.0168; 256 change by 0.0127.)
    pub(super) ratio: f64,
    /// Share that changes by more than [`OFF`] where the truth changes by less than half as much.
    pub(super) pops: f64,
    /// Share whose coverage changes by more than a half.
    pub(super) flips: f64,
}

impl Path {
    pub(super) const ALL: [Self; 2] = [Self::Shift, Self::Orbit];

    /// What the table calls the parts of a [`Motion`].
    pub(super) fn quantities(self) -> [&'static str; 3] {
        match self {
            Self::Shift => ["shift_difference", "shift_pops", "shift_flips"],
            Self::Orbit => ["orbit_difference", "orbit_pops", "orbit_flips"],
        }
    }

    /// Draws what is true along the path of a camera that looks at something so far away, m.
    pub(super) fn walk(
        self,
        rig: &mut Rig,
        camera: &Camera,
        distance: f64,
        options: &Options,
        keep: impl Fn(&str) -> Option<PathBuf>,
    ) -> Result<Walk, ReportError> {
        let frames = if options.quick { QUICK_FRAMES } else { FRAMES };
        let jitters = options.jitters().min(JITTERS);
        let cameras: Vec<_> = (0..frames)
            .map(|i| self.place(camera, distance, f64::from(i)))
            .collect();
        let name = self.quantities()[0];
        let true_ones = cameras.iter().take(TRUE_FRAMES as usize);
        let truths = true_ones.enumerate().map(|(i, at)| {
            let kept = keep(&format!("{name}-{i}-{jitters}"));
            kept_or_drawn(rig, at, jitters, kept.as_deref())
        });
        Ok(Walk {
            path: self,
            truths: truths.collect::<Result<_, _>>()?,
            cameras,
        })
    }

    fn place(self, camera: &Camera, distance: f64, frame: f64) -> Camera {
        let view = camera.world_from_view;
        let moved = match self {
            Self::Shift => {
                let way = dvec2(0.8, 0.6) * 0.1 * frame * camera.pixel_size(distance);
                DAffine3::from_translation(view.transform_vector3(way.extend(0.0)))
            }
            Self::Orbit => {
                let center = view.transform_point3(DVec3::NEG_Z * distance);
                DAffine3::from_translation(center)
                    * DAffine3::from_rotation_y((0.1 * frame).to_radians())
                    * DAffine3::from_translation(-center)
            }
        };
        Camera {
            world_from_view: moved * view,
            ..*camera
        }
    }
}

/// How far away the liquid is in the middle, m.
pub(super) fn distance(camera: &Camera, fronts: &Image<Option<Front>>) -> f64 {
    let fronts = fronts.pixels().iter().flatten();
    let mut depths: Vec<f64> = fronts.map(|front| front.view_depth).collect();
    if depths.is_empty() {
        return camera.world_from_view.translation.length();
    }
    let middle = depths.len() / 2;
    *depths.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Draws along a path and compares with what is true there.
pub(super) fn measure(
    rig: &mut Rig,
    walk: &Walk,
    wrong: impl Fn(MetricError) -> ReportError,
) -> Result<Motion, ReportError> {
    let mut frames = Vec::new();
    for camera in &walk.cameras {
        rig.aim(camera, DVec2::ZERO);
        rig.frame();
        frames.push((rig.picture()?, rig.coverage()?));
    }
    // So little does the camera move that the first frame's liquid is that of all.
    let liquid = walk.truths[0].coverage.map(|covered| *covered > 0.0);
    let liquid = Some(&liquid);
    let (pictures, coverages): (Vec<_>, Vec<_>) = frames.into_iter().unzip();
    let [whole, half]: [Vec<_>; 2] = [
        walk.truths.iter().map(|truth| &truth.image).collect(),
        walk.truths.iter().map(|truth| &truth.half).collect(),
    ];
    let difference = |a: &Picture, b: &Picture| mean_difference(a, b, liquid);
    let drawn = over_pairs(&pictures, difference).map_err(&wrong)?;
    let whole_difference = over_pairs(&whole, |a, b| difference(a, b)).map_err(&wrong)?;
    let half_difference = over_pairs(&half, |a, b| difference(a, b)).map_err(&wrong)?;
    let true_one = (2.0 * whole_difference - half_difference).max(0.1 * whole_difference);

    let share = |is: &(dyn Fn(UVec2) -> bool + Sync)| {
        let map = Image::from_fn(walk.cameras[0].size, |pixel| f64::from(is(pixel)));
        mean("motion", &map, liquid)
    };
    let change = |[a, b]: [&Picture; 2], pixel| (*a.get(pixel) - *b.get(pixel)).abs().max_element();
    let judged: Vec<_> = pictures.iter().zip(whole).collect();
    let pops = over_pairs(&judged, |(a, true_a), (b, true_b)| {
        share(&|pixel| change([a, b], pixel) > OFF && change([true_a, true_b], pixel) < 0.5 * OFF)
    });
    let flips = over_pairs(&coverages, |a, b| {
        share(&|pixel| (*a.get(pixel) - *b.get(pixel)).abs() > 0.5)
    });
    Ok(Motion {
        ratio: drawn / true_one.max(f64::MIN_POSITIVE),
        pops: pops.map_err(&wrong)?,
        flips: flips.map_err(&wrong)?,
    })
}

type Picture = Image<DVec3>;

/// The mean of what is measured of each two in a row.
fn over_pairs<T>(
    items: &[T],
    of: impl Fn(&T, &T) -> Result<f64, MetricError>,
) -> Result<f64, MetricError> {
    let pairs = items.windows(2).map(|pair| of(&pair[0], &pair[1]));
    let sum = pairs.sum::<Result<f64, _>>()?;
    Ok(sum / (items.len() - 1).max(1) as f64)
}
