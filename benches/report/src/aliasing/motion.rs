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
/// Pictures whose mean is the truth of one in a row: fewer than at rest, as there are many. What is
/// left of their own flicker makes ratios too small rather than too large.
const JITTERS: u32 = 16;

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
    truths: Vec<Supersampled>,
}

/// What is seen from frame to frame, of the pixels that hold liquid in either.
pub(super) struct Motion {
    /// The mean difference of a frame from the one before, over the truth's.
    pub(super) ratio: f64,
    /// Share that changes by more than [`OFF`] where the truth changes by less than half as much.
    pub(super) pops: f64,
    /// Share whose middle becomes liquid or ceases to be.
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
        let truths = cameras.iter().enumerate().map(|(i, at)| {
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
    for (camera, truth) in walk.cameras.iter().zip(&walk.truths) {
        rig.aim(camera, DVec2::ZERO);
        rig.frame();
        frames.push(Frame {
            picture: rig.picture()?,
            there: rig.fronts()?.map(Option::is_some),
            truth,
        });
    }
    let mut sums = [0.0; 4];
    for pair in frames.windows(2) {
        let changes = changes(&pair[0], &pair[1]).map_err(&wrong)?;
        for (sum, change) in sums.iter_mut().zip(changes) {
            *sum += change;
        }
    }
    let pairs = (frames.len() - 1).max(1) as f64;
    let [drawn, true_one, pops, flips] = sums.map(|sum| sum / pairs);
    Ok(Motion {
        ratio: drawn / true_one.max(f64::MIN_POSITIVE),
        pops,
        flips,
    })
}

/// What is seen from a place.
struct Frame<'a> {
    picture: Image<DVec3>,
    /// Where the middle of a pixel shows liquid.
    there: Image<bool>,
    truth: &'a Supersampled,
}

/// From one frame to the next: the mean difference, that of the truth, and the shares of pixels that
/// pop and flip.
fn changes(a: &Frame, b: &Frame) -> Result<[f64; 4], MetricError> {
    let size = a.picture.size();
    let liquid = Image::from_fn(size, |pixel| {
        let covered = |frame: &Frame| *frame.truth.coverage.get(pixel) > 0.0;
        covered(a) || covered(b)
    });
    let most = |a: &Image<DVec3>, b: &Image<DVec3>, pixel| {
        (*a.get(pixel) - *b.get(pixel)).abs().max_element()
    };
    let (true_a, true_b) = (&a.truth.image, &b.truth.image);
    let pops = |pixel: UVec2| {
        most(&a.picture, &b.picture, pixel) > OFF && most(true_a, true_b, pixel) < 0.5 * OFF
    };
    let flips = |pixel: UVec2| a.there.get(pixel) != b.there.get(pixel);
    let pops = Image::from_fn(size, |pixel| f64::from(pops(pixel)));
    let flips = Image::from_fn(size, |pixel| f64::from(flips(pixel)));
    let mask = Some(&liquid);
    Ok([
        mean_difference(&a.picture, &b.picture, mask)?,
        mean_difference(true_a, true_b, mask)?,
        mean("pops", &pops, mask)?,
        mean("flips", &flips, mask)?,
    ])
}
