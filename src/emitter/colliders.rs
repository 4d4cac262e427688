//! What particles bounce off.

use bevy::{
    math::{Affine3A, Mat3A, Vec3A, bounding::Aabb3d},
    prelude::*,
};

use super::distance::Solid;
use crate::range::SettingRange;

/// A solid that the particles of every [`ParticleEmitter`](super::ParticleEmitter) bounce off. It
/// follows its entity: the scale of the transform counts, and a collider that moves or turns takes
/// particles along. It is made from a shape of Bevy's, or by [`ground`](Self::ground).
///
/// Particles touch it with their radius. One that is narrowly wedged between two solids may be pressed
/// into one of them. Values out of their range are said once in the log and taken as the nearest that
/// is in range.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_fluid::prelude::*;
/// # fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
/// let ball = Sphere::new(0.3);
/// commands.spawn((
///     Mesh3d(meshes.add(ball)),
///     ParticleCollider { restitution: 0.6, ..ball.into() },
///     Transform::from_xyz(0.0, 1.0, 0.0),
/// ));
/// # }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, ColliderPath)]
pub struct ParticleCollider {
    /// What it looks like. Default: the ground.
    pub shape: ColliderShape,
    /// Share of the speed, across the surface, that is left after a bounce. Range 0..=1, default 0.2.
    /// Higher: particles bounce; 0: they stay on it.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
    /// Force along the surface over force across it, at most (Coulomb's coefficient). Range 0..=1000,
    /// default 0.2. Higher: particles stop sooner and stay on steeper slopes.
    #[reflect(@SettingRange::new(0.0, 1e3).logarithmic())]
    pub friction: f32,
}

/// The shape of a [`ParticleCollider`], in its entity's space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum ColliderShape {
    /// All that is below the xz plane.
    #[default]
    Ground,
    /// A ball about the origin. Under a scale that is not the same along all axes, the greatest
    /// counts.
    Sphere {
        /// Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        radius: f32,
    },
    /// A box about the origin, along the axes.
    Cuboid {
        /// Half of its sides. Unit: m, range 0..=1e6 each.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        half_size: Vec3,
    },
    /// A cylinder along y with half a ball at each end. Of the scales along x and z the greater
    /// counts for the radius.
    Capsule {
        /// Of the cylinder and the balls. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        radius: f32,
        /// Half of the cylinder's length, the balls left out. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        half_length: f32,
    },
}

impl ParticleCollider {
    /// The default: the ground.
    pub const DEFAULT: Self = Self {
        shape: ColliderShape::Ground,
        restitution: 0.2,
        friction: 0.2,
    };

    /// All that is below the entity's xz plane.
    pub const fn ground() -> Self {
        Self::DEFAULT
    }
}

impl Default for ParticleCollider {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl From<ColliderShape> for ParticleCollider {
    fn from(shape: ColliderShape) -> Self {
        Self {
            shape,
            ..Self::DEFAULT
        }
    }
}

impl From<Sphere> for ParticleCollider {
    fn from(Sphere { radius }: Sphere) -> Self {
        ColliderShape::Sphere { radius }.into()
    }
}

impl From<Cuboid> for ParticleCollider {
    fn from(Cuboid { half_size }: Cuboid) -> Self {
        ColliderShape::Cuboid { half_size }.into()
    }
}

impl From<Capsule3d> for ParticleCollider {
    fn from(capsule: Capsule3d) -> Self {
        ColliderShape::Capsule {
            radius: capsule.radius,
            half_length: capsule.half_length,
        }
        .into()
    }
}

/// Where a collider was at the end of the last frame.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(super) struct ColliderPath(Option<Pose>);

/// Where a collider is, without its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    rotation: Quat,
    translation: Vec3A,
}

impl Pose {
    fn to_world(self, point: Vec3A) -> Vec3A {
        self.rotation * point + self.translation
    }

    fn to_local(self, point: Vec3A) -> Vec3A {
        self.rotation.inverse() * (point - self.translation)
    }
}

/// A collider in the world during a step.
#[derive(Debug)]
pub(super) struct Collider {
    pub(super) solid: Solid,
    pub(super) restitution: f32,
    pub(super) friction: f32,
    /// At the end of the step.
    world_from_local: Affine3A,
    local_from_world: Affine3A,
    /// From where to where it moves, if it does.
    path: Option<[Pose; 2]>,
    reach: Reach,
}

/// Where a collider is within a step, roughly.
#[derive(Clone, Copy, Debug)]
enum Reach {
    /// Below two planes, at the step's begin and end: normals, and heights along them.
    Below([(Vec3A, f32); 2]),
    Within(Aabb3d),
}

impl Collider {
    /// `None` for a transform that leads nowhere.
    fn new(
        collider: &ParticleCollider,
        transform: &GlobalTransform,
        path: &mut ColliderPath,
    ) -> Option<Self> {
        let collider = collider.clamped();
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        if !(translation.is_finite() && rotation.is_normalized()) {
            return None;
        }
        let to = Pose {
            rotation,
            translation: translation.into(),
        };
        let from = path.0.replace(to).unwrap_or(to);
        let scale = scale.abs();
        let solid = match collider.shape {
            ColliderShape::Ground => Solid::HalfSpace,
            ColliderShape::Sphere { radius } => Solid::Sphere {
                radius: radius * scale.max_element(),
            },
            ColliderShape::Cuboid { half_size } => Solid::Cuboid {
                half_size: (half_size * scale).into(),
            },
            ColliderShape::Capsule {
                radius,
                half_length,
            } => Solid::Capsule {
                radius: radius * scale.x.max(scale.z),
                half_length: half_length * scale.y,
            },
        };
        let world_from_local = Affine3A::from_rotation_translation(rotation, translation);
        Some(Self {
            solid,
            restitution: collider.restitution,
            friction: collider.friction,
            world_from_local,
            local_from_world: world_from_local.inverse(),
            path: (from != to).then_some([from, to]),
            reach: Reach::new(&solid, [from, to]),
        })
    }

