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

#[cfg(feature = "salva")]
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

#[cfg(feature = "recordings")]
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
