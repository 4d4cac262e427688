//! The truth that a renderer of particle liquids is measured against.
//!
//! All in f64 and without Bevy. From the strongest truth to the weakest:
//!
//! 1. [`scene`]: bodies whose surface is known in closed form, with particles that fill them.
//! 2. [`ellipsoids`]: the exact union of the ellipsoids that the renderer splats.
//! 3. [`yu_turk`]: the implicit surface that those ellipsoids stand for.
//! 4. [`mesh`]: the renderer's own depth layers as triangles.
//!
//! Each of them is a [`Surface`]: a ray goes in, its crossings come out. [`layers`] makes depth
//! and normal images of one, [`tracer`] sends light through it, and [`metrics`] compares images.
//!
//! ```
//! use fluid_reference::{layers, scene, tracer::{Optics, Sky, Tracer, World}};
//! use glam::{DVec3, UVec2};
//!
//! let scene = scene::sphere(0.1);
//! let camera = scene.camera(UVec2::splat(32));
//! let truth = layers(&camera, &*scene.surface);
//! assert!(truth.get(UVec2::splat(16)).is_some());
//!
//! let sky: &Sky = &|_| DVec3::ONE;
//! let world = World { surface: &*scene.surface, objects: &[], sky };
//! let picture = Tracer::truth(world, Optics::WATER).render(&camera, 1);
//! assert!((picture.get(UVec2::splat(16)) - DVec3::ONE).length() < 1e-9);
//! ```
//!
//! Conventions: metres; right-handed, y up; cameras look along −z; reverse device depth, 1 at
//! the near plane; images from the top left; points on screen in pixels, so that pixel (0, 0)
//! has its middle at (0.5, 0.5); normals point out of the liquid; colours are linear unless
//! they say otherwise.

mod boxes;
pub mod camera;
pub mod ellipsoids;
pub mod image;
mod layers;
pub mod medium;
pub mod mesh;
pub mod metrics;
pub mod random;
mod ray;
mod samples;
pub mod scene;
pub mod surface;
pub mod tracer;
pub mod yu_turk;

pub use camera::{Camera, Lens};
pub use image::Image;
pub use layers::{Hit, Span, layers};
pub use ray::{Ray, angle};
pub use samples::pixel_samples;
pub use surface::{Crossing, Nearest, Surface};
