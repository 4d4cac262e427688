//! What stands on a solid to be simulated, and what it tells.

use bevy::prelude::*;

use crate::range::SettingRange;

/// A shape in the space of its entity, whose scale counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum SalvaShape {
    /// The entity's `Mesh3d`, which must be kept in the main world (`RenderAssetUsages`). For a
    /// boundary its triangles: liquid is where their faces look, so a closed mesh keeps it out
    /// or, with its walls modelled, in; walls should be two radii thick. For a body their convex
    /// hull, which must have a volume. What changes within a mesh later is not noticed.
    #[default]
    Mesh,
    /// A solid block about the origin.
    Cuboid {
        /// Whole sides. Unit: m, > 0.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic())]
        size: Vec3,
    },
    /// A box about the origin with liquid inside, open above. Only for boundaries.
    Tank {
        /// Whole sides of the inside. Unit: m, > 0.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic())]
        size: Vec3,
    },
    /// A ball about the origin. Of an uneven scale the greatest counts.
    Sphere {
        /// Unit: m, > 0.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic().start(0.1))]
        radius: f32,
    },
    /// A capsule along y about the origin. Of an uneven scale the greatest counts.
    Capsule {
        /// Unit: m, > 0.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic().start(0.1))]
        radius: f32,
        /// Between the centres of its caps. Unit: m, from 0.
        #[reflect(@SettingRange::new(0.0, 1e3).unit("m").logarithmic().start(0.2))]
        length: f32,
    },
    /// A cylinder along y about the origin. Of an uneven scale the greatest counts.
    Cylinder {
        /// Unit: m, > 0.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic().start(0.1))]
        radius: f32,
        /// Unit: m, > 0.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic().start(0.2))]
        height: f32,
    },
    /// The endless ground below the entity's plane y = 0. Only for boundaries.
    Plane,
}

/// A solid that liquid and [`SalvaBody`]s run against: at rest, or moved by its transform.
///
/// Between two frames it moves evenly, and its velocity counts: a plunger makes waves, a tipped
/// tank pours. To have it elsewhere at once, insert it again; what is moved faster than
/// [`SalvaSettings::max_speed`](super::SalvaSettings::max_speed) is so by itself. No particle passes
/// its surface, from neither side, however fast.
///
/// It is always where its transform is, also where the liquid moves in slow motion: at a fifth of the
/// speed a plunger of 1 m/s would hit it with 5. Move it in the liquid's time where that matters: by
/// `time.delta_secs() * status.speed` of [`SalvaStatus`](super::SalvaStatus).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct SalvaBoundary {
    /// Default: the entity's mesh.
    pub shape: SalvaShape,
    /// Friction of bodies on it. Range 0..=10, default 0.5.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub friction: f32,
    /// How much bodies bounce off it. Range 0..=1, default 0.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
}

impl SalvaBoundary {
    /// The surface of the entity's `Mesh3d`.
    pub const MESH: Self = Self::new(SalvaShape::Mesh);
    /// Endless ground.
    pub const PLANE: Self = Self::new(SalvaShape::Plane);

    /// A boundary of a shape.
    pub const fn new(shape: SalvaShape) -> Self {
        Self {
            shape,
            friction: 0.5,
            restitution: 0.0,
        }
    }

    /// A box that liquid is in, open above; `size` (m) of the inside.
    pub const fn tank(size: Vec3) -> Self {
        Self::new(SalvaShape::Tank { size })
    }

    /// A block of some `size` (m).
    pub const fn cuboid(size: Vec3) -> Self {
        Self::new(SalvaShape::Cuboid { size })
    }
}

impl Default for SalvaBoundary {
    fn default() -> Self {
        Self::MESH
    }
}

/// A rigid body that rapier moves and liquid pushes, and that pushes liquid back: it floats where
/// its [`density`](Self::density) is less than the fluid's.
///
/// Its `Transform` is written in every update, as the world's: it must have no parent. A transform
/// written by somebody else is taken over, at rest. Its size should be some particles across.
///
/// What else is changed leaves its motion alone; inserted again it starts anew. Beside a
/// [`SalvaBoundary`], it is what counts.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct SalvaBody {
    /// Default: the convex hull of the entity's mesh.
    pub shape: SalvaShape,
    /// Unit: kg/m³, range 20..=100000, default 500: wood. Lighter than a fifth of the liquid it
    /// trembles, as the liquid answers a step late.
    #[reflect(@SettingRange::new(20.0, 1e5).unit("kg/m³").logarithmic())]
    pub density: f32,
    /// What it starts with; changed later, what it is given at once. Unit: m/s, default 0.
    #[reflect(@SettingRange::new(-100.0, 100.0).unit("m/s").open())]
    pub velocity: Vec3,
    /// What it starts with; changed later, what it is given at once together with the velocity.
    /// Unit: rad/s, default 0.
    #[reflect(@SettingRange::new(-100.0, 100.0).unit("rad/s").open())]
    pub angular_velocity: Vec3,
    /// Range 0..=10, default 0.5.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub friction: f32,
    /// How much it bounces. Range 0..=1, default 0.2.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
}

impl SalvaBody {
    /// A body of a shape and a density (kg/m³), at rest.
    pub const fn new(shape: SalvaShape, density: f32) -> Self {
        Self {
            shape,
            density,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            friction: 0.5,
            restitution: 0.2,
        }
    }
}

impl Default for SalvaBody {
    fn default() -> Self {
        Self::new(SalvaShape::Mesh, 500.0)
    }
}

/// Beside a [`SalvaBoundary`] or a [`SalvaBody`]: what liquid does to it. Written whenever steps are
/// finished.
///
/// For scales and triggers, and for whoever moves a boundary with a physics engine of their own:
/// rapier worlds outside of this crate are not coupled directly.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct SalvaLoad {
    /// In the world's space, as a mean over the finished steps. Unit: N.
    pub force: Vec3,
    /// About the body's centre of mass, or the boundary's origin. Unit: N m.
    pub torque: Vec3,
}
