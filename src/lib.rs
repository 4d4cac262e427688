//! Particle liquids for Bevy, with up to four refractions in screen space; and rain.
//!
//! A fluid is an entity with [`FluidParticles`] and a [`FluidMaterial`]; a camera with
//! [`ScreenSpaceFluid`] draws it. Everything else has defaults.
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
//! 1. [`shape`], on the CPU, in [`FluidSystems::Shape`]: a grid finds each particle's neighbours;
//!    few make it *spray*, many *bulk*, a full and balanced set *interior*, which is not drawn. The
//!    neighbours' covariance stretches the splat of a bulk particle along the surface.
//! 2. [`render`], on the GPU, ahead of Bevy's main pass: splats become four depth layers, front and
//!    back of bulk and of spray; the bulk's are smoothed; normals follow from the fit, from depth,
//!    or from the spray's ellipsoids; every pixel's ray is traced through up to four interfaces.
//! 3. Between opaque and transparent things, the result is put over the scene: what the liquid
//!    itself sends, and the background where the ray has gone.
//!
//! Only what a scene has is done: see [`render::plan`].
//!
//! # Where particles come from
//!
//! - Your own code writes them into [`FluidParticles`].
//! - A [`ParticleEmitter`] does so: particles come out of its nozzle, fly, bounce off every
//!   [`ParticleCollider`] and vanish, in [`FluidSystems::Emit`] and [`FluidSystems::Simulate`]. They
//!   do not push each other.
//! - With the feature `recordings`, a `RecordingPlayer` plays numbered particle files into them, loaded
//!   in the background, and a `RecordingWriter` writes such files: see the module `recording`.
//! - With the feature `salva`, `SalvaPlugin` simulates them live, among boundaries and floating bodies:
//!   see the module `salva`.
//!
//! # What they look like
//!
//! A [`FluidMaterial`] is a refractive index and a [`Medium`]: what is inside scatters light, absorbs
//! it and shines, each by a density and a colour, from clear water to milk, smoke and fire. Where
//! nothing is refracted, [`Thickness`] says whether gaps between puffs count. [`SurfaceKernel`], on the
//! fluid, sets how particles grow together; [`ScreenSpaceFluid`], on the camera, sets smoothing,
//! [`Refractions`], [`Search`] and [`Fresnel`], with presets from `FAST` to `ACCURATE`.
//!
//! # Rain
//!
//! [`RainPlugin`] draws [`Rain`] for the camera that has it: streaks of falling drops, lit by the
//! scene's lights, kept off by [`RainShelter`](rain::RainShelter)s. It needs nothing of [`FluidPlugin`];
//! see [`rain`].
//!
//! # Looking inside
//!
//! With the feature `inspector`, `FluidInspectorPlugin` adds a window with every setting, the passes'
//! times and the debug views: F1 opens it. [`FluidDebugView`] chooses a debug view without it.
//!
//! [`FluidDiagnosticsPlugin`] keeps counts and times in Bevy's `DiagnosticsStore`, where any other tool
//! finds them: see [`diagnostics`] for the paths.
//!
//! # Where it comes from
//!
//! The layers, the planes and the order of refractions are those of T. Imai's master's thesis
//! (University of Tsukuba, 2016), the kernels Yu and Turk's (2013, equations 9 to 11: [`shape`]), the
//! medium that of an article on a simple volume model (its equation: [`Medium`]). Other ways of
//! smoothing are Truong and Yuksel's (2018, [`NarrowRange`]) and van der Laan, Green and Sainz's (2009,
//! [`CurvatureFlow`]). Rain follows Yoshida, Dobashi and Yamamoto, with the drops of Marshall and Palmer
//! (1948) and the speeds of Gunn and Kinzer (1949): [`rain`]. Live simulation is salva3d's.
//!
//! What holds for any input, what does not, and where 32-bit floats end, is in `docs/stability.md`,
//! with the fifty hard cases that are tested.

#![cfg_attr(docsrs, feature(doc_cfg))]

mod complaints;
pub mod diagnostics;
mod emitter;
#[cfg(feature = "inspector")]
pub mod inspector;
mod limits;
mod material;
mod medium;
mod particles;
pub mod rain;
mod random;
mod range;
#[cfg(feature = "recordings")]
pub mod recording;
pub mod render;
#[cfg(feature = "salva")]
pub mod salva;
mod schedule;
mod settings;
pub mod shape;

use bevy::prelude::*;

#[cfg(feature = "inspector")]
pub use crate::inspector::FluidInspectorPlugin;
pub use crate::{
    diagnostics::FluidDiagnosticsPlugin,
    emitter::{
        ColliderShape, EmittedParticles, EmitterBounds, EmitterError, ExternalMotion,
        ParticleCollider, ParticleEmitter,
    },
    material::{FluidMaterial, MaterialError, Thickness},
    medium::{Medium, MediumError},
    particles::{FluidParticles, ShapedFluid},
    rain::{Rain, RainPlugin},
    range::SettingRange,
    render::LayerBlending,
    schedule::FluidSystems,
    settings::{
        Bilateral, CurvatureFlow, FluidDebugView, Fresnel, NarrowRange, NormalAverage, PlaneFit,
        PlaneFitForm, Refractions, ScreenSpaceFluid, Search, Smoothing, Window,
    },
    shape::SurfaceKernel,
};

/// What most programs need.
pub mod prelude {
    #[cfg(feature = "salva")]
    pub use crate::salva::{
        SalvaBody, SalvaBoundary, SalvaFluid, SalvaMode, SalvaPlugin, SalvaSettings, SalvaShape,
        SalvaStatus,
    };
    pub use crate::{
        FluidMaterial, FluidParticles, FluidPlugin, FluidSystems, Medium, ParticleCollider,
        ParticleEmitter, Rain, RainPlugin, ScreenSpaceFluid, SurfaceKernel, Thickness,
    };
}

/// Shapes and draws particle fluids.
#[derive(Clone, Copy, Debug)]
pub struct FluidPlugin {
    /// How the depth layers are drawn; leave it at its default unless you test adapters.
    pub layer_blending: LayerBlending,
    /// Whether work is left out that a material makes needless (see [`render::plan`]): the
    /// search in a fluid of refractive index 1, what is behind an opaque one, the terms that a
    /// medium lacks. Default: true; leave it there unless you test that nothing is missed.
    pub shortcuts: bool,
}

impl Default for FluidPlugin {
    fn default() -> Self {
        Self {
            layer_blending: LayerBlending::Auto,
            shortcuts: true,
        }
    }
}

impl Plugin for FluidPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            schedule::plugin,
            particles::plugin,
            emitter::plugin,
            material::plugin,
            render::FluidRenderPlugin {
                layer_blending: self.layer_blending,
                shortcuts: self.shortcuts,
            },
        ))
        .register_type::<FluidParticles>()
        .register_type::<FluidMaterial>()
        .register_type::<SurfaceKernel>()
        .register_type::<ScreenSpaceFluid>()
        .register_type::<FluidDebugView>();
        #[cfg(feature = "recordings")]
        app.add_plugins(recording::RecordingPlugin);
    }
}

/// The README's code is compiled with the doc tests, where the features are there that it shows.
#[cfg(all(doctest, feature = "recordings", feature = "salva"))]
#[doc = include_str!("../README.md")]
struct Readme;