    /// A point in the collider's space after a part of the step.
    #[inline]
    pub(super) fn to_local(&self, part: f32, point: Vec3A) -> Vec3A {
        match self.pose(part) {
            Some(pose) => pose.to_local(point),
            None => self.local_from_world.transform_point3a(point),
        }
    }

    /// A point of the collider in the world after a part of the step.
    #[inline]
    pub(super) fn to_world(&self, part: f32, point: Vec3A) -> Vec3A {
        match self.pose(part) {
            Some(pose) => pose.to_world(point),
            None => self.world_from_local.transform_point3a(point),
        }
    }

    /// A direction of the collider in the world after a part of the step.
    #[inline]
    pub(super) fn turn(&self, part: f32, direction: Vec3A) -> Vec3A {
        match self.pose(part) {
            Some(pose) => pose.rotation * direction,
            None => self.world_from_local.transform_vector3a(direction),
        }
    }

    /// Where it is after a part of the step, on its way.
    fn pose(&self, part: f32) -> Option<Pose> {
        self.path.map(|[from, to]| Pose {
            rotation: from.rotation.lerp(to.rotation, part),
            translation: from.translation.lerp(to.translation, part),
        })
    }

    pub(super) fn moves(&self) -> bool {
        self.path.is_some()
    }

    /// How far a point of it, in its own space, gets in the step.
    #[inline]
    pub(super) fn way(&self, point: Vec3A) -> Vec3A {
        self.path.map_or(Vec3A::ZERO, |[from, to]| {
            to.to_world(point) - from.to_world(point)
        })
    }

    /// Whether a ball of `radius` may touch it on its straight way. Cheap, and never wrong about
    /// those that do.
    #[inline]
    pub(super) fn is_near(&self, start: Vec3A, end: Vec3A, radius: f32) -> bool {
        match &self.reach {
            Reach::Below([(from, from_height), (to, to_height)]) => {
                (from.dot(start) - from_height).min(to.dot(end) - to_height) <= radius
            }
            Reach::Within(bounds) => overlaps(bounds, start, end, radius),
        }
    }
}

#[inline]
fn overlaps(bounds: &Aabb3d, start: Vec3A, end: Vec3A, radius: f32) -> bool {
    let (low, high) = (start.min(end) - radius, start.max(end) + radius);
    (low.cmple(bounds.max) & high.cmpge(bounds.min)).all()
}

impl Reach {
    fn new(solid: &Solid, poses: [Pose; 2]) -> Self {
        let half_size = match *solid {
            Solid::HalfSpace => {
                return Self::Below(poses.map(|pose| {
                    let normal = pose.rotation * Vec3A::Y;
                    (normal, normal.dot(pose.translation))
                }));
            }
            Solid::Sphere { radius } => Vec3A::splat(radius),
            Solid::Cuboid { half_size } => half_size,
            Solid::Capsule {
                radius,
                half_length,
            } => Vec3A::new(radius, radius + half_length, radius),
        };
        let [from, to] = poses.map(|pose| pose.translation);
        let reach = if poses[0].rotation == poses[1].rotation {
            let turned = Mat3A::from_quat(poses[0].rotation);
            turned.x_axis.abs() * half_size.x
                + turned.y_axis.abs() * half_size.y
                + turned.z_axis.abs() * half_size.z
        } else {
            // While it turns, it may reach as far as its corners.
            Vec3A::splat(half_size.length())
        };
        Self::Within(Aabb3d {
            min: from.min(to) - reach,
            max: from.max(to) + reach,
        })
    }
}

/// All colliders during a step.
#[derive(Debug)]
pub(super) struct Colliders {
    /// Half-spaces first.
    list: Vec<Collider>,
    half_spaces: usize,
    /// Around all others.
    bounds: Aabb3d,
}

impl Default for Colliders {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            half_spaces: 0,
            bounds: NOWHERE,
        }
    }
}

/// A box that nothing is in.
const NOWHERE: Aabb3d = Aabb3d {
    min: Vec3A::INFINITY,
    max: Vec3A::NEG_INFINITY,
};

impl Colliders {
    /// Lists all as they are during this step.
    pub(super) fn gather(
        &mut self,
        colliders: &mut Query<(&ParticleCollider, &GlobalTransform, &mut ColliderPath)>,
    ) {
        self.list.clear();
        self.half_spaces = 0;
        self.bounds = NOWHERE;
        for (collider, transform, mut path) in colliders {
            let Some(collider) = Collider::new(collider, transform, &mut path) else {
                continue;
            };
            let reach = collider.reach;
            self.list.push(collider);
            match reach {
                Reach::Below(_) => {
                    let last = self.list.len() - 1;
                    self.list.swap(self.half_spaces, last);
                    self.half_spaces += 1;
                }
                Reach::Within(bounds) => {
                    self.bounds.min = self.bounds.min.min(bounds.min);
                    self.bounds.max = self.bounds.max.max(bounds.max);
                }
            }
        }
    }

    pub(super) fn list(&self) -> &[Collider] {
        &self.list
    }

    /// Whether a ball of `radius` may touch any on its straight way. Never wrong about those that
    /// do.
    #[inline]
    pub(super) fn any_near(&self, start: Vec3A, end: Vec3A, radius: f32) -> bool {
        let is_near = |collider: &Collider| collider.is_near(start, end, radius);
        let (half_spaces, others) = self.list.split_at(self.half_spaces);
        half_spaces.iter().any(is_near)
            || overlaps(&self.bounds, start, end, radius) && others.iter().any(is_near)
    }
}
