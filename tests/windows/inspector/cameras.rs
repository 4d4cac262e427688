//! The open inspector outlives cameras, windows and contexts, the program's own windows included.

use bevy::{camera::RenderTarget, window::WindowRef};
use bevy_egui::{
    EguiContexts, EguiManagedTextures, EguiPlugin, EguiPrimaryContextPass, EguiSchedule,
    input::WindowToEguiContextMap,
};

use super::*;

/// How often the program's own window has been shown.
#[derive(Resource, Default)]
struct Shown(u32);

/// A program without a camera so far, with egui windows of its own or without.
fn program(has_windows: bool) -> App {
    let mut app = headless_app(SIZE, |app| {
        if has_windows {
            app.add_plugins(EguiPlugin::default())
                .init_resource::<Shown>()
                .add_systems(
                    EguiPrimaryContextPass,
                    |mut contexts: EguiContexts, mut shown: ResMut<Shown>| -> Result {
                        // Beside the inspector.
                        let window = egui::Window::new("Score").fixed_size([60.0, 20.0]);
                        let window = window.fixed_pos([500.0, 100.0]);
                        window.show(contexts.ctx_mut()?, |ui| ui.label("0"));
                        shown.0 += 1;
                        Ok(())
                    },
                );
        }
        let inspector = FluidInspectorPlugin {
            open: true,
            ..default()
        };
        app.add_plugins((FluidPlugin::default(), inspector));
    })
    .unwrap();
    set_time_step(&mut app, Duration::from_millis(50));
    app
}

fn spawn_camera(app: &mut App, order: isize) -> Entity {
    let camera = Camera { order, ..default() };
    let bundle = (Camera3d::default(), camera, ScreenSpaceFluid::default());
    app.world_mut().spawn(bundle).id()
}

/// Shows a camera in a window.
fn spawn_camera_in(app: &mut App, window: Entity, order: isize) -> Entity {
    let camera = spawn_camera(app, order);
    let target = RenderTarget::Window(WindowRef::Entity(window));
    app.world_mut().entity_mut(camera).insert(target);
    camera
}

/// The cameras with a context in which the inspector's window is, now.
fn showing(app: &mut App) -> Vec<Entity> {
    let world = app.world_mut();
    let mut contexts = world.query::<(Entity, &mut EguiContext)>();
    for (_, mut context) in contexts.iter_mut(world) {
        context.get_mut().enable_accesskit();
    }
    step(app, 1);
    let world = app.world_mut();
    let mut outputs = world.query::<(Entity, &EguiOutput)>();
    let shows = |output: &EguiOutput| {
        let update = output.platform_output.accesskit_update.as_ref();
        update.is_some_and(|update| {
            let mut names = update.nodes.iter().map(|(_, node)| node.label());
            names.any(|name| name == Some("Fluid inspector"))
        })
    };
    let showing = outputs.iter(world).filter(|(_, output)| shows(output));
    showing.map(|(camera, _)| camera).collect()
}

fn primaries(app: &mut App) -> usize {
    let world = app.world_mut();
    let mut primary = world.query_filtered::<(), With<PrimaryEguiContext>>();
    primary.iter(world).count()
}

/// Whether the section of the times is.
fn is_folded(app: &mut App) -> bool {
    !widgets(app).iter().any(|widget| widget.name == "GPU")
}

#[test]
fn it_comes_back_with_another_camera() {
    for has_windows in [false, true] {
        let mut app = program(has_windows);
        let camera = spawn_camera(&mut app, 0);
        step(&mut app, 3);
        assert_eq!(showing(&mut app), [camera]);
        // A section is folded.
        listen(&mut app);
        assert!(!is_folded(&mut app));
        let times = find(&mut app, "Button", "Times").rect;
        click(&mut app, times.center());
        step(&mut app, 8);
        assert!(is_folded(&mut app));
        app.world_mut()
            .remove_resource::<FocusedNonWindowEguiContext>();
        let textures = |app: &App| app.world().resource::<EguiManagedTextures>().len();
        let held = textures(&app);
        for _ in 0..3 {
            let camera = context(&mut app);
            app.world_mut().despawn(camera);
            step(&mut app, 2);
            assert_eq!(showing(&mut app), []);
            let next = spawn_camera(&mut app, 0);
            step(&mut app, 2);
            assert_eq!(showing(&mut app), [next]);
            assert_eq!(primaries(&mut app), 1);
            assert!(is_folded(&mut app), "it has forgotten");
        }
        assert_eq!(textures(&app), held, "textures of cameras that have ended");
        if has_windows {
            // The program's windows have come back too, and stay without the inspector.
            let shown = app.world().resource::<Shown>().0;
            app.world_mut().resource_mut::<FluidInspector>().open = false;
            step(&mut app, 3);
            assert_eq!(app.world().resource::<Shown>().0, shown + 3);
        }
        assert_eq!(validation_errors(&app), [""; 0]);
    }
}

