//! What stands on an entity to be simulated.

use bevy::prelude::*;

use crate::{emitter::ExternalMotion, particles::FluidParticles};

/// A fluid that salva moves.
///
/// The positions of the [`FluidParticles`] beside it are where it starts; from then on they are
/// overwritten. Particles within a solid (that is no mesh) are
/// taken out at the start. To start anew, write positions
/// yourself: they are taken over, at [`velocity`](Self::velocity). Neighbours at rest are two radii
/// apart: fill with a lattice of that spacing, one radius off the walls.
///
/// All fluids have one radius in the world, that of the first; another is said once in the log, and
/// stays where it is. Fluids of different [`density`](Self::density) press on each other and part.
///
/// A [`ParticleEmitter`](crate::ParticleEmitter) beside it lets particles into the simulation, no
/// more than fit beside each other; its lifetime, capacity and bounds hold, its gravity and drag do
/// not.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_fluid::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands.spawn((
///         SalvaBoundary::tank(vec3(1.0, 0.8, 1.0)),
///         Transform::from_xyz(0.0, 0.4, 0.0),
///     ));
///     let column = (0..4000)
///         .map(|i| ivec3(i % 10, i / 200, i / 10 % 20).as_vec3() * 0.05)
///         .map(|place| place + vec3(-0.475, 0.025, -0.475))
///         .collect();
///     commands.spawn((FluidParticles::new(column, 0.025), SalvaFluid::WATER));
/// }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(FluidParticles, ExternalMotion)]
pub struct SalvaFluid {
    /// Density at rest. Unit: kg/m³, range 1..=100000, default 1000. Against it bodies float or
    /// sink.
    pub density: f32,
    /// Kinematic viscosity. Unit: m²/s, range 0..=10, default 0.01. That is honey's; water's own
    /// (1e-6) is far below what particles of some centimetres resolve, and less than about 0.005
    /// only lets them rattle. Above about 0.08 radius² / step (0.06 for 2.5 cm at the default step)
    /// it has no further effect.
    pub viscosity: f32,
    /// The same between the fluid and solids: how much they hold it back, or drag it along.
    /// Unit: m²/s, range 0..=10, default 0.002. 0: it slips.
    pub wall_viscosity: f32,
    /// Share of its velocity that each particle loses to the air. Unit: 1/s, range 0..=1000,
    /// default 0.
    pub drag: f32,
    /// How much the surface contracts: γ of Akinci et al. 2013. Range 0..=10, default 0; about 1
    /// for drops of water. It costs a third more time.
    pub surface_tension: f32,
    /// How much it clings to solids: β of Akinci et al. 2013. Range 0..=10, default 0.
    pub adhesion: f32,
    /// What it starts with, in the world's space. Unit: m/s, default 0.
    pub velocity: Vec3,
}

impl SalvaFluid {
    /// Water in particles of some centimetres: the default.
    pub const WATER: Self = Self {
        density: 1000.0,
        viscosity: 0.01,
        wall_viscosity: 0.002,
        drag: 0.0,
        surface_tension: 0.0,
        adhesion: 0.0,
        velocity: Vec3::ZERO,
    };

    /// Honey: heavy, slow, and it clings.
    pub const HONEY: Self = Self {
        density: 1420.0,
        viscosity: 0.05,
        wall_viscosity: 0.05,
        adhesion: 1.0,
        ..Self::WATER
    };
}

impl Default for SalvaFluid {
    fn default() -> Self {
        Self::WATER
    }
}

/// A shape in the space of its entity, whose scale counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum SalvaShape {
    /// The entity's `Mesh3d`, which must be kept in the main world (`RenderAssetUsages`). For a
    /// boundary its triangles: liquid is where their faces look, so a closed mesh keeps it out
    /// or, with its walls modelled, in; walls should be two radii thick. For a body their convex
    /// hull. What changes within a mesh later is not noticed.
    #[default]
    Mesh,
    /// A solid block about the origin.
    Cuboid {
        /// Whole sides. Unit: m, > 0.
        size: Vec3,
    },
    /// A box about the origin with liquid inside, open above. Only for boundaries.
    Tank {
        /// Whole sides of the inside. Unit: m, > 0.
        size: Vec3,
    },
    /// A ball about the origin. Of an uneven scale the greatest counts.
    Sphere {
        /// Unit: m, > 0.
        radius: f32,
    },
    /// A capsule along y about the origin. Of an uneven scale the greatest counts.
    Capsule {
        /// Unit: m, > 0.
        radius: f32,
        /// Between the centres of its caps. Unit: m, from 0.
        length: f32,
    },
    /// A cylinder along y about the origin. Of an uneven scale the greatest counts.
    Cylinder {
        /// Unit: m, > 0.
        radius: f32,
        /// Unit: m, > 0.
        height: f32,
    },
    /// The endless ground below the entity's plane y = 0. Only for boundaries.
    Plane,
}

/// A solid that liquid and [`SalvaBody`]s run against: at rest, or moved by its transform.
///
/// Between two frames it moves evenly, and its velocity counts: a plunger makes waves, a tipped
/// tank pours. To have it elsewhere at once, insert it again. No particle passes its surface, from
/// neither side, however fast.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct SalvaBoundary {
    /// Default: the entity's mesh.
    pub shape: SalvaShape,
    /// Friction of bodies on it. Range 0..=10, default 0.5.
    pub friction: f32,
    /// How much bodies bounce off it. Range 0..=1, default 0.
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
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct SalvaBody {
    /// Default: the convex hull of the entity's mesh.
    pub shape: SalvaShape,
    /// Unit: kg/m³, range 20..=100000, default 500: wood. Lighter than a fifth of the liquid it
    /// trembles, as the liquid answers a step late.
    pub density: f32,
    /// What it starts with. Unit: m/s, default 0.
    pub velocity: Vec3,
    /// What it starts with. Unit: rad/s, default 0.
    pub angular_velocity: Vec3,
    /// Range 0..=10, default 0.5.
    pub friction: f32,
    /// How much it bounces. Range 0..=1, default 0.2.
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
