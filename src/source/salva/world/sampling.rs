//! Surfaces as particles that salva's pressure can push against.
//!
//! The particles lie [`DEPTH`] behind the surface, where the liquid's lie one radius before it.

use std::collections::HashMap;

use bevy::prelude::*;

/// Corners in the order in which they are seen counter-clockwise from where the liquid is.
pub(crate) type Triangle = [Vec3; 3];

/// How far behind the surface, in radii.
///
/// A layer of particles counts for more than a layer of a lattice, as each has the volume of all
/// that is missing about it (Akinci et al. 2012, equation 4): at one radius liquid that fills a
/// tank as a lattice is 6 % too dense at the walls, and jumps in the first step, the higher the
/// shorter the step. At 1.2 it has just its rest density: there the kernel's integral over the
/// plane through the samples is that of a layer of the lattice. At rest particles then lie some
/// tenth of a radius nearer to the wall than in the lattice: a column 16 radii wide is 4 % lower
/// for it.
pub(crate) const DEPTH: f32 = 1.2;
/// How far a corner may move over the depth it is moved for: sharper edges are blunted.
const LONGEST_MITER: f32 = 2.0;
/// Neighbouring samples are at least this far apart, over the requested spacing.
const CLOSEST: f32 = 0.74;
/// More samples than this are more than any machine simulates.
const MOST_SAMPLES: f32 = 2e6;

/// The surface moved back by `depth`: every corner so far that its faces move by that.
pub(crate) fn inset(triangles: &[Triangle], depth: f32) -> Vec<Triangle> {
    let key = |corner: Vec3| (corner / (1e-2 * depth)).round().as_ivec3();
    // Normals weighted by the angle at the corner: two triangles of one quad count once.
    let mut corners: HashMap<IVec3, (Vec3, f32)> = HashMap::new();
    for triangle in triangles {
        let normal = normal(triangle);
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|j| triangle[(i + j) % 3]);
            let angle = (b - a).angle_between(c - a);
            if angle.is_finite() {
                let (sum, angles) = corners.entry(key(a)).or_default();
                *sum += angle * normal;
                *angles += angle;
            }
        }
    }
    let moved = |corner: Vec3| {
        let Some((sum, angles)) = corners.get(&key(corner)) else {
            return corner;
        };
        let mean = *sum / *angles;
        // Along the mean by so much that each face comes along by 1.
        let miter = mean / mean.length_squared();
        if !miter.is_finite() {
            return corner;
        }
        corner - depth * miter.clamp_length_max(LONGEST_MITER)
    };
    triangles.iter().map(|corners| corners.map(moved)).collect()
}

/// Points on the triangles, none closer than three quarters of `spacing` to another, and no place
/// on them farther than about `spacing` from the nearest. None where they would be too many.
pub(crate) fn sample(triangles: &[Triangle], spacing: f32) -> Option<Vec<Vec3>> {
    let area: f32 = triangles.iter().map(area).sum();
    let count = area / (spacing * spacing);
    if count.is_nan() || count >= MOST_SAMPLES {
        return None;
    }
    let closest = CLOSEST * spacing;
    let cell = |point: Vec3| (point / closest).floor().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<Vec3>> = HashMap::new();
    let mut samples = Vec::new();
    for &[a, b, c] in triangles {
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let steps = (longest / (0.5 * spacing)).ceil().max(1.0) as u32;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let [u, v] = [i, j].map(|step| step as f32 / steps as f32);
                let point = a + u * (b - a) + v * (c - a);
                let is_free = neighbors(cell(point))
                    .filter_map(|cell| cells.get(&cell))
                    .flatten()
                    .all(|other| other.distance_squared(point) >= closest * closest);
                if is_free {
                    cells.entry(cell(point)).or_default().push(point);
                    samples.push(point);
                }
            }
        }
    }
    Some(samples)
}

/// The cell and the 26 around it.
pub(crate) fn neighbors(cell: IVec3) -> impl Iterator<Item = IVec3> {
    (0..27).map(move |i| cell + ivec3(i % 3, i / 3 % 3, i / 9) - 1)
}

fn normal([a, b, c]: &Triangle) -> Vec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

fn area([a, b, c]: &Triangle) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The twelve triangles of a box about the origin, seen from outside.
    fn cuboid(half: Vec3) -> Vec<Triangle> {
        let mut triangles = Vec::new();
        for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let corner = |u: f32, v: f32| {
                let mut corner = Vec3::ZERO;
                corner[axis] = side;
                corner[(axis + 1) % 3] = u * side;
                corner[(axis + 2) % 3] = v;
                corner * half
            };
            let quad = [
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ];
            triangles.push([quad[0], quad[1], quad[2]]);
            triangles.push([quad[0], quad[2], quad[3]]);
        }
        triangles
    }

    #[test]
    fn a_box_moves_in_by_the_depth_on_every_side() {
        let half = vec3(0.5, 0.3, 0.2);
        for corner in inset(&cuboid(half), 0.05).into_iter().flatten() {
            assert!(corner.abs().abs_diff_eq(half - 0.05, 1e-5), "{corner}");
        }
    }

    #[test]
    fn samples_are_apart_and_leave_no_hole() {
        let spacing = 0.05;
        // One size that the spacing divides and one that it does not.
        for half in [vec3(0.5, 0.3, 0.2), vec3(0.113, 0.271, 0.07)] {
            let samples = sample(&cuboid(half), spacing).unwrap();
            for (i, a) in samples.iter().enumerate() {
                for b in &samples[..i] {
                    assert!(a.distance(*b) >= 0.73 * spacing);
                }
            }
            // Anywhere on the surface.
            for i in 0..4000 {
                let [u, v] = [0.618_034, 0.754_877].map(|step| (i as f32 * step).fract());
                let mut place = vec3(1.0, 2.0 * u - 1.0, 2.0 * v - 1.0);
                place = Vec3::from_array([0, 1, 2].map(|axis| place[(axis + i) % 3]));
                place *= if i % 2 == 0 { half } else { -half };
                let nearest = samples.iter().map(|s| s.distance(place));
                let nearest = nearest.fold(f32::INFINITY, f32::min);
                assert!(nearest < spacing, "{nearest} at {place}");
            }
        }
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        assert_eq!(
            sample(&[[Vec3::ZERO, Vec3::X * 1e9, Vec3::Y * 1e9]], 0.1),
            None
        );
        assert_eq!(sample(&[[Vec3::NAN, Vec3::X, Vec3::Y]], 0.1), None);
        assert_eq!(sample(&[], 0.1), Some(Vec::new()));
    }
}
