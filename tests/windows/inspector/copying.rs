//! Settings copied as Rust code.

use super::*;

/// What a button puts into the clipboard.
#[track_caller]
fn copied(app: &mut App, button: &str) -> String {
    let rect = in_sight(app, "Button", button);
    send(app, [Event::PointerMoved(rect.center())]);
    let mut copied = Vec::new();
    for pressed in [true, false] {
        let event = Event::PointerButton {
            pos: rect.center(),
            button: PointerButton::Primary,
            pressed,
            modifiers: default(),
        };
        send(app, [event]);
        let context = context(app);
        let output = app.world().get::<EguiOutput>(context).unwrap();
        copied.extend(output.platform_output.commands.clone());
    }
    match &copied[..] {
        [OutputCommand::CopyText(text)] => text.clone(),
        _ => panic!("{copied:?}"),
    }
}

#[test]
fn settings_are_copied_as_code() {
    let mut app = opened();
    let mut cameras = app.world_mut().query::<&mut ScreenSpaceFluid>();
    *cameras.single_mut(app.world_mut()).unwrap() = ScreenSpaceFluid::FAST;
    let settings = "ScreenSpaceFluid {\n    refractions: Refractions::One,\n    \
        antialiasing: Antialiasing::Edges,\n    ..default()\n}";
    assert_eq!(copied(&mut app, "Copy as Rust"), settings);

    let camera = copied(&mut app, "copy camera");
    assert!(
        camera.starts_with("commands.spawn((\n    Name::new(\"eye\"),\n"),
        "{camera}"
    );
    assert!(camera.contains("\n    Camera3d::default(),\n"), "{camera}");
    assert!(
        camera.contains(&settings.replace('\n', "\n    ")),
        "{camera}"
    );
    let fluid = copied(&mut app, "copy fluid");
    let [name, kernel] = ["Name::new(\"pond\")", "SurfaceKernel::default()"];
    assert!(fluid.contains(name) && fluid.contains(kernel), "{fluid}");
    let resources = "commands.insert_resource(TeleportSettings::default());\n\
        commands.insert_resource(Weather {\n    wet: true,\n});";
    assert_eq!(
        copied(&mut app, "Copy all as Rust"),
        format!("{camera}\n{fluid}\n{resources}")
    );
}

#[test]
fn emitters_have_presets() {
    use bevy_fluid::inspector::ReflectPresets;

    let mut app = opened();
    let world = app.world_mut();
    world.spawn((Name::new("tap"), ParticleEmitter::DRIP));
    let types = world.resource::<AppTypeRegistry>().clone();
    let types = types.read();
    let presets = ReflectPresets::of(&ParticleEmitter::SPRAY, &types).unwrap();
    assert_eq!(presets.name_of(&ParticleEmitter::SPRAY), Some("SPRAY"));
    let names: Vec<_> = presets.values().into_iter().map(|(name, _)| name).collect();
    let expected = ["DEFAULT", "JET", "FOUNTAIN", "SHOWER", "SPRAY", "DRIP"];
    assert_eq!(names, expected);
    drop(types);
    step(&mut app, 20);
    let store = app.world().resource::<DiagnosticsStore>();
    let emitted = store.get(&diagnostics::EMITTED).and_then(Diagnostic::value);
    // Two a second.
    assert!(emitted.is_some_and(|count| count >= 1.0), "{emitted:?}");
}

#[test]
fn rain_has_its_times_where_it_falls() {
    let mut app = open(show_with(|app| {
        app.add_plugins(RainPlugin {
            synchronous_bake: true,
        });
    }));
    let is_listed = |app: &mut App| {
        let mut all = widgets(app).into_iter();
        all.any(|it| it.name == "■ rain: scene depth")
    };
    step(&mut app, 10);
    assert!(!is_listed(&mut app));
    let mut cameras = app.world_mut().query_filtered::<Entity, With<Camera3d>>();
    let camera = cameras.single(app.world()).unwrap();
    app.world_mut().entity_mut(camera).insert(Rain::HEAVY);
    step(&mut app, 20);
    assert!(is_listed(&mut app));
    let store = app.world().resource::<DiagnosticsStore>();
    for pass in diagnostics::RAIN_PASSES {
        let time = store.get(&diagnostics::cpu_time(pass));
        assert!(time.and_then(Diagnostic::value).is_some(), "{pass}");
    }
}

#[test]
fn counts_and_times_are_in_bevys_store() {
    let mut app = opened();
    step(&mut app, 5);
    let particles = ball(0.4, 0.05).len() as f64;
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path| store.get(&path).and_then(Diagnostic::value);
    assert_eq!(value(diagnostics::PARTICLES), Some(particles));
    let classes = [diagnostics::BULK, diagnostics::INTERIOR, diagnostics::SPRAY];
    let sum: f64 = classes.into_iter().filter_map(value).sum();
    assert_eq!(sum, particles);
    assert_eq!(value(diagnostics::DROPPED), Some(0.0));
    assert_eq!(value(diagnostics::SHAPE_TOTAL), Some(0.0), "nothing moves");
    for pass in diagnostics::PASSES {
        for path in [diagnostics::gpu_time(pass), diagnostics::cpu_time(pass)] {
            let time = store.get(&path).and_then(Diagnostic::value);
            assert!(time.is_some_and(|time| time >= 0.0), "{path}: {time:?}");
        }
    }
}
