//! The surroundings of the liquid, which it refracts and reflects.
//!
//! ```
//! use bevy::{math::bounding::Aabb3d, prelude::*};
//! use fluid_stage::scenery::{Scenery, frame_camera, orbit_camera};
//!
//! fn setup(mut scenery: Scenery) {
//!     let tank = Aabb3d::new(Vec3::Y, Vec3::ONE);
//!     let to_sun = Vec3::new(0.6, 0.8, 0.5);
//!     scenery.checker_floor(Vec3::ZERO, 6.0, 12);
//!     scenery.pillars(tank, 5);
//!     scenery.tank(tank);
//!     scenery.sun(to_sun, 12.0, true);
//!     let sky = scenery.sky(to_sun);
//!     let (eye, target) = frame_camera(tank, 45_f32.to_radians(), 16.0 / 9.0);
//!     scenery.commands.spawn((orbit_camera(eye, target), sky.bundle()));
//! }
//! ```

mod camera;
mod cubemap;
mod floor;
mod pillars;
mod sky;
mod sun;
mod tank;

pub use camera::{PanOrbitCameraSystemSet, frame_camera, orbit_camera, turn_cameras};
pub use cubemap::sky_cubemap;
pub use sky::Sky;

use bevy::{ecs::system::SystemParam, prelude::*};

/// A system parameter that builds scenery. Lengths are in metres, as in Bevy's lights.
#[derive(SystemParam)]
pub struct Scenery<'w, 's> {
    /// Spawns entities.
    pub commands: Commands<'w, 's>,
    /// Shapes.
    pub meshes: ResMut<'w, Assets<Mesh>>,
    /// Surfaces.
    pub materials: ResMut<'w, Assets<StandardMaterial>>,
    /// Textures and sky.
    pub images: ResMut<'w, Assets<Image>>,
}
