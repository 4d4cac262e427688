//! The inspector, driven without a window: egui gets the events, and its tree for screen readers
//! tells where its widgets are.

mod cameras;
mod copying;
mod live;

use bevy::{
    diagnostic::{Diagnostic, DiagnosticsStore},
    input::{
        ButtonState,
        keyboard::{Key, KeyboardInput},
    },
    prelude::*,
};
use bevy_egui::{
    EguiContext, EguiOutput, PrimaryEguiContext,
    egui::{self, Event, OutputCommand, PointerButton, accesskit, pos2},
    input::{EguiInputEvent, FocusedNonWindowEguiContext},
};
use bevy_fluid::{
    diagnostics,
    inspector::{FluidInspector, FluidInspectorPlugin, inspector_wants_pointer},
    prelude::*,
    settings::{FluidDebugView, Refractions, Smoothing},
};
use core::time::Duration;
use fluid_stage::{ball, capture, headless_app, set_time_step, settle, step, validation_errors};

const SIZE: UVec2 = uvec2(640, 480);

/// A resource that has joined.
#[derive(Resource, Clone, PartialEq, Reflect)]
#[reflect(Resource)]
struct Weather {
    wet: bool,
}

/// How often the system that stands for the camera's controls has run.
#[derive(Resource, Default)]
struct CameraMoves(u32);

fn show() -> App {
    show_with(|_| ())
}

fn show_with(more: impl FnOnce(&mut App)) -> App {
    let mut app = headless_app(SIZE, |app| {
        more(app);
        app.add_plugins(FluidPlugin::default())
            .add_plugins((RecordingPlugin, FluidInspectorPlugin::default()))
            .init_resource::<CameraMoves>()
            .add_systems(
                Update,
                (|mut moves: ResMut<CameraMoves>| moves.0 += 1)
                    .run_if(not(inspector_wants_pointer)),
            );
        app.register_type::<Weather>()
            .insert_resource(Weather { wet: true });
        let world = app.world_mut();
        world.resource_mut::<FluidInspector>().show::<Weather>();
        world.spawn((
            Name::new("pond"),
            FluidParticles::new(ball(0.4, 0.05), 0.05),
            FluidMaterial::INK,
            Transform::from_xyz(1.0, 0.0, 0.0),
        ));
        world.spawn((
            Name::new("eye"),
            Camera3d::default(),
            ScreenSpaceFluid::default(),
            Transform::from_xyz(0.3, 0.3, 3.0).looking_at(vec3(0.3, 0.0, 0.0), Vec3::Y),
        ));
    })
    .unwrap();
    settle(&mut app).unwrap();
    // Windows fade in and lists scroll smoothly.
    set_time_step(&mut app, Duration::from_millis(50));
    app
}

fn opened() -> App {
    open(show())
}

fn open(mut app: App) -> App {
    app.world_mut().resource_mut::<FluidInspector>().open = true;
    step(&mut app, 2);
    listen(&mut app);
    app
}

/// Has egui describe its widgets, and take keys.
fn listen(app: &mut App) {
    let context = context(app);
    app.insert_resource(FocusedNonWindowEguiContext(context));
    let mut entity = app.world_mut().entity_mut(context);
    let egui = entity.get_mut::<EguiContext>().unwrap().into_inner();
    egui.get_mut().enable_accesskit();
    // Sections open and close at once.
    egui.get_mut()
        .all_styles_mut(|style| style.animation_time = 0.0);
    step(app, 3);
}

fn context(app: &mut App) -> Entity {
    let mut contexts = app
        .world_mut()
        .query_filtered::<Entity, With<PrimaryEguiContext>>();
    contexts.single(app.world()).unwrap()
}

fn send(app: &mut App, events: impl IntoIterator<Item = Event>) {
    let context = context(app);
    for event in events {
        app.world_mut()
            .write_message(EguiInputEvent { context, event });
    }
    step(app, 1);
}

fn press(app: &mut App, key: egui::Key) {
    for pressed in [true, false] {
        send(
            app,
            [Event::Key {
                key,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers: default(),
            }],
        );
    }
}

fn click(app: &mut App, at: egui::Pos2) {
    drag(app, at, at);
}

fn drag(app: &mut App, from: egui::Pos2, to: egui::Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: default(),
    };
    send(app, [Event::PointerMoved(from)]);
    send(app, [button(from, true)]);
    if from != to {
        send(app, [Event::PointerMoved(to)]);
    }
    send(app, [button(to, false)]);
    step(app, 2);
}

/// A widget as a screen reader knows it.
struct Widget {
    id: accesskit::NodeId,
    role: String,
    /// Its own text, or that of the label in its row.
    name: String,
    rect: egui::Rect,
}

