//! None of our systems leaves it to chance whether it runs before or after another that it shares
//! data with, be it ours or Bevy's.

use std::collections::HashMap;

use bevy::{
    ecs::{intern::Interned, schedule::ScheduleLabel},
    prelude::*,
};
use bevy_fluid::{
    diagnostics::FluidDiagnosticsPlugin, inspector::FluidInspectorPlugin, prelude::*,
};
use fluid_stage::headless_app;

/// Pairs of systems that run in any order though they share data, with what they share; one of
/// each pair is ours.
fn ambiguities(world: &World) -> Vec<String> {
    let schedules = world.resource::<Schedules>();
    let mut found = Vec::new();
    for (label, schedule) in schedules.iter() {
        // It has not run yet.
        let Ok(systems) = schedule.systems() else {
            continue;
        };
        let names: HashMap<_, _> = systems
            .map(|(key, system)| (key, system.name().to_string()))
            .collect();
        for (a, b, shared) in schedule.graph().conflicting_systems().iter() {
            let (a, b) = (&names[a], &names[b]);
            if [a, b].iter().any(|name| name.starts_with("bevy_fluid")) {
                let shared = shared.iter().map(|&id| world.components().get_name(id));
                let shared: Vec<_> = shared.flatten().collect();
                found.push(format!("{label:?}: {a} and {b} share {shared:?}"));
            }
        }
    }
    found
}

fn app(configure: impl FnOnce(&mut App)) -> App {
    let mut app = headless_app(uvec2(64, 64), |app| {
        app.add_plugins((
            FluidPlugin::default(),
            RainPlugin::default(),
            SalvaPlugin,
            FluidDiagnosticsPlugin,
            FluidInspectorPlugin::default(),
        ));
        configure(app);
    })
    .unwrap();
    // Schedules are built when they first run, the inspector's for its camera.
    app.world_mut().spawn(Camera3d::default());
    for _ in 0..3 {
        app.update();
    }
    app
}

#[test]
fn the_order_of_every_system_is_said() {
    let app = app(|_| ());
    let ours = |label: Interned<dyn ScheduleLabel>| {
        let schedule = app.world().resource::<Schedules>().get(label).unwrap();
        let systems = schedule.systems().unwrap();
        let names = systems.map(|(_, system)| system.name().to_string());
        names.filter(|name| name.starts_with("bevy_fluid")).count()
    };
    // Names are there, and what is looked for can be found.
    assert!(ours(PreUpdate.intern()) > 0 && ours(PostUpdate.intern()) > 10);
    let found = ambiguities(app.world());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_system_without_an_order_is_found() {
    fn loose(_: Query<&mut FluidParticles>) {}
    let app = app(|app| {
        app.add_systems(PostUpdate, loose);
    });
    assert!(ambiguities(app.world()).len() > 3);
}
