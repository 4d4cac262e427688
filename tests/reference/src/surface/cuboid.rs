//! A box, turned as one likes.

use glam::{DAffine3, DQuat, DVec3};

use super::{Crossing, Figure, Nearest, Surface};
use crate::Ray;

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Middle, m.
    pub center: DVec3,
    /// Half of its size along its own axes, m.
    pub half: DVec3,
    /// How it is turned.
    pub turn: DQuat,
}

impl Cuboid {
    /// Parallel to the axes, from its least to its greatest corner.
    pub fn between(min: DVec3, max: DVec3) -> Self {
        Self {
            center: 0.5 * (min + max),
            half: 0.5 * (max - min),
            turn: DQuat::IDENTITY,
        }
    }

    /// From the box's own coordinates, whose origin is its middle.
    pub fn world_from_local(&self) -> DAffine3 {
        DAffine3::from_rotation_translation(self.turn, self.center)
    }

    /// Where the line goes in and out.
    pub(super) fn span(&self, ray: &Ray) -> Option<[Crossing; 2]> {
        let local = ray.seen_from(&self.world_from_local().inverse());
        let [o, d] = [local.origin.to_array(), local.direction.to_array()];
        let (mut first, mut last) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for (axis, half) in self.half.to_array().into_iter().enumerate() {
            if d[axis] == 0.0 {
                if o[axis].abs() >= half {
                    return None;
                }
                continue;
            }
            let middle = -o[axis] / d[axis];
            let reach = half / d[axis].abs();
            if middle - reach > first.0 {
                first = (middle - reach, axis);
            }
            if middle + reach < last.0 {
                last = (middle + reach, axis);
            }
        }
        (first.0 < last.0).then(|| {
            [(first, -1.0), (last, 1.0)].map(|((t, axis), sign)| Crossing {
                t,
                normal: self.turn * DVec3::AXES[axis] * (sign * d[axis].signum()),
                entering: sign < 0.0,
                body: 0,
            })
        })
    }
}

impl Surface for Cuboid {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        out.extend(self.span(ray).into_iter().flatten());
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        let local = self.turn.inverse() * (point - self.center);
        local.abs().cmplt(self.half).all().then_some(0)
    }

    /// Beyond an edge or a corner the normal is that of the face that is farthest off.
    fn nearest(&self, point: DVec3) -> Option<Nearest> {
        let local = self.turn.inverse() * (point - self.center);
        let beyond = local.abs() - self.half;
        let axis = beyond.max_position();
        let outside = beyond.max(DVec3::ZERO).length();
        Some(Nearest {
            distance: outside + beyond.max_element().min(0.0),
            normal: self.turn * (DVec3::AXES[axis] * local[axis].signum()),
        })
    }

    fn figures(&self) -> Vec<Figure> {
        vec![Figure::Cuboid(*self)]
    }
}