fn widgets(app: &mut App) -> Vec<Widget> {
    let context = context(app);
    let output = app.world().get::<EguiOutput>(context).unwrap();
    let update = output.platform_output.accesskit_update.as_ref().unwrap();
    let text = |node: &accesskit::Node| {
        let text = node.label().or(node.value());
        text.unwrap_or_default().to_owned()
    };
    update
        .nodes
        .iter()
        .map(|(id, node)| {
            let label = node.labelled_by().first().and_then(|label| {
                let mut nodes = update.nodes.iter();
                nodes.find(|(id, _)| id == label).map(|(_, node)| node)
            });
            let rect = node.bounds().map_or(egui::Rect::NOTHING, |it| {
                egui::Rect::from_min_max(
                    pos2(it.x0 as f32, it.y0 as f32),
                    pos2(it.x1 as f32, it.y1 as f32),
                )
            });
            Widget {
                id: *id,
                role: format!("{:?}", node.role()),
                name: label.map_or_else(|| text(node), text),
                rect,
            }
        })
        .collect()
}

#[track_caller]
fn find(app: &mut App, role: &str, name: &str) -> Widget {
    let mut widgets = widgets(app);
    // Of several the topmost.
    widgets.sort_by(|a, b| a.rect.top().total_cmp(&b.rect.top()));
    let found = widgets
        .iter()
        .position(|it| it.role == role && it.name == name);
    let Some(found) = found else {
        let all: Vec<_> = widgets.iter().map(|it| (&it.role, &it.name)).collect();
        panic!("no {role} {name:?} among {all:?}");
    };
    widgets.into_iter().nth(found).unwrap()
}

/// Scrolls until a widget is in sight, and gives its rectangle.
#[track_caller]
fn in_sight(app: &mut App, role: &str, name: &str) -> egui::Rect {
    let middle = pos2(150.0, 240.0);
    let mut rect = egui::Rect::NOTHING;
    for _ in 0..60 {
        rect = find(app, role, name).rect;
        // Within the window, which ends 52 points above the picture's edge.
        if rect.top() > 60.0 && rect.bottom() < 428.0 {
            return rect;
        }
        send(
            app,
            [
                Event::PointerMoved(middle),
                Event::MouseWheel {
                    unit: egui::MouseWheelUnit::Point,
                    delta: egui::vec2(0.0, (middle.y - rect.center().y).clamp(-360.0, 360.0)),
                    phase: egui::TouchPhase::Move,
                    modifiers: default(),
                },
            ],
        );
        step(app, 8);
    }
    panic!("{role} {name:?} does not come into sight: {rect}");
}

/// Chooses an entry of a list.
#[track_caller]
fn choose(app: &mut App, list: &str, entry: &str) {
    let rect = in_sight(app, "ComboBox", list);
    click(app, rect.center());
    let rect = find(app, "Button", entry).rect;
    click(app, rect.center());
}

fn only<T: Component + Clone>(app: &mut App) -> T {
    app.world_mut()
        .query::<&T>()
        .single(app.world())
        .unwrap()
        .clone()
}

/// The picture beside the window, where the fluid is.
fn beside(app: &mut App) -> image::RgbaImage {
    settle(app).unwrap();
    let mut picture = capture(app).unwrap();
    image::imageops::crop(&mut picture, 400, 0, 240, 480).to_image()
}

fn focused(app: &mut App) -> Option<accesskit::NodeId> {
    let context = context(app);
    let output = app.world().get::<EguiOutput>(context).unwrap();
    let update = output.platform_output.accesskit_update.as_ref()?;
    Some(update.focus)
}

/// Goes on with Tab until a widget has the focus.
#[track_caller]
fn focus(app: &mut App, role: &str, name: &str) {
    for _ in 0..100 {
        press(app, egui::Key::Tab);
        let wanted = find(app, role, name).id;
        if focused(app) == Some(wanted) {
            return;
        }
    }
    panic!("{role} {name:?} does not get the focus");
}

#[test]
fn a_key_opens_and_closes_it_and_a_closed_window_leaves_no_trace() {
    let mut app = show();
    let plain = capture(&mut app).unwrap();
    let contexts = |app: &mut App| {
        let world = app.world_mut();
        world.query::<&EguiContext>().iter(world).count()
    };
    assert_eq!(contexts(&mut app), 0, "egui rests");
    let toggle = |app: &mut App| {
        for state in [ButtonState::Pressed, ButtonState::Released] {
            app.world_mut().write_message(KeyboardInput {
                key_code: KeyCode::F1,
                logical_key: Key::F1,
                state,
                text: None,
                repeat: false,
                window: Entity::PLACEHOLDER,
            });
            step(app, 2);
        }
    };
    toggle(&mut app);
    settle(&mut app).unwrap();
    assert_eq!(contexts(&mut app), 1);
    let open = capture(&mut app).unwrap();
    // The window covers the left, and nothing else.
    let differs = |x: u32| (0..SIZE.y).any(|y| open.get_pixel(x, y) != plain.get_pixel(x, y));
    assert!(differs(100) && !differs(600));
    toggle(&mut app);
    assert_eq!(contexts(&mut app), 0);
    assert!(capture(&mut app).unwrap() == plain);
    // And again: letters and all.
    toggle(&mut app);
    settle(&mut app).unwrap();
    assert!(capture(&mut app).unwrap() != plain);
    assert_eq!(validation_errors(&app), [""; 0]);
}

