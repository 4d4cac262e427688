//! A window with every setting of cameras and fluids, counts, times and debug views.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_fluid::{inspector::FluidInspectorPlugin, prelude::*};
//!
//! App::new()
//!     .add_plugins((
//!         DefaultPlugins,
//!         FluidPlugin::default(),
//!         // After `EguiPlugin`, if the program has windows of its own.
//!         FluidInspectorPlugin::default(),
//!     ))
//!     .run();
//! ```
//!
//! F1 opens and closes it. It works from the keyboard alone: Tab and Shift+Tab go from setting to
//! setting, arrows move sliders, Space opens lists, typed digits replace a number.
//!
//! Its content comes from reflection: names from the fields, explanations from their docs, sliders
//! from [`SettingRange`](crate::settings::SettingRange). Any component or resource that derives `Reflect` can
//! be added: see [`FluidInspector::show`]. The inspector draws the fields itself, as no release of
//! `bevy-inspector-egui` works with both Bevy 0.19 and `bevy_egui` 0.42: 0.37 needs `bevy_egui`
//! 0.40, and 0.38 Bevy 0.20. A closed window costs nothing: if the program has no [`EguiPlugin`] of
//! its own, egui does not run either.
//!
//! The window is part of the primary egui context. If its camera has ended, is inactive or has lost
//! its target, another camera is given a context while the window is open: the primary one if there
//! is none, with which the program's own windows come back. The program may give it to any camera at
//! any time. The contents and places of windows remain.
//!
//! To keep the camera still while the pointer is over the window, add
//! `run_if(not(inspector_wants_pointer))` to the system that moves it.

mod context;
pub mod presets;
pub mod rust_code;
mod skipped;
mod times;
mod walker;
mod widgets;
mod window;

use std::any::TypeId;

use bevy::{
    prelude::*,
    reflect::GetTypeRegistration,
    render::{GpuResourceAppExt, RenderApp, render_resource::SpecializedRenderPipelines},
};
use bevy_egui::{
    EguiGlobalSettings, EguiPlugin, EguiPostUpdateSet, EguiPrimaryContextPass,
    input::EguiWantsInput,
    render::{
        EguiPipeline,
        systems::{EguiRenderData, EguiTransforms},
    },
};

pub use presets::{Presets, ReflectPresets};
pub use rust_code::{rust_code, spawn_code};

use self::context::{InspectorContext, InspectorPass};
use crate::{
    FluidSystems,
    diagnostics::FluidDiagnosticsPlugin,
    emitter::{ParticleCollider, ParticleEmitter},
    material::FluidMaterial,
    needs::log_late_renderer,
    particles::FluidParticles,
    rain::{Rain, RainShelter, RainStreakSettings},
    relocation::TeleportSettings,
    schedule,
    settings::ScreenSpaceFluid,
    shape::SurfaceKernel,
};

/// Adds the inspector: see [`inspector`](crate::inspector). It adds [`EguiPlugin`] and
/// [`FluidDiagnosticsPlugin`] if they are missing; otherwise add it after them. Without a renderer
/// nothing is shown.
#[derive(Clone, Copy, Debug)]
pub struct FluidInspectorPlugin {
    /// The key that opens and closes the window. Default: F1.
    pub key: KeyCode,
    /// Whether the window is open at the start. Default: false.
    pub open: bool,
}

impl Default for FluidInspectorPlugin {
    fn default() -> Self {
        Self {
            key: KeyCode::F1,
            open: false,
        }
    }
}

/// The state of the window, which the program may read and set.
#[derive(Resource, Clone, Debug)]
pub struct FluidInspector {
    /// Whether the window is open.
    pub open: bool,
    /// The key that opens and closes it.
    pub key: KeyCode,
    /// The camera whose settings are shown; the first if `None`.
    pub camera: Option<Entity>,
    /// The fluid whose settings are shown; the first if `None`.
    pub fluid: Option<Entity>,
    /// Another entity whose settings are shown, such as a shelter; the first if `None`.
    pub other: Option<Entity>,
    types: Vec<TypeId>,
}

