//! Boxes around surfaces: on screen, and in the order in which they are painted.

use bevy::{math::Affine3A, prelude::*};

/// A box that holds points, possibly none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Bounds {
    pub(crate) const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    pub(crate) fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether a part of the box is nearer than the near plane, or behind the eye.
    pub(crate) fn near_plane_cuts(&self, clip_from_eye: &Mat4) -> bool {
        !self.is_empty()
            && self.corners().into_iter().any(|p| {
                let clip = *clip_from_eye * p.extend(1.0);
                clip.w <= 1e-6 || clip.z > clip.w
            })
    }

    pub(crate) fn center(&self) -> Vec3 {
        0.5 * (self.min + self.max)
    }

    /// Whether the boxes have a point in common.
    pub(crate) fn touches(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Whether `other` cannot hide any part of this box from `eye`: they are separated along an
    /// axis, and the eye is on this one's side.
    pub(crate) fn before(&self, other: &Self, eye: Vec3) -> bool {
        (0..3).any(|axis| {
            let above = self.min[axis] >= other.max[axis] && eye[axis] >= other.max[axis];
            let below = self.max[axis] <= other.min[axis] && eye[axis] <= other.min[axis];
            above || below
        })
    }
}

/// Sorts few things in place; equal ones keep their order. The standard library's stable sort may
/// allocate.
pub(super) fn sort_few<T>(things: &mut [T], before: impl Fn(&T, &T) -> bool) {
    for end in 1..things.len() {
        let mut i = end;
        while i > 0 && before(&things[i], &things[i - 1]) {
            things.swap(i, i - 1);
            i -= 1;
        }
    }
}

/// Sorts things by the order in which they are painted: each after all that its box may hide,
/// judged by the boxes alone; where they overlap or hide each other in a ring, the farther centre
/// first.
pub(crate) fn sort_far_to_near<T>(things: &mut [T], bounds: impl Fn(&T) -> Bounds, eye: Vec3) {
    let distance = |thing: &T| bounds(thing).center().distance_squared(eye);
    sort_few(things, |a, b| distance(a) > distance(b));
    for done in 0..things.len() {
        let left = &things[done..];
        let hides_none = |i: &usize| {
            let others = left.iter().enumerate().filter(|(other, _)| other != i);
            let mut others = others.map(|(_, other)| bounds(other));
            !others.any(|other| bounds(&left[*i]).before(&other, eye))
        };
        let next = (0..left.len()).find(hides_none).unwrap_or(0);
        things[done..=done + next].rotate_right(1);
    }
}

