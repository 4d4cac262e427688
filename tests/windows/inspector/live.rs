//! Settings of what moves particles: live simulation and recordings.

use super::*;

/// Opens a section.
#[track_caller]
fn unfold(app: &mut App, section: &str) {
    let rect = in_sight(app, "Button", section);
    click(app, rect.center());
    step(app, 8);
}

/// Moves a slider to the middle of its range.
#[track_caller]
fn halve(app: &mut App, slider: &str) {
    let rect = in_sight(app, "Slider", slider);
    drag(app, rect.left_center(), rect.center());
}

#[test]
fn the_live_simulation_is_set() {
    let mut app = open(show_with(|app| {
        app.add_plugins(SalvaPlugin);
    }));
    app.world_mut().resource_mut::<SalvaSettings>().paused = true;
    let mut ponds = app
        .world_mut()
        .query_filtered::<Entity, With<FluidParticles>>();
    let pond = ponds.single(app.world()).unwrap();
    app.world_mut().entity_mut(pond).insert(SalvaFluid::HONEY);
    step(&mut app, 2);
    unfold(&mut app, "SalvaFluid");
    halve(&mut app, "adhesion");
    let adhesion = only::<SalvaFluid>(&mut app).adhesion;
    assert!(
        (adhesion - 5.0).abs() < 0.5,
        "the middle of 0..=10: {adhesion}"
    );
    unfold(&mut app, "SalvaSettings");
    halve(&mut app, "max substeps");
    let substeps = app.world().resource::<SalvaSettings>().max_substeps;
    assert!((7..=10).contains(&substeps), "{substeps}");
    choose(&mut app, "mode", "Lockstep");
    let mode = app.world().resource::<SalvaSettings>().mode;
    assert_eq!(mode, SalvaMode::Lockstep);
}

/// The only fluid.
fn pond(app: &mut App) -> EntityWorldMut<'_> {
    let mut ponds = app
        .world_mut()
        .query_filtered::<Entity, With<FluidParticles>>();
    let pond = ponds.single(app.world()).unwrap();
    app.world_mut().entity_mut(pond)
}

#[test]
fn live_simulation_says_how_it_goes() {
    let mut app = show_with(|app| {
        app.add_plugins(SalvaPlugin);
    });
    app.world_mut().resource_mut::<SalvaSettings>().mode = SalvaMode::Lockstep;
    pond(&mut app).insert(SalvaFluid::WATER);
    step(&mut app, 3);
    let particles = ball(0.4, 0.05).len();
    let store = app.world().resource::<DiagnosticsStore>();
    let value = |path| store.get(&path).and_then(Diagnostic::value);
    assert_eq!(value(diagnostics::SALVA_PARTICLES), Some(particles as f64));
    assert!(value(diagnostics::SALVA_STEP).unwrap() > 0.0);
    let mut app = open(app);
    in_sight(&mut app, "Button", "Live simulation");
    find(&mut app, "Label", "ms per step");
}

#[test]
fn a_writer_is_set_and_says_what_it_has_written() {
    use bevy_fluid::recording::RecordingWriter;

    let mut app = opened();
    let writer = RecordingWriter {
        paused: true,
        ..RecordingWriter::new("nowhere_#.xyz")
    };
    pond(&mut app).insert(writer);
    step(&mut app, 2);
    in_sight(&mut app, "Button", "Written frames");
    find(&mut app, "Label", "left out");
    unfold(&mut app, "RecordingWriter");
    halve(&mut app, "rate");
    let rate = only::<RecordingWriter>(&mut app).rate;
    assert!(
        (20.0..50.0).contains(&rate),
        "the middle of 0.1..=10,000: {rate}"
    );
    // Half a name is that of other files.
    let rect = in_sight(&mut app, "TextInput", "frames");
    click(&mut app, rect.center());
    press(&mut app, egui::Key::Home);
    send(&mut app, [Event::Text("else".into())]);
    step(&mut app, 2);
    assert_eq!(only::<RecordingWriter>(&mut app).frames, "nowhere_#.xyz");
    press(&mut app, egui::Key::Enter);
    step(&mut app, 2);
    let frames = only::<RecordingWriter>(&mut app).frames;
    assert_eq!(frames, "elsenowhere_#.xyz");
}

#[test]
fn a_player_is_set() {
    use bevy_fluid::recording::{Interpolation, RecordingPlayer};

    let mut app = opened();
    let mut ponds = app
        .world_mut()
        .query_filtered::<Entity, With<FluidParticles>>();
    let pond = ponds.single(app.world()).unwrap();
    let player = RecordingPlayer::default();
    app.world_mut().entity_mut(pond).insert(player);
    step(&mut app, 2);
    unfold(&mut app, "RecordingPlayer");
    halve(&mut app, "rate");
    let rate = only::<RecordingPlayer>(&mut app).rate;
    assert!(rate.abs() < 5.0, "the middle of -100..=100: {rate}");
    choose(&mut app, "interpolation", "Linear");
    let interpolation = only::<RecordingPlayer>(&mut app).interpolation;
    assert_eq!(interpolation, Interpolation::Linear);
    choose(&mut app, "radius", "Some");
    let radius = only::<RecordingPlayer>(&mut app).radius;
    assert_eq!(radius, Some(0.025), "one that makes sense");
}
