//! Keeps particles on their side of a surface, however fast they are.
//!
//! Pressure alone lets fast particles through between the particles of a wall. Here every
//! particle's way through a step is a ray, in the frame of each solid, and ends where it meets one.

use bevy::prelude::*;
use salva3d::rapier::parry::{query::Ray, shape::Shape};

use super::convert::{from_rigid, pose, rigid};

/// A solid's surface and how it moves in a step.
pub(crate) struct GuardedSurface<'a> {
    pub(crate) shape: &'a dyn Shape,
    pub(crate) before: Isometry3d,
    pub(crate) after: Isometry3d,
    /// A box around both, and what they sweep.
    low: Vec3,
    high: Vec3,
}

/// A particle that was stopped.
pub(crate) struct Stopped {
    /// Index of the surface.
    pub(crate) surface: usize,
    /// Where it is now.
    pub(crate) position: Vec3,
    /// Out of the surface that stopped it.
    pub(crate) normal: Vec3,
    /// How far the surface came along in the step there.
    pub(crate) surface_motion: Vec3,
}

impl<'a> GuardedSurface<'a> {
    pub(crate) fn new(shape: &'a dyn Shape, before: Isometry3d, after: Isometry3d) -> Self {
        let [a, b] = [before, after].map(|at| shape.compute_aabb(&pose(at)));
        Self {
            shape,
            before,
            after,
            low: from_rigid(a.mins).min(from_rigid(b.mins)),
            high: from_rigid(a.maxs).max(from_rigid(b.maxs)),
        }
    }

    fn is_near(&self, from: Vec3, to: Vec3) -> bool {
        from.max(to).cmpge(self.low).all() && from.min(to).cmple(self.high).all()
    }

    /// Where the way from `from` before the step to `to` after it meets the surface: in the
    /// surface's own frame, with the normal on the side it came from.
    fn meet(&self, from: Vec3, to: Vec3) -> Option<(Vec3, Vec3)> {
        let start = self.before.inverse() * from;
        let end = self.after.inverse() * to;
        cross(self.shape, start, end)
    }
}

fn cross(shape: &dyn Shape, start: Vec3, end: Vec3) -> Option<(Vec3, Vec3)> {
    let way = end - start;
    if way.length_squared() < 1e-20 {
        return None;
    }
    let ray = Ray::new(rigid(start), rigid(way));
    let hit = shape.cast_local_ray_and_get_normal(&ray, 1.0, false)?;
    let normal = from_rigid(hit.normal);
    let normal = if normal.dot(way) > 0.0 {
        -normal
    } else {
        normal
    };
    Some((start + way * hit.time_of_impact, normal))
}

