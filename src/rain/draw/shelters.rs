//! The dry places below shelters, as a view's rain knows them.

use bevy::prelude::*;

use super::{
    extract::Shelters,
    gpu_types::{DRY_PLANES, GpuShelter, GpuShelters, MAX_SHELTERS},
    lattice::Eye,
};

/// Streaks whose middle is out of sight may reach into it. Unit: m.
const MARGIN: f32 = 1.0;

/// A half-space that holds everything: within it as far as any distance in sight.
const EVERYWHERE: Vec4 = Vec4::new(0.0, 0.0, 0.0, 1e9);

/// The dry places in sight, the nearest first.
#[derive(Default)]
pub(crate) struct DryPlaces {
    places: Vec<DryPlace>,
}

struct DryPlace {
    gpu: GpuShelter,
    /// A lower bound of its distance from the eye. Unit: m.
    away: f32,
}

impl DryPlaces {
    /// Collects the dry places that a view at `position` sees up to `reach`; the nearest
    /// [`MAX_SHELTERS`] count.
    pub(crate) fn gather(
        &mut self,
        shelters: &Shelters,
        position: Vec3,
        eye: &Eye,
        axis: Vec3,
        reach: f32,
    ) {
        let seen = shelters.0.iter().filter_map(|(transform, half_size)| {
            let matrix = Mat3::from(transform.affine().matrix3);
            let center = transform.translation() - position;
            let arms = matrix * Mat3::from_diagonal(*half_size);
            let arms = [arms.x_axis, arms.y_axis, arms.z_axis];
            eye.sees_below(center, arms, axis, reach, MARGIN).then(|| {
                let gpu = GpuShelter::new(matrix, center, *half_size, axis);
                let away = -gpu.depth_of(Vec3::ZERO);
                DryPlace { gpu, away }
            })
        });
        self.places.clear();
        self.places.extend(seen);
        self.places
            .sort_unstable_by(|a, b| a.away.total_cmp(&b.away));
        if self.places.len() > MAX_SHELTERS {
            bevy::utils::once!(warn!(
                "a view sees more than {MAX_SHELTERS} shelters: the farther ones keep no rain off"
            ));
            self.places.truncate(MAX_SHELTERS);
        }
    }

    pub(crate) fn gpu(&self) -> GpuShelters {
        GpuShelters {
            count: self.places.len() as u32,
            places: core::array::from_fn(|i| {
                self.places.get(i).map_or_else(default, |place| place.gpu)
            }),
        }
    }

    /// A bit for each dry place that reaches a ball; `None` where one holds all of it.
    pub(crate) fn around(&self, center: Vec3, radius: f32) -> Option<[u32; MAX_SHELTERS / 32]> {
        let mut bits = [0; MAX_SHELTERS / 32];
        let farthest = center.length() + radius;
        for (i, place) in self.places.iter().enumerate() {
            if place.away > farthest {
                break;
            }
            let depth = place.gpu.depth_of(center);
            if depth >= radius {
                return None;
            }
            if depth > -radius {
                bits[i / 32] |= 1 << (i % 32);
            }
        }
        Some(bits)
    }
}

impl GpuShelter {
    /// What is in a box and below it along `axis`. The box is `matrix` times one of `half_size`,
    /// around `center`.
    ///
    /// A way upwards enters and leaves each of the box's three slabs. It meets the box where it
    /// leaves none before it enters another, and has left none where it begins.
    fn new(matrix: Mat3, center: Vec3, half_size: Vec3, axis: Vec3) -> Self {
        let local_from_world = matrix.inverse();
        // Normal of unit length, half width, and its growth on the way up, which is none or more.
        let slabs: [(Vec3, f32, f32); 3] = core::array::from_fn(|i| {
            let row = local_from_world.row(i);
            let length = row.length();
            let normal = row / length;
            let up = normal.dot(axis);
            let normal = if up < 0.0 { -normal } else { normal };
            (normal, half_size[i] / length, up.abs())
        });
        let mut planes = [EVERYWHERE; DRY_PLANES];
        let tops = slabs.map(|(normal, half, _)| (-normal, half));
        let sides = [(0, 1), (1, 0), (1, 2), (2, 1), (2, 0), (0, 2)].map(|(leaves, enters)| {
            let ((out, out_half, out_up), (inward, in_half, in_up)) =
                (slabs[leaves], slabs[enters]);
            (
                out_up * inward - in_up * out,
                out_up * in_half + in_up * out_half,
            )
        });
        for (plane, (normal, offset)) in planes.iter_mut().zip(tops.into_iter().chain(sides)) {
            let length = normal.length();
            // A way along two slabs leaves and enters neither.
            if length > 1e-6 {
                *plane = normal.extend(offset - normal.dot(center)) / length;
            }
        }
        Self { planes }
    }

