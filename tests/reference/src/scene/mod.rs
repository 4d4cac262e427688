//! Scenes whose surface is known exactly, filled with particles.
//!
//! The exact surface is where the particles' own outermost surfaces end: the outermost centres
//! lie one particle radius inside of it. A droplet is one particle, and so a sphere of its radius.

mod catalogue;
mod sampling;

use glam::{DVec3, UVec2, Vec3};

use crate::{Camera, Lens, Surface};

pub use catalogue::{
    DEPTH_STEP, all, depth_step, half_filled_box, pool_and_droplets, rippled_pool, slab, sphere,
    thin_sheet, tilted_plane, tilted_plate, two_spheres,
};
pub use sampling::{fill_cuboid, fill_pool, fill_sphere};

/// A body of liquid, exactly and as particles.
pub struct Scene {
    /// What it is called in reports.
    pub name: &'static str,
    /// The exact surface, in world space.
    pub surface: Box<dyn Surface>,
    /// Centres of the particles, m.
    pub particles: Vec<DVec3>,
    /// Radius of the particles, m; they are about two radii apart.
    pub radius: f64,
    /// A good place to look from, m.
    pub eye: DVec3,
    /// What to look at from there, m.
    pub target: DVec3,
}

impl Scene {
    /// A perspective camera at the scene's own place: 40° high, near plane at 0.1 m.
    pub fn camera(&self, size: UVec2) -> Camera {
        let lens = Lens::Perspective {
            fov: 40_f64.to_radians(),
            near: 0.1,
        };
        Camera::new(size, lens).looking_at(self.eye, self.target)
    }

    /// The centres as the renderer takes them, m.
    pub fn positions(&self) -> Vec<Vec3> {
        self.particles.iter().map(|p| p.as_vec3()).collect()
    }
}
