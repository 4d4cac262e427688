//! Boundaries and bodies: the solids that liquid collides with.

use bevy::{math::Vec3A, prelude::*};
use salva3d::{
    LiquidWorld,
    object::{Boundary, BoundaryHandle, interaction_groups::InteractionGroups},
    rapier::{
        dynamics::{RigidBody, RigidBodyBuilder, RigidBodyHandle},
        geometry::ColliderBuilder,
        pipeline::PhysicsWorld,
    },
};

use super::{
    convert::{from_pose, from_rigid, pose, rigid},
    geometry::{Geometry, Surface},
    sampling,
};

/// How a solid moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    /// By its transform.
    Kinematic,
    /// By its weight and what pushes it.
    Dynamic {
        density: f32,
        velocity: Vec3,
        angular_velocity: Vec3,
    },
}

/// How bodies meet a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    pub(crate) friction: f32,
    pub(crate) restitution: f32,
}

/// Properties that may change while a solid goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Traits {
    pub(crate) motion: Motion,
    pub(crate) contact: Contact,
    /// Whether the liquid's load on it is recorded.
    pub(crate) feels: bool,
}

impl Motion {
    /// A body's velocity and angular velocity.
    fn start(&self) -> Option<[Vec3; 2]> {
        match *self {
            Self::Kinematic => None,
            Self::Dynamic {
                velocity,
                angular_velocity,
                ..
            } => Some([velocity, angular_velocity]),
        }
    }

    fn density(&self) -> f32 {
        match *self {
            Self::Kinematic => 0.0,
            Self::Dynamic { density, .. } => density,
        }
    }
}

/// A solid in both worlds.
pub(crate) struct Solid {
    pub(crate) geometry: Geometry,
    pub(crate) motion: Motion,
    pub(crate) body: RigidBodyHandle,
    pub(crate) boundary: BoundaryHandle,
    /// Surface particles in the solid's frame; a plane's are made where liquid is near.
    pub(crate) samples: Vec<Vec3>,
    pub(crate) before: Isometry3d,
    pub(crate) at: Isometry3d,
    /// Where it is to be at the end of the job.
    pub(crate) target: Isometry3d,
    /// World-space velocities and the centre they are about.
    pub(crate) velocity: Vec3,
    pub(crate) angular_velocity: Vec3,
    pub(crate) center: Vec3,
    /// Whether the liquid's load on it is recorded; that costs a lock for every contact.
    pub(crate) feels: bool,
    /// Impulse of the liquid in this step, N s and N m s about the centre.
    pub(crate) push: Vec3,
    pub(crate) turn: Vec3,
    /// The same, summed up over the job.
    pub(crate) pushed: Vec3,
    pub(crate) turned: Vec3,
}

impl Solid {
    pub(crate) fn new(
        rigid_world: &mut PhysicsWorld,
        liquid_world: &mut LiquidWorld,
        geometry: Geometry,
        traits: Traits,
        at: Isometry3d,
    ) -> Self {
        let Traits {
            motion,
            contact,
            feels,
        } = traits;
        let builder = match motion.start() {
            None => RigidBodyBuilder::kinematic_position_based(),
            Some([velocity, angular_velocity]) => RigidBodyBuilder::dynamic()
                .linvel(rigid(velocity))
                .angvel(rigid(angular_velocity))
                // Liquid below would not wake it.
                .can_sleep(false)
                .ccd_enabled(true),
        };
        let collider = ColliderBuilder::new(geometry.collider.clone())
            .density(motion.density())
            .friction(contact.friction)
            .restitution(contact.restitution);
        let (body, _) = rigid_world.insert(builder.pose(pose(at)), collider);
        // Otherwise known only after its first step: until then nothing could push it.
        if let Some(body) = rigid_world.bodies.get_mut(body) {
            body.recompute_mass_properties_from_colliders(&rigid_world.colliders);
        }
        let boundary = Boundary::new(Vec::new(), InteractionGroups::all());
        let mut solid = Self {
            geometry,
            motion,
            body,
            boundary: liquid_world.add_boundary(boundary),
            samples: Vec::new(),
            before: at,
            at,
            target: at,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            center: at.translation.into(),
            feels: feels || motion.start().is_some(),
            push: Vec3::ZERO,
            turn: Vec3::ZERO,
            pushed: Vec3::ZERO,
            turned: Vec3::ZERO,
        };
        solid.read_body(rigid_world);
        solid
    }

