//! Selection of the voxels around the eye. Voxels are fixed in the world except for the wind; only
//! their contents fall. So the camera may move at any speed.

use bevy::{math::DVec3, prelude::*};

use super::gpu_types::{GpuQuad, LEVEL_COUNT};
use crate::rain::clock::RainClock;

/// Voxels of one size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Level {
    /// Side of a voxel. Unit: m.
    pub(crate) size: f32,
    /// The range of distances from the eye, across the fall, that they represent. Unit: m.
    pub(crate) start: f32,
    pub(crate) end: f32,
}

const fn level(size: f32, start: f32, end: f32) -> Level {
    Level { size, start, end }
}

/// Distance across the fall up to which a perspective view draws every drop individually: there
/// streaks can be distinguished, and each drop falls at the speed of its size. Unit: m.
pub(crate) const NEAR: f32 = 2.0;

/// Largest distance of individually drawn drops in any direction, since [`NEAR`] has no end along
/// the fall: seen along it, drops are points, which fade (see `backdrop.wgsl`). Unit: m.
pub(crate) const NEAR_REACH: f32 = 8.0;

/// Sine of the angle between a ray and the fall below which streaks are points and their opacity no
/// longer grows. Parallel rays this steep meet no billboards at all.
pub(crate) const STEEPEST: f32 = 0.15;

/// Voxels of streaks, from [`NEAR`] on, or from the eye on where all rays are parallel. A voxel
/// shows its drops as if all were at its middle; where a level ends, voxels before the end also
/// represent those that reach in from behind it (see `part_of_voxel` in `billboards.wgsl`).
pub(crate) const LEVELS: [Level; LEVEL_COUNT] = [
    level(2.0, NEAR, 6.0),
    level(4.0, 6.0, 14.0),
    level(8.0, 14.0, 30.0),
    level(16.0, 30.0, 126.0),
];

/// Cells of individually drawn drops: small, so that few drops out of view are processed.
pub(crate) const NEAR_CELLS: Level = level(0.25, 0.0, NEAR);
/// The same at any distance: larger, because there are many.
pub(crate) const ALL_CELLS: Level = level(1.0, 0.0, f32::INFINITY);

/// Maximum number of voxels drawn; only a very wide orthographic view needs more.
pub(crate) const MAX_QUADS: usize = 1 << 16;

/// The viewpoint and the visible volume.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    pub(crate) position: DVec3,
    pub(crate) forward: Vec3,
    pub(crate) perspective: bool,
    /// Sine of the angle between the view direction and the fall.
    steepness: f32,
    /// Planes with normals to the inside, relative to the eye.
    planes: [Vec4; 4],
    /// A box around the visible volume up to the distance, relative to the eye.
    low: Vec3,
    high: Vec3,
}

impl Eye {
    /// The view of rain that falls along `axis`, up to the distance; `None` for invalid matrices.
    pub(crate) fn new(
        world_from_view: &GlobalTransform,
        clip_from_view: &Mat4,
        distance: f32,
        axis: Vec3,
    ) -> Option<Self> {
        let relative_from_view = Mat3::from(world_from_view.affine().matrix3);
        let clip_from_relative = *clip_from_view * Mat4::from_mat3(relative_from_view.inverse());
        let relative_from_clip = clip_from_relative.inverse();
        let forward = relative_from_view.mul_vec3(Vec3::NEG_Z).normalize();
        let perspective = clip_from_view.w_axis.w != 1.0;
        let row = |i| clip_from_relative.row(i);
        let planes = [
            row(3) + row(0),
            row(3) - row(0),
            row(3) + row(1),
            row(3) - row(1),
        ]
        .map(|plane| plane / plane.truncate().length());
        let steepness = forward.cross(axis).length();
        let depth = if perspective {
            distance
        } else {
            // Voxels across the end count in part, however steep the ray there is.
            let steepness = steepness.max(STEEPEST);
            let last = LEVELS.iter().rfind(|level| level.start < distance);
            distance + 0.5 * last.map_or(0.0, |level| level.size) / steepness
        };
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            // Two points of the ray, both at finite distances in every projection.
            let near = relative_from_clip.project_point3(vec3(x, y, 1.0));
            let way = relative_from_clip.project_point3(vec3(x, y, 0.5)) - near;
            let far = near + way * ((depth - near.dot(forward)) / way.dot(forward));
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
            steepness,
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

    /// Whether something of a box, or of what is below it along `axis`, is within `margin` of the
    /// visible volume up to `reach`. The box is around `center`, half as long as its `arms`.
    pub(crate) fn sees_below(
        &self,
        center: Vec3,
        arms: [Vec3; 3],
        axis: Vec3,
        reach: f32,
        margin: f32,
    ) -> bool {
        let ends = [self.forward.extend(0.0), (-self.forward).extend(reach)];
        self.planes.iter().chain(&ends).all(|plane| {
            let normal = plane.truncate();
            let half: f32 = arms.iter().map(|arm| normal.dot(*arm).abs()).sum();
            // What is below has no end.
            normal.dot(axis) < 0.0 || normal.dot(center) + plane.w + half >= -margin
        })
    }

    /// Whether a ball of radius `range` around a place reaches the visible volume.
    pub(crate) fn is_reached_from(&self, place: Vec3, range: f32) -> bool {
        place.distance_squared(place.clamp(self.low, self.high)) < range * range
    }

    /// The least sine of the angle between a ray of the view and the fall.
    pub(crate) fn steepest(&self) -> f32 {
        let widest = self.planes.iter().fold(0.0, |widest: f32, plane| {
            widest.max(plane.truncate().dot(self.forward).clamp(0.0, 1.0).asin())
        });
        // Corners are farther off than borders.
        let spread = if self.perspective {
            2.0_f32.sqrt() * widest
        } else {
            0.0
        };
        (self.steepness.min(1.0).asin() - spread).max(0.0).sin()
    }
}

/// Direction from which drops of mean speed fall: upwards, of unit length.
pub(crate) fn fall_axis(lean: Vec2) -> Vec3 {
    vec3(-lean.x, 1.0, -lean.y).normalize()
}

/// The contents of voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Content {
    /// A billboard.
    Streaks,
    /// Streaks of at most this length, which may reach out of their voxel. Unit: m.
    Drops(f32),
}

