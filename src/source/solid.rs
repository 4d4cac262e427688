//! The shapes of solids that particles meet, whoever moves the particles.

use bevy::prelude::*;

use crate::settings::SettingRange;

/// The shape of a convex solid in the space of its entity: Bevy's primitives, around the origin,
/// and the ground. Each primitive converts into it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum SolidShape {
    /// Everything below the xz plane.
    #[default]
    Ground,
    /// A ball. With a non-uniform scale, the largest component applies.
    Sphere {
        /// Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic().initial(0.1))]
        radius: f32,
    },
    /// A box along the axes.
    Cuboid {
        /// Half of its side lengths. Unit: m, range 0..=1e6 each.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        half_size: Vec3,
    },
    /// A cylinder along y with a hemisphere at each end. The greater of the scales along x and z
    /// applies to the radius.
    Capsule {
        /// Radius of the cylinder and the hemispheres. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic().initial(0.1))]
        radius: f32,
        /// Half of the cylinder's length, without the hemispheres. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic().initial(0.1))]
        half_length: f32,
    },
    /// A cylinder along y. The greater of the scales along x and z applies to the radius.
    Cylinder {
        /// Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic().initial(0.1))]
        radius: f32,
        /// Half of its height. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic().initial(0.1))]
        half_height: f32,
    },
}

impl SolidShape {
    /// The shape in the world, of an entity of this scale.
    pub(crate) fn scaled(self, scale: Vec3) -> Self {
        let scale = scale.abs();
        let across = scale.x.max(scale.z);
        match self {
            Self::Ground => Self::Ground,
            Self::Sphere { radius } => Self::Sphere {
                radius: radius * scale.max_element(),
            },
            Self::Cuboid { half_size } => Self::Cuboid {
                half_size: half_size * scale,
            },
            Self::Capsule {
                radius,
                half_length,
            } => Self::Capsule {
                radius: radius * across,
                half_length: half_length * scale.y,
            },
            Self::Cylinder {
                radius,
                half_height,
            } => Self::Cylinder {
                radius: radius * across,
                half_height: half_height * scale.y,
            },
        }
    }
}

impl From<Sphere> for SolidShape {
    fn from(Sphere { radius }: Sphere) -> Self {
        Self::Sphere { radius }
    }
}

impl From<Cuboid> for SolidShape {
    fn from(Cuboid { half_size }: Cuboid) -> Self {
        Self::Cuboid { half_size }
    }
}

impl From<Capsule3d> for SolidShape {
    fn from(capsule: Capsule3d) -> Self {
        Self::Capsule {
            radius: capsule.radius,
            half_length: capsule.half_length,
        }
    }
}

impl From<Cylinder> for SolidShape {
    fn from(cylinder: Cylinder) -> Self {
        Self::Cylinder {
            radius: cylinder.radius,
            half_height: cylinder.half_height,
        }
    }
}
