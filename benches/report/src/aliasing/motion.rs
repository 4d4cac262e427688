//! What flickers while the camera moves.

use bevy::math::{DAffine3, DVec2, DVec3, dvec2};
use fluid_reference::{
    Camera, Image,
    metrics::{Front, MetricError, mean, mean_difference},
};

use super::{OFF, truth::Supersampled};
use crate::{ReportError, rig::Rig, scenes::Scene};

/// Pictures in a row.
const FRAMES: u32 = 16;
/// Pictures whose mean is the truth of one in a row: fewer than at rest, as there are many. What is
/// left of their own flicker makes ratios too small rather than too large.
pub(super) const JITTERS: u32 = 16;

/// How the camera moves from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Path {
    /// A tenth of a pixel sideways, along no row or column.
    Shift,
    /// 0.1° around the liquid.
    Orbit,
}

/// What is seen from frame to frame.
pub(crate) struct Motion {
    /// The mean difference of a frame from the one before, over the truth's.
    pub(crate) ratio: f64,
    /// Share of the liquid's pixels that change by more than [`OFF`] where the truth changes by less
    /// than half as much.
    pub(crate) pops: f64,
    /// Share of pixels whose middle becomes liquid or ceases to be.
    pub(crate) flips: f64,
}

impl Path {
    pub(crate) const ALL: [Self; 2] = [Self::Shift, Self::Orbit];

    /// Places of a camera that looks at something so far away, m.
    pub(super) fn cameras(self, camera: &Camera, distance: f64) -> Vec<Camera> {
        let view = camera.world_from_view;
        let place = |i: u32| {
            let i = f64::from(i);
            let moved = match self {
                Self::Shift => {
                    let way = dvec2(0.8, 0.6) * 0.1 * i * camera.pixel_size(distance);
                    DAffine3::from_translation(view.transform_vector3(way.extend(0.0)))
                }
                Self::Orbit => {
                    let center = view.transform_point3(DVec3::NEG_Z * distance);
                    DAffine3::from_translation(center)
                        * DAffine3::from_rotation_y((0.1 * i).to_radians())
                        * DAffine3::from_translation(-center)
                }
            };
            Camera {
                world_from_view: moved * view,
                ..*camera
            }
        };
        (0..FRAMES).map(place).collect()
    }
}

/// How far away the liquid is in the middle, m.
pub(super) fn distance(scene: &Scene, fronts: &Image<Option<Front>>) -> f64 {
    let mut depths: Vec<f64> = fronts
        .pixels()
        .iter()
        .flatten()
        .map(|f| f.view_depth)
        .collect();
    if depths.is_empty() {
        return scene.camera.world_from_view.translation.length();
    }
    let middle = depths.len() / 2;
    *depths.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Draws from each place and compares with what is true there.
pub(super) fn measure(
    rig: &mut Rig,
    cameras: &[Camera],
    truths: &[Supersampled],
    wrong: impl Fn(MetricError) -> ReportError,
) -> Result<Motion, ReportError> {
    let mut frames = Vec::new();
    for camera in cameras {
        rig.aim(camera, DVec2::ZERO);
        rig.frame();
        frames.push((rig.picture()?, rig.fronts()?.map(Option::is_some)));
    }
    let (mut drawn, mut true_one, mut pops, mut flips) = (0.0, 0.0, 0.0, 0.0);
    for (pair, truth) in frames.windows(2).zip(truths.windows(2)) {
        let ([(a, there_a), (b, there_b)], [truth_a, truth_b]) = (pair, truth) else {
            continue;
        };
        let liquid = Image::from_fn(a.size(), |pixel| {
            truth.iter().any(|truth| *truth.coverage.get(pixel) > 0.0)
        });
        let liquid = Some(&liquid);
        drawn += mean_difference(a, b, liquid).map_err(&wrong)?;
        let (true_a, true_b) = (&truth_a.image, &truth_b.image);
        true_one += mean_difference(true_a, true_b, liquid).map_err(&wrong)?;
        let share = |of: &(dyn Fn(bevy::math::UVec2) -> bool + Sync)| {
            let map = Image::from_fn(a.size(), |pixel| f64::from(of(pixel)));
            mean("motion", &map, liquid)
        };
        let change = |a: &Image<DVec3>, b: &Image<DVec3>, pixel| {
            (*a.get(pixel) - *b.get(pixel)).abs().max_element()
        };
        pops +=
            share(&|pixel| change(a, b, pixel) > OFF && change(true_a, true_b, pixel) < 0.5 * OFF)
                .map_err(&wrong)?;
        flips += share(&|pixel| there_a.get(pixel) != there_b.get(pixel)).map_err(&wrong)?;
    }
    let pairs = f64::from(FRAMES - 1);
    Ok(Motion {
        ratio: drawn / true_one.max(f64::MIN_POSITIVE),
        pops: pops / pairs,
        flips: flips / pairs,
    })
}