#[test]
fn a_slider_follows_the_pointer_and_the_arrows() {
    let mut app = opened();
    // Over the window, then out of it: the camera keeps still, then follows.
    let rect = in_sight(&mut app, "Slider", "contact");
    drag(&mut app, rect.left_center(), rect.center());
    let contact = only::<ScreenSpaceFluid>(&mut app).contact;
    assert!(
        (contact - 4.0).abs() < 0.5,
        "the middle of 0..=8: {contact}"
    );
    let moves = app.world().resource::<CameraMoves>().0;
    step(&mut app, 5);
    assert_eq!(app.world().resource::<CameraMoves>().0, moves);
    focus(&mut app, "Slider", "contact");
    press(&mut app, egui::Key::ArrowRight);
    let more = only::<ScreenSpaceFluid>(&mut app).contact;
    assert!(more > contact, "{more}");
    press(&mut app, egui::Key::ArrowLeft);
    press(&mut app, egui::Key::ArrowLeft);
    assert!(only::<ScreenSpaceFluid>(&mut app).contact < more);
    send(&mut app, [Event::PointerMoved(pos2(630.0, 470.0))]);
    step(&mut app, 3);
    assert!(app.world().resource::<CameraMoves>().0 > moves);

    let rect = in_sight(&mut app, "Button", "reset contact");
    click(&mut app, rect.center());
    assert_eq!(
        only::<ScreenSpaceFluid>(&mut app),
        ScreenSpaceFluid::default()
    );
}

#[test]
fn the_fluid_beside_the_window_follows_a_slider_and_its_reset() {
    let mut app = opened();
    let reset = |app: &mut App| {
        let rect = in_sight(app, "Button", "reset refractive index");
        click(app, rect.center());
        (only::<FluidMaterial>(app).refractive_index, beside(app))
    };
    let before = reset(&mut app);
    let rect = in_sight(&mut app, "Slider", "refractive index");
    assert!(beside(&mut app) == before.1, "to scroll changes nothing");
    drag(&mut app, rect.left_center(), rect.center());
    assert!(only::<FluidMaterial>(&mut app).refractive_index > before.0 + 0.5);
    assert!(beside(&mut app) != before.1);
    assert!(reset(&mut app) == before);
}

#[test]
fn tab_goes_from_setting_to_setting_and_changes_none() {
    let mut app = opened();
    let camera = only::<ScreenSpaceFluid>(&mut app);
    let material = only::<FluidMaterial>(&mut app);
    let kernel = only::<SurfaceKernel>(&mut app);
    let mut visited = Vec::new();
    for _ in 0..60 {
        press(&mut app, egui::Key::Tab);
        let focus = focused(&mut app);
        if let Some(widget) = widgets(&mut app)
            .into_iter()
            .find(|it| Some(it.id) == focus)
        {
            visited.push((widget.role, widget.name));
        }
    }
    for wanted in [
        ("Slider", "contact"),
        ("ComboBox", "refractions"),
        ("Slider", "refractive index"),
    ] {
        let mut all = visited.iter();
        assert!(
            all.any(|(role, name)| (role.as_str(), name.as_str()) == wanted),
            "{wanted:?} not in {visited:?}"
        );
    }
    assert_eq!(only::<ScreenSpaceFluid>(&mut app), camera);
    assert_eq!(only::<FluidMaterial>(&mut app), material);
    assert_eq!(only::<SurfaceKernel>(&mut app), kernel);
}

#[test]
fn presets_variants_and_views_are_chosen_from_lists() {
    let mut app = opened();
    let liquid = beside(&mut app);
    choose(&mut app, "preset", "ACCURATE");
    assert_eq!(
        only::<ScreenSpaceFluid>(&mut app),
        ScreenSpaceFluid::ACCURATE
    );
    choose(&mut app, "refractions", "One");
    assert_eq!(
        only::<ScreenSpaceFluid>(&mut app).refractions,
        Refractions::One
    );
    choose(&mut app, "smoothing", "NarrowRange");
    assert_eq!(
        only::<ScreenSpaceFluid>(&mut app).smoothing,
        Smoothing::NarrowRange(default())
    );
    let rect = in_sight(&mut app, "Button", "Reset");
    click(&mut app, rect.center());
    assert_eq!(
        only::<ScreenSpaceFluid>(&mut app),
        ScreenSpaceFluid::default()
    );

    choose(&mut app, "shown", "overdraw");
    assert_eq!(only::<FluidDebugView>(&mut app), FluidDebugView::Overdraw);
    assert!(beside(&mut app) != liquid);
}