impl Content {
    /// How far the contents of a voxel reach from its centre: the corners of a cube, stretched
    /// along the fall, plus the length of streaks. Unit: m.
    pub(crate) fn reach(self, size: f32, axis: Vec3) -> f32 {
        0.87 * size / axis.y + self.longest()
    }

    /// How far from a voxel's centre its drops may be lit: drops on a billboard represent those
    /// before and behind it. Unit: m.
    pub(crate) fn lit_reach(self, size: f32, axis: Vec3) -> f32 {
        let depth = match self {
            Self::Streaks => 0.71 * size,
            Self::Drops(_) => 0.0,
        };
        self.reach(size, axis) + depth
    }

    /// How far before its billboard a voxel begins to count. Unit: m.
    fn half(self, size: f32) -> f32 {
        match self {
            Self::Streaks => 0.5 * size,
            Self::Drops(_) => 0.0,
        }
    }

    fn longest(self) -> f32 {
        match self {
            Self::Streaks => 0.0,
            Self::Drops(longest) => longest,
        }
    }
}

/// Adds the voxels in view to `quads`, level by level. `keep` may reject or change a voxel. Returns
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
    // In the lattice.
    let place = eye.position - clock.origin;
    for (index, level) in levels.iter().enumerate() {
        if level.start >= distance {
            break;
        }
        let size = f64::from(level.size);
        let cells =
            |low: f64, high: f64| (low / size).floor() as i64..=(high / size).floor() as i64;
        // In perspective, only voxels within the distance count.
        let around = if eye.perspective {
            distance
        } else {
            f32::INFINITY
        };
        let heights = cells(
            place.y + f64::from(eye.low.y.max(-around) - content.longest()),
            place.y + f64::from(eye.high.y.min(around)),
        );
        let end = level.end.min(distance);
        for y in heights {
            let center_y = (y as f64 + 0.5) * size;
            let relative_y = (center_y - place.y) as f32;
            // Place of the column with index 0 at this height.
            let shift = clock.anchor - clock.lean.as_dvec2() * (center_y - clock.height);
            let shift = [shift.x - place.x, shift.y - place.z];
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
                    if quads.len() == MAX_QUADS {
                        return true;
                    }
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
                        shelters: default(),
                    };
                    if keep(&mut quad) {
                        quads.push(quad);
                    }
                }
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
        // Parallel rays begin at the view's plane.
        let depth = center.dot(eye.forward);
        match content {
            Content::Streaks => {
                if eye.steepness < STEEPEST {
                    return None;
                }
                let radius = depth * eye.steepness;
                // The billboard leans against the view's plane, and fades at the ends.
                let reach = half * (1.0 + eye.steepness / axis.y);
                (radius, radius - reach, radius + reach)
            }
            Content::Drops(_) => {
                let reach = content.reach(level.size, axis);
                (depth, depth - reach, depth + reach)
            }
        }
    } else if center.length() > distance + level.size {
        return None;
    } else {
        let radius = across(center).length();
        match content {
            // The billboard turns with the direction to its centre: at the centre it has none.
            Content::Streaks if radius < 0.1 * level.size => return None,
            // The billboard's ends are farther away.
            Content::Streaks => (radius, radius, radius.hypot(half)),
            // Corners of a square.
            Content::Drops(_) => (radius, radius - 1.42 * half, radius + 1.42 * half),
        }
    };
    // Some of it must be within the level and in sight.
    let within =
        nearest < level.end.min(distance + content.half(level.size)) && farthest > level.start;
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
