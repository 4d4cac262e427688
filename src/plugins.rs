//! The plugin that draws fluids, and the group of all plugins with a part in the picture.

use bevy::{app::PluginGroupBuilder, prelude::*, render::RenderApp};

#[cfg(feature = "recordings")]
use crate::recording::RecordingPlugin;
#[cfg(feature = "salva")]
use crate::salva::SalvaPlugin;
use crate::{
    emitter,
    material::FluidMaterial,
    needs::{log_late_renderer, need_time},
    particles::{self, FluidParticles},
    rain::RainPlugin,
    render::{self, LayerBlending, PlanReports},
    schedule,
    settings::{FluidDebugView, ScreenSpaceFluid, check},
    shape::SurfaceKernel,
};

/// [`FluidPlugin`], [`RainPlugin`] and, with their features, `RecordingPlugin` and `SalvaPlugin`.
/// Each costs nothing until its components are used.
///
/// Tools are added by name: `FluidInspectorPlugin` and
/// [`FluidDiagnosticsPlugin`](crate::diagnostics::FluidDiagnosticsPlugin).
///
/// ```no_run
/// use bevy::prelude::*;
/// use bevy_fluid::prelude::*;
///
/// App::new().add_plugins((DefaultPlugins, FluidPlugins)).run();
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct FluidPlugins;

impl PluginGroup for FluidPlugins {
    fn build(self) -> PluginGroupBuilder {
        let group = PluginGroupBuilder::start::<Self>()
            .add(FluidPlugin::default())
            .add(RainPlugin::default());
        #[cfg(feature = "recordings")]
        let group = group.add(RecordingPlugin);
        #[cfg(feature = "salva")]
        let group = group.add(SalvaPlugin);
        group
    }
}

/// Shapes and draws particle fluids, and runs their emitters.
///
/// Without a renderer, as on a server with `MinimalPlugins`, it does all but draw. Add it after
/// `DefaultPlugins`, if you add those.
#[derive(Clone, Copy, Debug)]
pub struct FluidPlugin {
    /// How the depth layers are drawn; leave it at its default unless you test adapters.
    pub layer_blending: LayerBlending,
    /// Whether work that a material does not need is skipped (see [`render::plan`](crate::render::plan)): the search in
    /// a fluid of refractive index 1, everything behind an opaque fluid, the terms that a medium
    /// lacks. Default: true; leave it there unless you test that skipping changes nothing.
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
        schedule::order(app);
        app.add_plugins((
            particles::plugin,
            emitter::plugin,
            check::<FluidMaterial>,
            check::<SurfaceKernel>,
            check::<ScreenSpaceFluid>,
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
    }

    fn finish(&self, app: &mut App) {
        need_time(app, "FluidPlugin");
        let renderer = app.get_sub_app(RenderApp);
        if renderer.is_some_and(|it| !it.world().contains_resource::<PlanReports>()) {
            log_late_renderer("FluidPlugin", "draws nothing");
        }
    }
}