    pub(crate) fn is_dynamic(&self) -> bool {
        matches!(self.motion, Motion::Dynamic { .. })
    }

    /// Changes its traits and keeps its motion. Only a changed start velocity is applied to it.
    pub(crate) fn alter(&mut self, rigid_world: &mut PhysicsWorld, traits: Traits) {
        let start = traits.motion.start();
        if let Some(body) = rigid_world.bodies.get_mut(self.body) {
            for collider in body.colliders() {
                if let Some(collider) = rigid_world.colliders.get_mut(*collider) {
                    collider.set_density(traits.motion.density());
                    collider.set_friction(traits.contact.friction);
                    collider.set_restitution(traits.contact.restitution);
                }
            }
            body.recompute_mass_properties_from_colliders(&rigid_world.colliders);
            if let Some(start) = start.filter(|_| start != self.motion.start()) {
                set_velocities(body, start);
            }
        }
        self.motion = traits.motion;
        self.feels = traits.feels || start.is_some();
        self.read_body(rigid_world);
    }

    /// Continues the place and the motion of a body of another shape.
    pub(crate) fn go_on(&mut self, rigid_world: &mut PhysicsWorld, before: &Self) {
        if !(self.is_dynamic() && before.is_dynamic()) {
            return;
        }
        (self.before, self.at, self.target) = (before.at, before.at, before.at);
        if let Some(body) = rigid_world.bodies.get_mut(self.body) {
            body.set_position(pose(before.at), true);
            if self.motion.start() == before.motion.start() {
                set_velocities(body, [before.velocity, before.angular_velocity]);
            }
        }
        self.read_body(rigid_world);
    }

    /// Samples the surface for particles of `radius`; false where that would be too many.
    pub(crate) fn sample(&mut self, radius: f32) -> bool {
        let Surface::Triangles(faces) = &self.geometry.surface else {
            return true;
        };
        let samples = sampling::sample(
            &sampling::inset(faces, sampling::DEPTH * radius),
            2.0 * radius,
        );
        let is_sampled = samples.is_some();
        self.samples = samples.unwrap_or_default();
        is_sampled
    }

    /// Moves over to a new liquid world; false as [`Self::sample`].
    pub(crate) fn enter(&mut self, liquid_world: &mut LiquidWorld) -> bool {
        let boundary = Boundary::new(Vec::new(), InteractionGroups::all());
        self.boundary = liquid_world.add_boundary(boundary);
        self.sample(liquid_world.particle_radius())
    }

    /// Moves it at once, without a velocity.
    pub(crate) fn jump(&mut self, rigid_world: &mut PhysicsWorld, at: Isometry3d) {
        (self.before, self.at, self.target) = (at, at, at);
        (self.velocity, self.angular_velocity) = (Vec3::ZERO, Vec3::ZERO);
        self.center = at.translation.into();
        if let Some(body) = rigid_world.bodies.get_mut(self.body) {
            body.set_position(pose(at), true);
            if self.is_dynamic() {
                set_velocities(body, [Vec3::ZERO; 2]);
            }
        }
        self.read_body(rigid_world);
    }

    /// The world is shifted: it goes on as before.
    pub(crate) fn shift(&mut self, rigid_world: &mut PhysicsWorld, by: Vec3) {
        for at in [&mut self.before, &mut self.at, &mut self.target] {
            at.translation += Vec3A::from(by);
        }
        self.center += by;
        if let Some(body) = rigid_world.bodies.get_mut(self.body) {
            let mut at = from_pose(body.position());
            at.translation += Vec3A::from(by);
            body.set_position(pose(at), true);
        }
        self.read_body(rigid_world);
    }

    /// Takes over the state of a dynamic body.
    pub(crate) fn read_body(&mut self, rigid_world: &PhysicsWorld) {
        if let Some(body) = rigid_world.bodies.get(self.body)
            && self.is_dynamic()
        {
            self.at = from_pose(body.position());
            self.velocity = from_rigid(body.linvel());
            self.angular_velocity = from_rigid(body.angvel());
            self.center = from_rigid(body.center_of_mass());
        }
    }

    /// Sets a kinematic solid's velocity such that it is at its target after `time` seconds.
    pub(crate) fn head_for_target(&mut self, time: f32) {
        if self.is_dynamic() {
            return;
        }
        self.center = self.at.translation.into();
        self.velocity = (Vec3::from(self.target.translation) - self.center) / time;
        let turn = self.target.rotation * self.at.rotation.inverse();
        // The short way round.
        let turn = if turn.w < 0.0 { -turn } else { turn };
        self.angular_velocity = turn.to_scaled_axis() / time;
    }

