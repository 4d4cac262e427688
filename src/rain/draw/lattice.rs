//! Which voxels around the eye are drawn. They stand still in the world but for the wind; only what
//! they show falls. So the camera may move at any speed.

use bevy::{math::DVec3, prelude::*};

use super::gpu_types::{GpuQuad, LEVEL_COUNT};
use crate::rain::clock::RainClock;

/// Voxels of one size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// Up to here, across the fall, a perspective view shows every drop by itself: there streaks are told
/// apart, and drops of a size fall at a speed of their own. Unit: m.
pub(crate) const NEAR: f32 = 2.0;

/// Voxels of streaks, from [`NEAR`] on, or from the eye on where all rays are parallel. A voxel shows
/// its drops as if all were at its middle.
pub(crate) const LEVELS: [Level; LEVEL_COUNT] = [
    level(2.0, NEAR, 6.0),
    level(4.0, 6.0, 14.0),
    level(8.0, 14.0, 30.0),
    level(16.0, 30.0, 126.0),
];

/// Cells of drops one by one: small ones, for few drops are drawn beyond the view.
pub(crate) const NEAR_CELLS: Level = level(0.5, 0.0, NEAR);
/// The same however far away they are: larger ones, for they are many.
pub(crate) const ALL_CELLS: Level = level(1.0, 0.0, f32::INFINITY);

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

/// What voxels hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Content {
    /// A billboard.
    Streaks,
    /// Streaks of at most this length, which may reach out of their voxel. Unit: m.
    Drops(f32),
}

impl Content {
    /// How far from a voxel's centre there is anything of it: the corners of a cube, stretched along
    /// the fall, and what streaks are longer. Unit: m.
    pub(crate) fn reach(self, size: f32, axis: Vec3) -> f32 {
        0.87 * size / axis.y + self.longest()
    }

    fn longest(self) -> f32 {
        match self {
            Self::Streaks => 0.0,
            Self::Drops(longest) => longest,
        }
    }
}

/// Adds the voxels in view to `quads`, level by level. `keep` may refuse one or change it. Returns
/// whether there were too many.
pub(crate) fn add_voxels(
    quads: &mut Vec<GpuQuad>,
    eye: &Eye,
    clock: &RainClock,
    levels: &[Level],
    content: Content,
    distance: f32,
    mut keep: impl FnMut(&mut GpuQuad) -> bool,
) -> bool {
    let axis = fall_axis(clock.lean);
    for (index, level) in levels.iter().enumerate() {
        if level.start >= distance {
            break;
        }
        let size = f64::from(level.size);
        let cells =
            |low: f64, high: f64| (low / size).floor() as i64..=(high / size).floor() as i64;
        let heights = cells(
            eye.position.y + f64::from(eye.low.y - content.longest()),
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
                let margin = 0.5 * level.size + content.longest();
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
                    let Some(radius) = radius_in(eye, level, content, center, axis, distance)
                    else {
                        continue;
                    };
                    let base = center_y - 0.5 * size;
                    let mut quad = GpuQuad {
                        center,
                        size: level.size,
                        radius,
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
    false
}

/// The distance of a voxel's centre from the eye, across the fall; `None` where it is not seen or
/// not of this level.
fn radius_in(
    eye: &Eye,
    level: &Level,
    content: Content,
    center: Vec3,
    axis: Vec3,
    distance: f32,
) -> Option<f32> {
    let half = 0.5 * level.size;
    let across = |way: Vec3| way - way.dot(axis) * axis;
    let (radius, nearest, farthest) = if !eye.perspective {
        let radius = center.dot(across(eye.forward).try_normalize()?);
        (radius, radius - half, radius + half)
    } else if center.length() > distance + level.size {
        return None;
    } else {
        let radius = across(center).length();
        match content {
            // The billboard turns with the direction to its centre: at the centre it has none.
            Content::Streaks if radius < 0.1 * level.size => return None,
            // The billboard's ends are farther away, and it stands for what is behind it, too.
            Content::Streaks => (radius, radius - half, radius.hypot(half) + half),
            // Corners of a square.
            Content::Drops(_) => (radius, radius - 1.42 * half, radius + 1.42 * half),
        }
    };
    let within = nearest < level.end.min(distance) && farthest > level.start;
    (within && eye.sees(center, content.reach(level.size, axis))).then_some(radius)
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