impl FluidInspector {
    /// Also shows components, or a resource, of type `T`. The type must be registered
    /// ([`App::register_type`]) with `#[reflect(Component)]` or `#[reflect(Resource)]`, and with
    /// `#[reflect(Default)]` to allow a reset. Presets come from [`ReflectPresets`].
    pub fn show<T: GetTypeRegistration + 'static>(&mut self) -> &mut Self {
        let id = TypeId::of::<T>();
        if !self.types.contains(&id) {
            self.types.push(id);
        }
        self
    }

    /// The types shown, in order.
    pub fn types(&self) -> &[TypeId] {
        &self.types
    }
}

impl Plugin for FluidInspectorPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<FluidDiagnosticsPlugin>() {
            app.add_plugins(FluidDiagnosticsPlugin);
        }
        let mut inspector = FluidInspector {
            open: self.open,
            key: self.key,
            camera: None,
            fluid: None,
            other: None,
            types: Vec::new(),
        };
        inspector
            .show::<ScreenSpaceFluid>()
            .show::<Rain>()
            .show::<FluidMaterial>()
            .show::<SurfaceKernel>()
            .show::<FluidParticles>()
            .show::<ParticleEmitter>()
            .show::<ParticleCollider>()
            .show::<RainShelter>()
            .show::<RainStreakSettings>()
            .show::<TeleportSettings>();
        #[cfg(feature = "recordings")]
        inspector
            .show::<crate::source::recording::RecordingPlayer>()
            .show::<crate::source::recording::RecordingWriter>();
        #[cfg(feature = "salva")]
        inspector
            .show::<crate::source::salva::SalvaFluid>()
            .show::<crate::source::salva::SalvaBoundary>()
            .show::<crate::source::salva::SalvaBody>()
            .show::<crate::source::salva::SalvaSettings>();
        app.insert_resource(inspector)
            .add_plugins((presets::plugin, presets::views::plugin));
        #[cfg(feature = "salva")]
        app.add_plugins(presets::salva::plugin);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            // Nobody would see it.
            return;
        };
        // bevy_egui makes these once, but what they hold belongs to a device, which may be lost.
        render_app
            .init_gpu_resource::<EguiPipeline>()
            .init_gpu_resource::<SpecializedRenderPipelines<EguiPipeline>>()
            .init_gpu_resource::<EguiTransforms>()
            .init_gpu_resource::<EguiRenderData>();
        let is_shared = app.is_plugin_added::<EguiPlugin>();
        if !is_shared {
            app.add_plugins(EguiPlugin {
                // There is one texture, that of the letters.
                bindless_mode_array_size: None,
            });
            app.world_mut()
                .resource_mut::<EguiGlobalSettings>()
                .auto_create_primary_context = false;
        }
        context::plugin(app, is_shared);
        app.add_systems(Update, toggle)
            .add_systems(
                EguiPrimaryContextPass,
                window::show.run_if(is_open).run_if(context::is_primary),
            )
            .add_systems(InspectorPass, window::show.run_if(is_open))
            // What is set in the window takes effect in the same frame.
            .configure_sets(
                PostUpdate,
                EguiPostUpdateSet::EndPass.before(FluidSystems::Check),
            );
        schedule::order(app);
    }

    fn finish(&self, app: &mut App) {
        let is_shown = app.world().contains_resource::<InspectorContext>();
        if app.get_sub_app(RenderApp).is_some() && !is_shown {
            log_late_renderer("FluidInspectorPlugin", "shows nothing");
        }
    }
}

fn is_open(inspector: Res<FluidInspector>) -> bool {
    inspector.open
}

fn toggle(mut inspector: ResMut<FluidInspector>, keys: Res<ButtonInput<KeyCode>>) {
    if keys.just_pressed(inspector.key) {
        inspector.open = !inspector.open;
    }
}

/// A run condition: whether the pointer is over the inspector or any other egui window, or drags a
/// part of it. The camera should not follow it then. False without egui.
pub fn inspector_wants_pointer(input: Option<Res<EguiWantsInput>>) -> bool {
    input.is_some_and(|input| input.wants_any_pointer_input())
}

/// A run condition: whether keys go to the inspector or any other egui window. False without egui.
pub fn inspector_wants_keyboard(input: Option<Res<EguiWantsInput>>) -> bool {
    input.is_some_and(|input| input.wants_any_keyboard_input())
}