/// Follows a particle from `from` to `to`, and stops it `margin` before the first surface in its
/// way.
pub(crate) fn stop(
    surfaces: &[GuardedSurface],
    from: Vec3,
    to: Vec3,
    margin: f32,
) -> Option<Stopped> {
    let mut stopped: Option<Stopped> = None;
    for (index, surface) in surfaces.iter().enumerate() {
        let end = stopped.as_ref().map_or(to, |stopped| stopped.position);
        if !surface.is_near(from, end) {
            continue;
        }
        let Some((place, normal)) = surface.meet(from, end) else {
            continue;
        };
        // Off the surface, unless that leads through another part of it.
        let start = surface.before.inverse() * from;
        let clear = place + margin * normal;
        let place = match cross(surface.shape, start, clear) {
            None => clear,
            Some(_) => start,
        };
        stopped = Some(Stopped {
            surface: index,
            position: surface.after * place,
            normal: surface.after.rotation * normal,
            surface_motion: surface.after * place - surface.before * place,
        });
    }
    let stopped = stopped?;
    // One surface may have pushed it through another: then it stays where it was.
    let position = surfaces.iter().fold(stopped.position, |end, surface| {
        if surface.is_near(from, end) && surface.meet(from, end).is_some() {
            surface.after * (surface.before.inverse() * from)
        } else {
            end
        }
    });
    Some(Stopped {
        position,
        ..stopped
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use salva3d::rapier::parry::shape::{Cuboid, HalfSpace};

    const MARGIN: f32 = 1e-3;

    fn still(shape: &dyn Shape) -> GuardedSurface<'_> {
        GuardedSurface::new(shape, Isometry3d::IDENTITY, Isometry3d::IDENTITY)
    }

    #[test]
    fn a_bullet_stops_at_a_plate() {
        let plate = Cuboid::new(rigid(vec3(0.01, 1.0, 1.0)));
        let stopped = stop(&[still(&plate)], Vec3::X * -5.0, Vec3::X * 5.0, MARGIN).unwrap();
        let expected = Vec3::X * (-0.01 - MARGIN);
        assert!(stopped.position.abs_diff_eq(expected, 1e-5));
        assert!(stopped.normal.abs_diff_eq(Vec3::NEG_X, 1e-5));
        assert!(stop(&[still(&plate)], Vec3::X * -5.0, Vec3::X * -1.0, MARGIN).is_none());
    }

    #[test]
    fn neither_side_of_a_surface_lets_through() {
        let room = Cuboid::new(rigid(Vec3::ONE));
        let stopped = stop(&[still(&room)], Vec3::ZERO, Vec3::Y * 3.0, MARGIN).unwrap();
        assert!(stopped.position.abs_diff_eq(Vec3::Y * (1.0 - MARGIN), 1e-5));
    }

    #[test]
    fn no_shape_is_entered_from_any_side() {
        use super::super::geometry::Geometry;
        let shapes = [
            Geometry::cuboid(vec3(0.3, 0.5, 0.2)),
            Geometry::sphere(0.4),
            Geometry::capsule(0.2, 0.3),
            Geometry::cylinder(0.3, 0.4).unwrap(),
        ];
        for geometry in shapes {
            let shell = &*geometry.shell.0;
            for i in 0..2000 {
                let [u, v, w] =
                    [0.819_173, 0.671_044, 0.549_7].map(|step| (i as f32 * step).fract());
                let height = 2.0 * u - 1.0;
                let around =
                    Vec2::from_angle(core::f32::consts::TAU * v) * (1.0 - height * height).sqrt();
                let from = 2.0 * vec3(around.x, height, around.y);
                // Somewhere within.
                let to = 0.15 * vec3(w - 0.5, v - 0.5, u - 0.5);
                let stopped = stop(&[still(shell)], from, to, MARGIN).unwrap();
                let distance = geometry.distance(stopped.position);
                // A cylinder's triangles lie up to half a percent within it.
                let is_outside = distance > 0.0 || stopped.position.xz().length() > 0.298;
                assert!(is_outside, "{:?} {from} to {to}", shell.shape_type());
            }
        }
    }

    #[test]
    fn a_corner_of_two_surfaces_holds() {
        let floor = HalfSpace::new(rigid(Vec3::Y));
        let wall = HalfSpace::new(rigid(Vec3::X));
        let surfaces = [still(&floor), still(&wall)];
        let stopped = stop(
            &surfaces,
            vec3(0.1, 0.2, 0.0),
            vec3(-3.0, -3.0, 0.0),
            MARGIN,
        );
        let place = stopped.unwrap().position;
        assert!(place.x > 0.0 && place.y > 0.0, "{place}");
    }

    #[test]
    fn a_moving_surface_takes_along_what_rests() {
        let piston = Cuboid::new(rigid(Vec3::ONE));
        let after = Isometry3d::from_translation(Vec3::X * 0.5);
        let moving = GuardedSurface::new(&piston, Isometry3d::IDENTITY, after);
        let rest = Vec3::X * 1.2;
        let stopped = stop(&[moving], rest, rest, MARGIN).unwrap();
        assert!(stopped.position.abs_diff_eq(Vec3::X * (1.5 + MARGIN), 1e-5));
        assert!(stopped.surface_motion.abs_diff_eq(Vec3::X * 0.5, 1e-5));
    }
}
