//! Particle liquids for Bevy, drawn in screen space with up to four refractions, and rain.
//!
//! A fluid is an entity with [`FluidParticles`] and a [`FluidMaterial`]; a camera with
//! [`ScreenSpaceFluid`] draws it. Everything else has defaults. The [`prelude`] has what most
//! programs name, and the modules have the rest.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_fluid::prelude::*;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, FluidPlugin::default()))
//!     .add_systems(Startup, |mut commands: Commands| {
//!         let drops = (0..100).map(|i| Vec3::X * 0.1 * i as f32).collect();
//!         commands.spawn((FluidParticles::new(drops, 0.05), FluidMaterial::WATER));
//!         commands.spawn((
//!             Camera3d::default(),
//!             ScreenSpaceFluid::default(),
//!             Transform::from_xyz(5.0, 2.0, 10.0).looking_at(Vec3::X * 5.0, Vec3::Y),
//!         ));
//!     })
//!     .run();
//! ```
//!
//! # From particles to picture
//!
//! 1. [`shape`], on the CPU, in [`FluidSystems::Shape`]: a neighbourhood search on a grid
//!    classifies each particle: few neighbours make it *spray*, many *bulk*, a full and balanced
//!    set *interior*, which is not drawn. The splat of a bulk particle is stretched along the
//!    surface by the covariance of its neighbours.
//! 2. [`render`], on the GPU, before Bevy's main pass: splats become four depth layers, front and
//!    back of bulk and of spray; the bulk layers are smoothed; normals come from the plane fit,
//!    from depth, or from the spray's ellipsoids; the ray of every pixel is traced through up to
//!    four interfaces.
//! 3. Between opaque and transparent objects, the result is composited over the scene: the light
//!    from the liquid itself, and the background that the refracted ray reaches.
//!
//! Work that a scene does not need is skipped: see [`render::plan`].
//!
//! [`FluidPlugin`] does all of this. [`FluidPlugins`] adds rain and, with their features, recordings
//! and live simulation.
//!
//! Settings out of range are logged once and clamped: see [`Settings`].
//!
//! # Where particles come from
//!
//! - Your own code writes them into [`FluidParticles`].
//! - A [`ParticleEmitter`] emits them: particles leave its nozzle, fly, bounce off every
//!   [`ParticleCollider`] and vanish, in [`FluidSystems::Emit`] and [`FluidSystems::Simulate`].
//!   They do not push each other.
//! - With the feature `recordings` and `RecordingPlugin`, a `RecordingPlayer` plays back numbered
//!   particle files, loaded in the background, and a `RecordingWriter` writes such files: see the
//!   module `recording`.
//! - With the feature `salva`, `SalvaPlugin` simulates them live, among boundaries and floating
//!   bodies: see the module `salva`.
//!
//! # Appearance
//!
//! A [`FluidMaterial`] is a refractive index and a [`Medium`]. The medium scatters, absorbs and
//! emits light, each with a density and a colour, from clear water to milk, smoke and fire. For
//! fluids without refraction, [`Thickness`] sets whether gaps between puffs count.
//! [`SurfaceKernel`], on the fluid, sets how particles merge into a surface; [`ScreenSpaceFluid`],
//! on the camera, sets smoothing, [`Refractions`], [`Search`] and [`Fresnel`], with presets from
//! `FAST` to `ACCURATE`.
//!
//! # Antialiasing, motion blur and depth of field
//!
//! The liquid's own edges are antialiased by the part of each pixel that it covers, and its inside where
//! neighbouring pixels differ: see [`Antialiasing`]. Bevy's ways of antialiasing all work with liquids as
//! well, and none is needed. `TemporalAntiAliasing` and `MotionBlur` read
//! motion vectors, which are made for cameras that have a
//! [`MotionVectorPrepass`](bevy::core_pipeline::prepass::MotionVectorPrepass), as both require. They
//! follow the camera, the fluid's transform, and each particle: by [`FluidParticles::ids`] from where
//! it was in the frame before, or else by [`FluidParticles::velocities`]. They take one more draw of
//! the splats, and 20 bytes a pixel. `DepthOfField`, decals and soft particles read the scene's
//! depth, which holds the liquid's front.
//!
//! # Rain
//!
//! [`RainPlugin`] draws [`Rain`] for the camera that has it: streaks of drops at terminal velocity,
//! lit by the scene's lights and blocked by [`RainShelter`](rain::RainShelter)s. It does not need
//! [`FluidPlugin`]; see [`rain`].
//!
//! # Floating origins and teleports
//!
//! [`WorldShift`] takes along all that is kept in the world's space when a program moves everything;
//! [`Teleport`] tells that an entity was put elsewhere and has not moved there: see [`relocation`].
//!
//! # Inspector and diagnostics
//!
//! With the feature `inspector`, `FluidInspectorPlugin` adds a window with every setting, the time
//! of each pass and the debug views: F1 opens it. Without it, [`FluidDebugView`] selects a debug
//! view.
//!
//! [`FluidDiagnosticsPlugin`] records counts and times in Bevy's `DiagnosticsStore`, where any
//! other tool can read them: see [`diagnostics`] for the paths.
//!
//! # Without a renderer
//!
//! On a server, with `MinimalPlugins` alone, all plugins run: emitters emit, liquids are simulated
//! and recorded, and fluids are shaped. Only players need more, Bevy's `AssetPlugin`. In a program
//! that draws, the plugins are added after `DefaultPlugins`.
//!
//! # Sources
//!
//! The depth layers, the plane fit and the order of refractions come from T. Imai's master's thesis
//! (University of Tsukuba, 2016), the kernels from Yu and Turk (2013, equations 9 to 11:
//! [`shape`]), the medium from an article on a simple volume model (its equation: [`Medium`]).
//! The feature `published` adds the smoothing filters of Truong and Yuksel (2018), of van der Laan,
//! Green and Sainz (2009) and of the thesis, to compare with. Rain follows Yoshida, Dobashi and Yamamoto,
//! with the drop sizes of Marshall and Palmer (1948) and the terminal velocities of Gunn and Kinzer
//! (1949): [`rain`]. Live simulation uses salva3d.
//!
//! `docs/stability.md` lists what is guaranteed for any input, what is not, and the limits of
//! 32-bit floats, with the fifty hard cases that are tested.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![warn(clippy::disallowed_methods)]