#[test]
fn it_goes_to_a_camera_that_is_drawn() {
    for has_windows in [false, true] {
        let mut app = program(has_windows);
        let [first, second] = [0, 1].map(|order| {
            let camera = spawn_camera(&mut app, order);
            step(&mut app, 2);
            camera
        });
        assert_eq!(showing(&mut app), [first]);
        let activate = |app: &mut App, camera, is_active| {
            let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
            camera.is_active = is_active;
            step(app, 3);
        };
        activate(&mut app, first, false);
        assert_eq!(showing(&mut app), [second]);
        // The program's own context stays where the program has it.
        let is_primary =
            |app: &App, camera| app.world().get::<PrimaryEguiContext>(camera).is_some();
        assert_eq!(is_primary(&app, first), has_windows);
        assert_eq!(is_primary(&app, second), !has_windows);
        activate(&mut app, first, true);
        let expected = if has_windows { first } else { second };
        assert_eq!(showing(&mut app), [expected]);
        let world = app.world_mut();
        let contexts = world.query::<&EguiContext>().iter(world).count();
        assert_eq!(contexts, 1);
    }
}

#[test]
fn the_program_may_give_its_context_to_any_camera() {
    let mut app = program(true);
    let first = spawn_camera(&mut app, 0);
    step(&mut app, 2);
    app.world_mut().despawn(first);
    let [given, chosen] = [1, 0].map(|order| spawn_camera(&mut app, order));
    step(&mut app, 2);
    assert_eq!(showing(&mut app), [given]);
    // The program's system would fail with two of them.
    app.world_mut()
        .entity_mut(chosen)
        .insert(PrimaryEguiContext);
    step(&mut app, 3);
    assert_eq!(primaries(&mut app), 1);
    assert_eq!(showing(&mut app), [chosen]);
}

/// A program that makes its contexts itself has made none, or one for another purpose.
#[test]
fn it_finds_a_camera_where_the_program_makes_contexts_itself() {
    #[derive(bevy::ecs::schedule::ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
    struct MapPass;

    let mut app = program(true);
    app.world_mut()
        .resource_mut::<bevy_egui::EguiGlobalSettings>()
        .auto_create_primary_context = false;
    app.init_schedule(MapPass);
    let map = spawn_camera(&mut app, 1);
    app.world_mut()
        .entity_mut(map)
        .insert(EguiSchedule::new(MapPass));
    step(&mut app, 2);
    assert_eq!(showing(&mut app), []);
    let eye = spawn_camera(&mut app, 0);
    step(&mut app, 2);
    assert_eq!(showing(&mut app), [eye]);
}

#[test]
fn it_goes_to_the_window_that_is_left_and_follows_its_camera() {
    for has_windows in [false, true] {
        let mut app = program(has_windows);
        let windows = [(); 2].map(|()| app.world_mut().spawn(Window::default()).id());
        let first = spawn_camera_in(&mut app, windows[0], 1);
        step(&mut app, 1);
        let second = spawn_camera_in(&mut app, windows[1], 0);
        step(&mut app, 3);
        assert_eq!(showing(&mut app), [first]);
        // The window where a context's events come from.
        let window = |app: &App, context| {
            let map = app.world().resource::<WindowToEguiContextMap>();
            let window = map.context_to_window.get(&context).copied();
            for (other, contexts) in &map.window_to_contexts {
                assert_eq!(contexts.contains(&context), Some(*other) == window);
            }
            window
        };
        assert_eq!(window(&app, first), Some(windows[0]));
        app.world_mut().despawn(windows[0]);
        step(&mut app, 3);
        assert_eq!(showing(&mut app), [second]);
        assert_eq!(window(&app, second), Some(windows[1]));
        // Its camera moves to another window, or to none.
        let third = app.world_mut().spawn(Window::default()).id();
        let target = RenderTarget::Window(WindowRef::Entity(third));
        app.world_mut().entity_mut(second).insert(target);
        step(&mut app, 2);
        assert_eq!(showing(&mut app), [second]);
        assert_eq!(window(&app, second), Some(third));
        app.world_mut().despawn(third);
        step(&mut app, 2);
        let fourth = app.world_mut().spawn(Window::default()).id();
        let target = RenderTarget::Window(WindowRef::Entity(fourth));
        app.world_mut().entity_mut(second).insert(target);
        step(&mut app, 3);
        assert_eq!(showing(&mut app), [second]);
        assert_eq!(window(&app, second), Some(fourth));
    }
}
