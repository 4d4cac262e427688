//! Which voxels around the eye are drawn. They stand still in the world but for the wind; only what
//! they show falls. So the camera may move at any speed.

use bevy::{math::DVec3, prelude::*};

use super::gpu_types::{GpuQuad, LEVEL_COUNT};
use crate::rain::clock::RainClock;

/// Voxels of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Level {
    /// Side of a voxel. Unit: m.
    pub(crate) size: f32,
    /// The distances from the eye, across the fall, for which they stand. Unit: m.
    pub(crate) start: f32,
    pub(crate) end: f32,
}

const fn level(size: f32, start: f32, end: f32) -> Level {
    Level { size, start, end }
}

/// Small voxels near the eye, where their lack of depth would show. From the third on, all drops
/// fall together (`MERGED_FROM` of `types.wgsl`): their streaks are a pixel wide.
pub(crate) const LEVELS: [Level; LEVEL_COUNT] = [
    level(0.5, 0.0, 1.0),
    level(1.0, 1.0, 2.0),
    level(2.0, 2.0, 6.0),
    level(4.0, 6.0, 14.0),
    level(8.0, 14.0, 30.0),
    level(16.0, 30.0, 126.0),
];

impl Level {
    /// Billboards nearer than half their width are met only by rays near their middle: what is
    /// lost by that around the eye, as a factor on what is left.
    pub(crate) fn gain(&self, distance: f32) -> f32 {
        if self.start > 0.0 {
            return 1.0;
        }
        let end = self.end.min(distance);
        end / (end - 0.25 * self.size)
    }
}

/// More than this are not drawn: only a very wide orthographic view asks for them.
pub(crate) const MAX_QUADS: usize = 1 << 16;

/// What sees the voxels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    pub(crate) position: DVec3,
    pub(crate) forward: Vec3,
    pub(crate) perspective: bool,
    /// Planes with normals to the inside, relative to the eye.
    planes: [Vec4; 4],
    /// A box around what is seen up to the distance, relative to the eye.
    low: Vec3,
    high: Vec3,
}

impl Eye {
    /// `None` for matrices that make no sense.
    pub(crate) fn new(
        world_from_view: &GlobalTransform,
        clip_from_view: &Mat4,
        distance: f32,
    ) -> Option<Self> {
        let rotation = world_from_view.rotation();
        let clip_from_relative = *clip_from_view * Mat4::from_quat(rotation.inverse());
        let relative_from_clip = clip_from_relative.inverse();
        let forward = rotation * Vec3::NEG_Z;
        let perspective = clip_from_view.w_axis.w != 1.0;
        let row = |i| clip_from_relative.row(i);
        let planes = [
            row(3) + row(0),
            row(3) - row(0),
            row(3) + row(1),
            row(3) - row(1),
        ]
        .map(|plane| plane / plane.truncate().length());
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            // Two points of the ray, both at finite distances in every projection.
            let near = relative_from_clip.project_point3(vec3(x, y, 1.0));
            let way = relative_from_clip.project_point3(vec3(x, y, 0.5)) - near;
            let far = near + way * ((distance - near.dot(forward)) / way.dot(forward));
            low = low.min(near).min(far);
            high = high.max(near).max(far);
        }
        if perspective {
            (low, high) = (
                low.max(Vec3::splat(-distance)),
                high.min(Vec3::splat(distance)),
            );
        }
        let eye = Self {
            position: world_from_view.translation().as_dvec3(),
            forward,
            perspective,
            planes,
            low,
            high,
        };
        let finite = eye.position.is_finite()
            && low.is_finite()
            && high.is_finite()
            && planes.iter().all(|plane| plane.is_finite());
        finite.then_some(eye)
    }

    fn sees(&self, center: Vec3, radius: f32) -> bool {
        self.planes
            .iter()
            .all(|plane| plane.truncate().dot(center) + plane.w >= -radius)
            && center.dot(self.forward) >= -radius
    }
}

/// Where drops of mean speed come from: up, of unit length.
pub(crate) fn fall_axis(lean: Vec2) -> Vec3 {
    vec3(-lean.x, 1.0, -lean.y).normalize()
}

