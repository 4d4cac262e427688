//! What particles bounce off.

use bevy::prelude::*;

use super::distance::Solid;

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
    pub restitution: f32,
    /// Force along the surface over force across it, at most (Coulomb's coefficient). Range 0..=1000,
    /// default 0.2. Higher: particles stop sooner and stay on steeper slopes.
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
        radius: f32,
    },
    /// A box about the origin, along the axes.
    Cuboid {
        /// Half of its sides. Unit: m, range 0..=1e6 each.
        half_size: Vec3,
    },
    /// A cylinder along y with half a ball at each end. Of the scales along x and z the greater
    /// counts for the radius.
    Capsule {
        /// Of the cylinder and the balls. Unit: m, range 0..=1e6.
        radius: f32,
        /// Half of the cylinder's length, the balls left out. Unit: m, range 0..=1e6.
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
pub(super) struct Pose {
    rotation: Quat,
    translation: Vec3,
}

impl Pose {
    pub(super) fn to_world(self, point: Vec3) -> Vec3 {
        self.rotation * point + self.translation
    }

    pub(super) fn to_local(self, point: Vec3) -> Vec3 {
        self.rotation.inverse() * (point - self.translation)
    }

    pub(super) fn turn(self, vector: Vec3) -> Vec3 {
        self.rotation * vector
    }
}

/// A collider in the world during a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collider {
    pub(super) solid: Solid,
    pub(super) restitution: f32,
    pub(super) friction: f32,
    from: Pose,
    to: Pose,
    moves: bool,
    reach: Reach,
}

/// Where a collider is within a step, roughly.
#[derive(Clone, Copy, Debug)]
enum Reach {
    /// Below two planes, at the step's begin and end: normals, and heights along them.
    Below([(Vec3, f32); 2]),
    Within {
        min: Vec3,
        max: Vec3,
    },
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
            translation,
        };
        let from = path.0.replace(to).unwrap_or(to);
        let scale = scale.abs();
        let solid = match collider.shape {
            ColliderShape::Ground => Solid::HalfSpace,
            ColliderShape::Sphere { radius } => Solid::Sphere {
                radius: radius * scale.max_element(),
            },
            ColliderShape::Cuboid { half_size } => Solid::Cuboid {
                half_size: half_size * scale,
            },
            ColliderShape::Capsule {
                radius,
                half_length,
            } => Solid::Capsule {
                radius: radius * scale.x.max(scale.z),
                half_length: half_length * scale.y,
            },
        };
        let moves = from != to;
        Some(Self {
            solid,
            restitution: collider.restitution,
            friction: collider.friction,
            from,
            to,
            moves,
            reach: Reach::new(&solid, [from, to]),
        })
    }

    /// Where it is after a part of the step.
    pub(super) fn pose(&self, part: f32) -> Pose {
        if !self.moves {
            return self.to;
        }
        Pose {
            rotation: self.from.rotation.lerp(self.to.rotation, part),
            translation: self.from.translation.lerp(self.to.translation, part),
        }
    }

    /// How far a point of it, in its own space, gets in the step.
    pub(super) fn way(&self, point: Vec3) -> Vec3 {
        if !self.moves {
            return Vec3::ZERO;
        }
        self.to.to_world(point) - self.from.to_world(point)
    }

    /// Whether a ball of `radius` may touch it on its straight way. Cheap, and never wrong about
    /// those that do.
    pub(super) fn is_near(&self, start: Vec3, end: Vec3, radius: f32) -> bool {
        match self.reach {
            Reach::Below(planes) => planes
                .into_iter()
                .zip([start, end])
                .any(|((normal, height), point)| normal.dot(point) <= height + radius),
            Reach::Within { min, max } => {
                (start.min(end) - radius).cmple(max).all()
                    && (start.max(end) + radius).cmpge(min).all()
            }
        }
    }
}

impl Reach {
    fn new(solid: &Solid, poses: [Pose; 2]) -> Self {
        let half_size = match *solid {
            Solid::HalfSpace => {
                return Self::Below(poses.map(|pose| {
                    let normal = pose.turn(Vec3::Y);
                    (normal, normal.dot(pose.translation))
                }));
            }
            Solid::Sphere { radius } => Vec3::splat(radius),
            Solid::Cuboid { half_size } => half_size,
            Solid::Capsule {
                radius,
                half_length,
            } => vec3(radius, radius + half_length, radius),
        };
        let [from, to] = poses.map(|pose| pose.translation);
        let reach = if poses[0].rotation == poses[1].rotation {
            let turned = Mat3::from_quat(poses[0].rotation);
            turned.x_axis.abs() * half_size.x
                + turned.y_axis.abs() * half_size.y
                + turned.z_axis.abs() * half_size.z
        } else {
            // While it turns, it may reach as far as its corners.
            Vec3::splat(half_size.length())
        };
        Self::Within {
            min: from.min(to) - reach,
            max: from.max(to) + reach,
        }
    }
}

/// Lists all colliders as they are during this step.
pub(super) fn gather(
    colliders: &mut Query<(&ParticleCollider, &GlobalTransform, &mut ColliderPath)>,
    list: &mut Vec<Collider>,
) {
    list.clear();
    list.extend(
        colliders
            .iter_mut()
            .filter_map(|(collider, transform, mut path)| {
                Collider::new(collider, transform, &mut path)
            }),
    );
}
