//! Plugins in an order that Bevy does not allow for: one sentence each names what belongs before.

use bevy::{
    app::TerminalCtrlCHandlerPlugin, log::LogPlugin, prelude::*, window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_fluid::{emitter::EmittedParticles, inspector::FluidInspectorPlugin, prelude::*};
use fluid_stage::log;

#[test]
fn plugins_before_the_renderer_name_it_and_do_the_rest() {
    log::listen();
    let mut app = App::new();
    app.add_plugins((
        FluidPlugins,
        // It adds `FluidDiagnosticsPlugin`.
        FluidInspectorPlugin {
            open: true,
            ..default()
        },
    ))
    .add_plugins(
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .disable::<LogPlugin>()
            .disable::<WinitPlugin>()
            .disable::<TerminalCtrlCHandlerPlugin>(),
    );
    while app.plugins_state() == bevy::app::PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    for (plugin, effect) in [
        ("FluidPlugin", "draws nothing"),
        ("RainPlugin", "draws nothing"),
        ("FluidInspectorPlugin", "shows nothing"),
        ("FluidDiagnosticsPlugin", "measures no pass"),
    ] {
        let said = format!("`{plugin}` was added before `RenderPlugin` and {effect}");
        assert_eq!(log::count(&said), 1, "{said}");
    }
    let world = app.world_mut();
    world.spawn((Camera3d::default(), ScreenSpaceFluid::default(), Rain::RAIN));
    let hose = world.spawn(ParticleEmitter::JET).id();
    for _ in 0..5 {
        std::thread::sleep(core::time::Duration::from_millis(5));
        app.update();
    }
    assert!(
        !app.world()
            .get::<EmittedParticles>(hose)
            .unwrap()
            .is_empty()
    );
}