/// Replaces `quads` by the voxels in view, far ones first. `keep` may refuse one or change it.
/// Returns whether there were too many.
pub(crate) fn fill(
    quads: &mut Vec<GpuQuad>,
    eye: &Eye,
    clock: &RainClock,
    levels: &[Level],
    distance: f32,
    mut keep: impl FnMut(&mut GpuQuad) -> bool,
) -> bool {
    quads.clear();
    let axis = fall_axis(clock.lean);
    for (index, level) in levels.iter().enumerate() {
        if level.start >= distance {
            break;
        }
        let size = f64::from(level.size);
        let cells =
            |low: f64, high: f64| (low / size).floor() as i64..=(high / size).floor() as i64;
        let heights = cells(
            eye.position.y + f64::from(eye.low.y),
            eye.position.y + f64::from(eye.high.y),
        );
        let end = level.end.min(distance);
        for y in heights {
            let center_y = (y as f64 + 0.5) * size;
            let relative_y = (center_y - eye.position.y) as f32;
            // Where the column with index 0 stands at this height.
            let shift = clock.anchor - clock.lean.as_dvec2() * (center_y - clock.height);
            let shift = [shift.x - eye.position.x, shift.y - eye.position.z];
            let range = |side: usize| {
                let i = 2 * side;
                let (mut low, mut high) = (eye.low[i], eye.high[i]);
                if eye.perspective {
                    // Around the axis through the eye.
                    let middle = -clock.lean[side] * relative_y;
                    let reach = end / axis.y + level.size;
                    (low, high) = (low.max(middle - reach), high.min(middle + reach));
                }
                // A cell whose border is just outside may reach in.
                let margin = 0.5 * level.size;
                cells(
                    f64::from(low - margin) - shift[side],
                    f64::from(high + margin) - shift[side],
                )
            };
            for x in range(0) {
                for z in range(1) {
                    let center = vec3(
                        ((x as f64 + 0.5) * size + shift[0]) as f32,
                        relative_y,
                        ((z as f64 + 0.5) * size + shift[1]) as f32,
                    );
                    let Some(radius) = radius_in(eye, level, center, axis, distance) else {
                        continue;
                    };
                    let base = center_y - 0.5 * size;
                    let mut quad = GpuQuad {
                        center,
                        size: level.size,
                        radius,
                        base: (base - clock.height) as f32,
                        fraction: (base - base.floor()) as f32,
                        tile: base.floor() as i64 as i32,
                        hash: hash([x as u32, z as u32, index as u32]),
                        lamps: 0,
                        level: index as u32,
                    };
                    if keep(&mut quad) {
                        quads.push(quad);
                    }
                }
            }
            if quads.len() > MAX_QUADS {
                quads.truncate(MAX_QUADS);
                return true;
            }
        }
    }
    quads.sort_unstable_by(|a, b| b.radius.total_cmp(&a.radius));
    false
}

/// The distance of a voxel's centre from the eye, across the fall; `None` where it is not seen or
/// not of this level.
fn radius_in(eye: &Eye, level: &Level, center: Vec3, axis: Vec3, distance: f32) -> Option<f32> {
    let half = 0.5 * level.size;
    let across = |way: Vec3| way - way.dot(axis) * axis;
    let (radius, farthest) = if eye.perspective {
        let radius = across(center).length();
        // The billboard turns with the direction to its centre: at the centre it has none.
        if radius < 0.1 * level.size || center.length() > distance + level.size {
            return None;
        }
        (radius, radius.hypot(half))
    } else {
        let radius = center.dot(across(eye.forward).try_normalize()?);
        (radius, radius)
    };
    // Corners of a cube, stretched along the fall.
    let reach = 0.87 * level.size / axis.y;
    let within = radius - half < level.end.min(distance) && farthest + half > level.start;
    (within && eye.sees(center, reach)).then_some(radius)
}

fn hash(words: [u32; 3]) -> u32 {
    words.into_iter().fold(0x2545_F491, |state: u32, word| {
        let mut h = (state ^ word).wrapping_mul(0x9E37_79B1);
        h = (h ^ (h >> 15)).wrapping_mul(0x85EB_CA77);
        h ^ (h >> 13)
    })
}

#[cfg(test)]
mod tests;