mod clock;
pub mod diagnostics;
#[cfg(all(test, feature = "published"))]
mod every_setting;
mod fog;
#[cfg(feature = "inspector")]
pub mod inspector;
pub mod material;
mod medium;
mod needs;
mod plugins;
pub mod rain;
mod random;
pub mod relocation;
pub mod render;
mod schedule;
pub mod settings;
pub mod shape;
mod source;
mod suns;

#[cfg(doc)]
use crate::prelude::*;
#[cfg(feature = "recordings")]
pub use crate::source::recording;
#[cfg(feature = "salva")]
pub use crate::source::salva;
pub use crate::{
    plugins::{FluidPlugin, FluidPlugins},
    schedule::FluidSystems,
    source::{emitter, particles, solid},
};

#[cfg(feature = "inspector")]
#[doc(hidden)]
pub use crate::inspector::FluidInspectorPlugin;
/// Where these names stood before the modules had them; they go in the next version.
#[doc(hidden)]
pub use crate::{
    diagnostics::FluidDiagnosticsPlugin,
    emitter::{EmittedParticles, EmitterBounds, ExternalMotion, ParticleCollider, ParticleEmitter},
    material::{FluidMaterial, Medium, Thickness},
    particles::{FluidParticles, ShapedFluid},
    rain::{Rain, RainPlugin},
    render::LayerBlending,
    settings::{
        Antialiasing, FluidDebugView, Fresnel, PlaneFit, PlaneFitForm, Refractions,
        ScreenSpaceFluid, Search, SettingRange, Smoothing, Window,
    },
    shape::SurfaceKernel,
};

/// What most programs name.
pub mod prelude {
    #[cfg(feature = "recordings")]
    pub use crate::recording::{FluidRecording, RecordingPlayer, RecordingPlugin, RecordingWriter};
    #[cfg(feature = "salva")]
    pub use crate::salva::{
        SalvaBody, SalvaBoundary, SalvaFluid, SalvaMode, SalvaPlugin, SalvaSettings, SalvaShape,
        SalvaStatus,
    };
    pub use crate::{
        FluidPlugin, FluidPlugins, FluidSystems,
        emitter::{ParticleCollider, ParticleEmitter},
        material::{FluidMaterial, Medium, Thickness},
        particles::{FluidParticles, ParticleSpace},
        rain::{Rain, RainPlugin},
        relocation::{Teleport, WorldShift},
        settings::{ScreenSpaceFluid, Settings},
        shape::SurfaceKernel,
    };
}

/// For this crate's own tests; it may change in any version.
#[doc(hidden)]
pub mod test_hooks {
    pub use crate::{rain::RainQuads, settings::Checked};
}

/// The code of README and docs, compiled as doc tests with the features it needs.
#[cfg(all(doctest, feature = "recordings", feature = "salva"))]
mod documents {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/live_simulation.md")]
    struct LiveSimulation;
    #[doc = include_str!("../docs/recordings.md")]
    struct Recordings;
}