    /// Moves a kinematic solid on by `step` of the `left` seconds until it is at its target.
    pub(crate) fn follow(&mut self, rigid_world: &mut PhysicsWorld, step: f32, left: f32) {
        self.before = self.at;
        if self.is_dynamic() || self.at == self.target {
            return;
        }
        let share = (step / left).clamp(0.0, 1.0);
        self.at = if share > 0.999 {
            self.target
        } else {
            Isometry3d::new(
                self.at.translation.lerp(self.target.translation, share),
                self.at.rotation.slerp(self.target.rotation, share),
            )
        };
        self.center = self.at.translation.into();
        if let Some(body) = rigid_world.bodies.get_mut(self.body) {
            body.set_next_kinematic_position(pose(self.at));
        }
    }

    /// How much faster an impulse of 1 N s at a world-space `place` along `normal` makes it there:
    /// 1/kg, 0 for kinematic solids.
    pub(crate) fn mobility(&self, rigid_world: &PhysicsWorld, place: Vec3, normal: Vec3) -> f32 {
        let Some(body) = rigid_world
            .bodies
            .get(self.body)
            .filter(|_| self.is_dynamic())
        else {
            return 0.0;
        };
        let mass = &body.mass_properties();
        let lever = rigid((place - self.center).cross(normal));
        let turning = mass.effective_world_inv_inertia * lever;
        mass.effective_inv_mass.max_element() + lever.dot(turning)
    }

    /// Takes an impulse (N s) at a world-space `place`.
    pub(crate) fn receive(&mut self, place: Vec3, impulse: Vec3) {
        self.push += impulse;
        self.turn += (place - self.center).cross(impulse);
    }

    /// Applies the liquid's impulse to a body.
    pub(crate) fn take_push(&mut self, rigid_world: &mut PhysicsWorld) {
        let [push, turn] = [&mut self.push, &mut self.turn].map(core::mem::take);
        if !push.is_finite() || !turn.is_finite() {
            return;
        }
        self.pushed += push;
        self.turned += turn;
        if self.is_dynamic()
            && let Some(body) = rigid_world.bodies.get_mut(self.body)
        {
            body.apply_impulse(rigid(push), true);
            body.apply_torque_impulse(rigid(turn), true);
        }
    }

    /// Speed, m/s, at the most that of a point a metre from the axis of its turn.
    pub(crate) fn speed(&self) -> f32 {
        self.velocity.length() + self.angular_velocity.length()
    }

    /// World-space velocity of the solid at a world-space `place`.
    pub(crate) fn velocity_at(&self, place: Vec3) -> Vec3 {
        self.velocity + self.angular_velocity.cross(place - self.center)
    }
}

fn set_velocities(body: &mut RigidBody, [velocity, angular_velocity]: [Vec3; 2]) {
    body.set_linvel(rigid(velocity), true);
    body.set_angvel(rigid(angular_velocity), true);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_altered_body_has_another_mass_and_the_same_motion() {
        let mut rigid_world = PhysicsWorld::new();
        let mut liquid_world = super::super::new_liquid_world(0.05);
        let traits = |density: f32, x: f32| Traits {
            motion: Motion::Dynamic {
                density,
                velocity: Vec3::X * x,
                angular_velocity: Vec3::ZERO,
            },
            contact: Contact {
                friction: 0.5,
                restitution: 0.0,
            },
            feels: false,
        };
        let mut solid = Solid::new(
            &mut rigid_world,
            &mut liquid_world,
            Geometry::cuboid(Vec3::splat(0.5)),
            traits(100.0, 1.0),
            Isometry3d::IDENTITY,
        );
        let mass = |world: &PhysicsWorld, solid: &Solid| world.bodies[solid.body].mass();
        assert!((mass(&rigid_world, &solid) - 100.0).abs() < 1e-3);
        // It has been pushed since.
        set_velocities(&mut rigid_world.bodies[solid.body], [Vec3::Y, Vec3::Z]);
        solid.alter(&mut rigid_world, traits(300.0, 1.0));
        assert!((mass(&rigid_world, &solid) - 300.0).abs() < 1e-3);
        assert_eq!([solid.velocity, solid.angular_velocity], [Vec3::Y, Vec3::Z]);
        solid.alter(&mut rigid_world, traits(300.0, 2.0));
        assert_eq!(solid.velocity, Vec3::X * 2.0);
    }
}