/// Whether points in clip space all lie beyond one of a view's planes.
fn is_outside(clip: &[Vec4; 8]) -> bool {
    let all = |outside: fn(&Vec4) -> bool| clip.iter().all(outside);
    all(|c| c.x < -c.w)
        || all(|c| c.x > c.w)
        || all(|c| c.y < -c.w)
        || all(|c| c.y > c.w)
        || all(|c| c.z > c.w)
        || all(|c| c.z < 0.0)
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    fn corners(&self) -> [Vec3; 8] {
        core::array::from_fn(|i| {
            let pick = |axis: usize| {
                if (i >> axis) & 1 == 0 {
                    self.min[axis]
                } else {
                    self.max[axis]
                }
            };
            vec3(pick(0), pick(1), pick(2))
        })
    }

    /// The box around the transformed box.
    pub(crate) fn transformed(&self, transform: &Affine3A) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        self.corners().into_iter().fold(Self::EMPTY, |bounds, p| {
            let p = transform.transform_point3(p);
            bounds.union(Self { min: p, max: p })
        })
    }

    /// Whether a view may show a part of the box.
    pub(crate) fn is_in_view(&self, clip_from_eye: &Mat4) -> bool {
        // Products that overflow compare as in view.
        !self.is_empty() && !is_outside(&self.corners().map(|p| *clip_from_eye * p.extend(1.0)))
    }

    /// The pixels of a view of `size` that the box may cover; `None` if it cannot be seen.
    pub(crate) fn rect(&self, clip_from_eye: &Mat4, size: UVec2) -> Option<URect> {
        if self.is_empty() || size.x == 0 || size.y == 0 {
            return None;
        }
        let whole = URect::from_corners(UVec2::ZERO, size);
        let clip = self.corners().map(|p| *clip_from_eye * p.extend(1.0));
        // So large that products overflow: it may be anywhere.
        if !clip.iter().all(|c| c.is_finite()) {
            return Some(whole);
        }
        if is_outside(&clip) {
            return None;
        }
        // The projection is unbounded.
        if self.near_plane_cuts(clip_from_eye) {
            return Some(whole);
        }
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for c in clip {
            let ndc = c.xy() / c.w;
            let pixel = (ndc * vec2(0.5, -0.5) + 0.5) * size.as_vec2();
            low = low.min(pixel);
            high = high.max(pixel);
        }
        // One pixel more, for the slack of the splats' quads.
        let low = (low.floor() - 1.0).max(Vec2::ZERO).as_uvec2();
        let high = (high.ceil() + 1.0).min(size.as_vec2()).as_uvec2();
        (low.cmplt(high).all()).then(|| URect::from_corners(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip() -> Mat4 {
        Mat4::perspective_infinite_reverse_rh(1.0, 1.0, 0.1)
    }

    #[test]
    fn boxes_out_of_view_cover_nothing() {
        let size = UVec2::splat(100);
        let at = |center: Vec3| Bounds {
            min: center - 0.5,
            max: center + 0.5,
        };
        assert!(at(vec3(0.0, 0.0, 5.0)).rect(&clip(), size).is_none());
        assert!(at(vec3(50.0, 0.0, -5.0)).rect(&clip(), size).is_none());
        assert!(Bounds::EMPTY.rect(&clip(), size).is_none());
    }

    #[test]
    fn a_centred_box_is_confined() {
        let bounds = Bounds {
            min: vec3(-0.5, -0.5, -5.5),
            max: vec3(0.5, 0.5, -4.5),
        };
        let rect = bounds.rect(&clip(), UVec2::splat(100)).unwrap();
        assert!(rect.contains(uvec2(50, 50)));
        assert!(rect.min.x > 20 && rect.max.x < 80, "{rect:?}");
        assert_eq!(rect.min.x, 100 - rect.max.x);
    }

    fn far_to_near(eye: Vec3, boxes: &[Bounds]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        sort_far_to_near(&mut order, |&i| boxes[i], eye);
        order
    }

    #[test]
    fn boxes_apart_are_painted_by_the_plane_between_them() {
        let pool = Bounds {
            min: vec3(-5.0, -1.0, -5.0),
            max: vec3(5.0, 0.0, 5.0),
        };
        let smoke = Bounds {
            min: vec3(-1.0, 0.5, -5.0),
            max: vec3(1.0, 2.0, -3.0),
        };
        // Seen from above the smoke is before the pool, though its centre is farther.
        let above = vec3(0.0, 3.0, 8.0);
        assert!(smoke.center().distance(above) > pool.center().distance(above));
        assert_eq!(far_to_near(above, &[smoke, pool]), [1, 0]);
        assert_eq!(far_to_near(above, &[pool, smoke]), [0, 1]);
        // From under the water it is behind.
        let below = vec3(0.0, -3.0, -4.0);
        assert_eq!(far_to_near(below, &[smoke, pool]), [0, 1]);
    }

    #[test]
    fn boxes_that_overlap_are_painted_by_their_centres() {
        let at = |z: f32| Bounds {
            min: vec3(-1.0, -1.0, z - 1.0),
            max: vec3(1.0, 1.0, z + 1.0),
        };
        let boxes = [at(-5.0), at(-6.0), at(-4.5), at(-9.0)];
        assert_eq!(far_to_near(Vec3::ZERO, &boxes), [3, 1, 0, 2]);
        assert!(far_to_near(Vec3::ZERO, &[]).is_empty());
    }

    #[test]
    fn a_box_around_the_eye_takes_the_whole_view() {
        let bounds = Bounds {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        };
        let rect = bounds.rect(&clip(), uvec2(64, 32)).unwrap();
        assert_eq!(rect, URect::new(0, 0, 64, 32));
    }
}
