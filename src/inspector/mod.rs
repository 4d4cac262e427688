//! A window with every setting of cameras and fluids, counts, times and debug views.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_fluid::{FluidInspectorPlugin, prelude::*};
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
//! F1 opens and closes it. All of it can be used from the keyboard: Tab and Shift+Tab go from
//! setting to setting, arrows move sliders, Space opens lists, typed digits replace a number.
//!
//! What is shown follows from reflection: names from the fields, explanations from their docs,
//! sliders from [`SettingRange`](crate::SettingRange). Any component or resource that derives
//! `Reflect` can join: see [`FluidInspector::show`]. The fields are drawn by a walker of its own, as
//! no release of `bevy-inspector-egui` goes with what is used here, Bevy 0.19 and `bevy_egui` 0.42:
//! 0.37 wants `bevy_egui` 0.40, and 0.38 Bevy 0.20. A closed window costs nothing: if the program
//! has no [`EguiPlugin`] of its own, egui itself rests.
//!
//! Let the camera keep still while the pointer is over the window with
//! `run_if(not(inspector_wants_pointer))` on the system that moves it.

mod context;
pub mod presets;
pub mod rust_code;
mod skipped;
mod times;
mod walker;
mod widgets;
mod window;

use std::any::TypeId;

use bevy::{prelude::*, reflect::GetTypeRegistration};
use bevy_egui::{EguiGlobalSettings, EguiPlugin, EguiPrimaryContextPass, input::EguiWantsInput};

pub use presets::{Presets, ReflectPresets};
pub use rust_code::{rust_code, spawn_code};

use crate::{
    FluidDiagnosticsPlugin, FluidMaterial, FluidParticles, ParticleCollider, ParticleEmitter, Rain,
    ScreenSpaceFluid, SurfaceKernel,
    rain::{RainShelter, RainStreaks},
};

/// Adds the inspector: see [`inspector`](crate::inspector). It brings what it needs and the program
/// has not: [`EguiPlugin`] and [`FluidDiagnosticsPlugin`]; add it after them.
#[derive(Clone, Copy, Debug)]
pub struct FluidInspectorPlugin {
    /// Opens and closes the window. Default: F1.
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

/// The state of the window, to be read and set by the program.
#[derive(Resource, Clone, Debug)]
pub struct FluidInspector {
    /// Whether the window is open.
    pub open: bool,
    /// Opens and closes it.
    pub key: KeyCode,
    /// The camera whose settings are shown; the first where it is none.
    pub camera: Option<Entity>,
    /// The fluid whose settings are shown; the first where it is none.
    pub fluid: Option<Entity>,
    /// What else is shown, such as a shelter.
    pub other: Option<Entity>,
    types: Vec<TypeId>,
}

impl FluidInspector {
    /// Shows components, or a resource, of type `T` as well. It has to be registered
    /// ([`App::register_type`]) with `#[reflect(Component)]` or `#[reflect(Resource)]`, and with
    /// `#[reflect(Default)]` if it is to be reset. Presets are [`ReflectPresets`].
    pub fn show<T: GetTypeRegistration + 'static>(&mut self) -> &mut Self {
        let id = TypeId::of::<T>();
        if !self.types.contains(&id) {
            self.types.push(id);
        }
        self
    }

    /// The types that are shown, in their order.
    pub fn types(&self) -> &[TypeId] {
        &self.types
    }
}

impl Plugin for FluidInspectorPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<EguiPlugin>() {
            app.add_plugins(EguiPlugin {
                // There is one texture, that of the letters.
                bindless_mode_array_size: None,
            });
            app.world_mut()
                .resource_mut::<EguiGlobalSettings>()
                .auto_create_primary_context = false;
            app.add_plugins(context::plugin);
        }
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
            .show::<RainStreaks>();
        #[cfg(feature = "recordings")]
        inspector
            .show::<crate::recording::RecordingPlayer>()
            .show::<crate::recording::RecordingWriter>();
        #[cfg(feature = "salva")]
        inspector
            .show::<crate::salva::SalvaFluid>()
            .show::<crate::salva::SalvaBoundary>()
            .show::<crate::salva::SalvaBody>()
            .show::<crate::salva::SalvaSettings>();
        app.insert_resource(inspector)
            .add_plugins(presets::plugin)
            .add_systems(Update, toggle)
            .add_systems(EguiPrimaryContextPass, window::show.run_if(is_open));
        #[cfg(feature = "salva")]
        app.add_plugins(presets::salva::plugin);
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

/// A run condition: the pointer is over the inspector or any other egui window, or drags a part of
/// it. The camera should not follow it then. False without egui.
pub fn inspector_wants_pointer(input: Option<Res<EguiWantsInput>>) -> bool {
    input.is_some_and(|input| input.wants_any_pointer_input())
}

/// A run condition: keys go to the inspector or any other egui window. False without egui.
pub fn inspector_wants_keyboard(input: Option<Res<EguiWantsInput>>) -> bool {
    input.is_some_and(|input| input.wants_any_keyboard_input())
}