    /// How deep a place is within the dry one; outside, minus a lower bound of its distance.
    fn depth_of(&self, place: Vec3) -> f32 {
        self.planes.iter().fold(f32::INFINITY, |depth, plane| {
            depth.min(plane.truncate().dot(place) + plane.w)
        })
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Affine3A;

    use super::*;
    use crate::random::Random;

    /// The slow way: whether the way upwards meets the box.
    fn is_below(box_from_world: Affine3A, half_size: Vec3, place: Vec3, axis: Vec3) -> bool {
        let start = box_from_world.transform_point3(place);
        let up = box_from_world.transform_vector3(axis);
        let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
        for i in 0..3 {
            if up[i] == 0.0 {
                if start[i].abs() > half_size[i] {
                    return false;
                }
                continue;
            }
            let ends = [-half_size[i], half_size[i]].map(|end| (end - start[i]) / up[i]);
            enter = enter.max(ends[0].min(ends[1]));
            leave = leave.min(ends[0].max(ends[1]));
        }
        leave >= enter
    }

    /// A shelter of any form, some flat, some mirrored, some upright, with its box.
    fn shelter(random: &mut Random, axis: Vec3) -> (GpuShelter, Affine3A, Vec3) {
        let mut vector = |low: f32, high: f32| {
            Vec3::from_array(core::array::from_fn(|_| {
                low + (high - low) * random.next_f64() as f32
            }))
        };
        let center = vector(-2.0, 2.0);
        let turn = vector(-3.0, 3.0);
        let (scale, mut half_size) = (vector(0.3, 2.0), vector(0.2, 3.0));
        let kind = random.below(4);
        let mut rotation = Quat::from_scaled_axis(turn);
        let mut mirror = Vec3::ONE;
        match kind {
            0 => half_size.y = 0.0,
            1 => mirror.x = -1.0,
            // Ways along its sides.
            2 => rotation = Quat::IDENTITY,
            _ => {}
        }
        let transform = Transform {
            translation: center,
            rotation,
            scale: scale * mirror,
        };
        // A child of it is sheared.
        let child = Transform::from_rotation(Quat::from_scaled_axis(turn.zxy()));
        let affine = if kind == 3 {
            transform.compute_affine() * child.compute_affine()
        } else {
            transform.compute_affine()
        };
        let gpu = GpuShelter::new(affine.matrix3.into(), center, half_size, axis);
        (gpu, affine.inverse(), half_size)
    }

    #[test]
    fn half_spaces_hold_what_is_below_the_box() {
        let mut random = Random::new(7);
        for axis in [Vec3::Y, vec3(0.6, 1.0, -0.4).normalize()] {
            let mut dry = 0;
            for _ in 0..100 {
                let (gpu, box_from_world, half_size) = shelter(&mut random, axis);
                for _ in 0..200 {
                    let place = Vec3::from_array(core::array::from_fn(|_| {
                        12.0 * random.next_f64() as f32 - 6.0
                    }));
                    let depth = gpu.depth_of(place);
                    let expected = is_below(box_from_world, half_size, place, axis);
                    // Borders are borders within rounding.
                    if depth.abs() > 1e-4 {
                        assert_eq!(depth > 0.0, expected, "{place}: {depth} in {gpu:?}");
                    }
                    dry += u32::from(expected);
                }
            }
            assert!((1000..19_000).contains(&dry), "{dry}");
        }
    }

    #[test]
    fn a_ball_is_dry_if_all_of_it_is_and_wet_if_all_of_it_is() {
        let mut random = Random::new(8);
        let axis = vec3(-0.3, 1.0, 0.2).normalize();
        let (mut whole, mut none) = (0, 0);
        for _ in 0..2000 {
            let (gpu, box_from_world, half_size) = shelter(&mut random, axis);
            let away = -gpu.depth_of(Vec3::ZERO);
            let places = DryPlaces {
                places: vec![DryPlace { gpu, away }],
            };
            let mut number = |size: f32| size * (random.next_f64() as f32 - 0.5);
            let center = vec3(number(8.0), number(8.0), number(8.0));
            let radius = 0.5;
            let around = places.around(center, radius);
            for _ in 0..20 {
                let way = vec3(number(2.0), number(2.0), number(2.0));
                let place = center + 0.999 * radius * way.normalize_or_zero();
                let is_dry = is_below(box_from_world, half_size, place, axis);
                match around {
                    None => assert!(is_dry, "{place} in {gpu:?}"),
                    Some([0, 0]) => assert!(!is_dry, "{place} in {gpu:?}"),
                    Some(_) => {}
                }
            }
            whole += u32::from(around.is_none());
            none += u32::from(around == Some([0, 0]));
        }
        assert!(whole > 100 && none > 100, "{whole}, {none}");
    }

    /// No shelter is left out below which something may be seen, and most others are.
    #[test]
    fn what_is_seen_below_a_shelter_is_dry() {
        let mut random = Random::new(9);
        let (axis, reach) = (vec3(0.2, 1.0, -0.3).normalize(), 8.0);
        let pose = Transform::from_xyz(1.0, 2.0, 3.0).looking_to(vec3(1.0, -0.2, 0.5), Vec3::Y);
        let wide = OrthographicProjection::default_3d();
        let orthographic = Mat4::orthographic_rh(-3.0, 3.0, -2.0, 2.0, wide.far, wide.near);
        let perspective = Mat4::perspective_infinite_reverse_rh(0.8, 1.5, 0.1);
        for clip_from_view in [perspective, orthographic] {
            let eye = Eye::new(&pose.into(), &clip_from_view, reach, axis).unwrap();
            let (mut seen, mut unseen) = (0, 0);
            for _ in 0..300 {
                let mut number = |size: f32| size * (random.next_f64() as f32 - 0.5);
                let place = Transform {
                    translation: pose.translation + vec3(number(30.0), number(30.0), number(30.0)),
                    rotation: Quat::from_scaled_axis(vec3(number(6.0), number(6.0), number(6.0))),
                    scale: Vec3::splat(0.5),
                };
                let half_size = vec3(2.0, 0.5, 4.0);
                let mut places = DryPlaces::default();
                let shelters = Shelters(vec![(place.into(), half_size)]);
                places.gather(&shelters, pose.translation, &eye, axis, reach);
                let box_from_world = place.compute_affine().inverse();
                let is_dry = (0..2000).any(|_| {
                    let mut number = |size: f32| size * (random.next_f64() as f32 - 0.5);
                    let in_view = vec3(number(16.0), number(16.0), -number(8.0) - 4.0);
                    let clip = clip_from_view * in_view.extend(1.0);
                    let is_in_view = clip.truncate().truncate().abs().max_element() <= clip.w;
                    let place = pose.transform_point(in_view);
                    is_in_view && is_below(box_from_world, half_size, place, axis)
                });
                if places.places.is_empty() {
                    assert!(!is_dry, "{place:?}");
                    unseen += 1;
                }
                seen += u32::from(is_dry);
            }
            assert!(seen > 10 && unseen > 50, "{seen}, {unseen}");
        }
    }
}
