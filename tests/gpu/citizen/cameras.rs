//! Cameras that lack something, or share a target.

use super::*;
use crate::common::assert_sound;
use bevy::{camera::Hdr, core_pipeline::prepass::DepthPrepass};
use bevy_fluid::render::PlanReports;

fn stacked(msaa: Msaa) -> App {
    let mut app = headless_app(SIZE, |app| {
        app.add_plugins(FluidPlugin::default());
        let world = app.world_mut();
        world.spawn(Camera3d::default());
        let red = unlit(Color::srgb(0.9, 0.1, 0.1));
        paint(world, vec3(9.0, 9.0, 0.1), red, vec3(0.0, 0.0, -6.0));
        let above = Camera {
            order: 1,
            clear_color: ClearColorConfig::None,
            ..default()
        };
        let layer = RenderLayers::layer(1);
        world.spawn((
            Camera3d::default(),
            above,
            layer.clone(),
            ScreenSpaceFluid::default(),
            msaa,
        ));
        world.spawn((
            drop_of(FluidMaterial::CLEAR_WATER, Vec3::NEG_Z * 3.0),
            layer,
        ));
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

/// The lower camera has no `Hdr` of its own. Its wall keeps its colour: tones are mapped once.
#[test]
fn what_a_lower_camera_draws_is_refracted() {
    let mut app = stacked(Msaa::default());
    let mut alone = headless_app(SIZE, |app| {
        let world = app.world_mut();
        world.spawn(Camera3d::default());
        let red = unlit(Color::srgb(0.9, 0.1, 0.1));
        paint(world, vec3(9.0, 9.0, 0.1), red, vec3(0.0, 0.0, -6.0));
    })
    .unwrap();
    settle(&mut alone).unwrap();
    let lone = pixel(&mut alone, MIDDLE);
    let (wall, through) = (pixel(&mut app, uvec2(10, 60)), pixel(&mut app, MIDDLE));
    assert!(lone[0] > 150 && differ(lone, wall) < 6, "{lone:?} {wall:?}");
    assert!(through[0] > 100 && through[1] < 120, "{through:?}");
}

/// A camera without `Hdr` over one with liquid: what moves in it leaves no trail.
#[test]
fn what_an_upper_camera_draws_leaves_no_trail() {
    let mut thing = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |world, _| {
        let above = Camera {
            order: 1,
            clear_color: ClearColorConfig::None,
            ..default()
        };
        let layer = RenderLayers::layer(1);
        world.spawn((Camera3d::default(), above, layer.clone()));
        let green = unlit(Color::srgb(0.1, 0.9, 0.1));
        thing = paint(world, Vec3::splat(0.2), green, vec3(0.0, 0.0, -2.0));
        world.entity_mut(thing).insert(layer);
    });
    let before = pixel(&mut app, MIDDLE);
    assert!(before[1] > 100 && before[0] < 100, "{before:?}");
    let aside = Transform::from_xyz(0.7, 0.0, -2.0);
    app.world_mut().entity_mut(thing).insert(aside);
    fluid_stage::step(&mut app, 2);
    let after = pixel(&mut app, MIDDLE);
    assert!(after[1] < 100, "ink again: {after:?}");
}

#[test]
fn stacked_cameras_of_other_samples_are_named() {
    fluid_stage::log::listen();
    let before = fluid_stage::log::count("differ in `Msaa`");
    let _app = stacked(Msaa::Off);
    assert_eq!(fluid_stage::log::count("differ in `Msaa`"), before + 1);
}

#[test]
fn without_a_prepass_the_liquid_stays_and_the_log_says_so() {
    fluid_stage::log::listen();
    let mut eye = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, camera| eye = camera);
    for msaa in [Msaa::Sample4, Msaa::Off] {
        app.world_mut().entity_mut(eye).insert((DepthPrepass, msaa));
        settle(&mut app).unwrap();
        let with = pixel(&mut app, MIDDLE);
        let before = fluid_stage::log::count("has no `DepthPrepass`");
        app.world_mut().entity_mut(eye).remove::<DepthPrepass>();
        for _ in 0..4 {
            fluid_stage::step(&mut app, 1);
            let without = pixel(&mut app, MIDDLE);
            assert!(differ(with, without) < 8, "{with:?} {without:?}");
        }
        assert_sound(&app);
        assert_eq!(fluid_stage::log::count("has no `DepthPrepass`"), before + 1);
        let reports = app.world().resource::<PlanReports>().clone();
        reports.ask();
        fluid_stage::step(&mut app, 2);
        // Ink is opaque: it has nothing to refract.
        assert!(reports.latest()[0].surfaces[0].waiting.is_none());
    }
    // Clear water has: it shows the wall straight behind it.
    let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, camera| {
        world.entity_mut(camera).remove::<DepthPrepass>();
        let red = unlit(Color::srgb(0.9, 0.1, 0.1));
        paint(world, vec3(9.0, 9.0, 0.1), red, vec3(0.0, 0.0, -6.0));
        // In front of it, a thing hides the water.
        let green = unlit(Color::srgb(0.1, 0.9, 0.1));
        paint(world, vec3(0.1, 0.1, 0.1), green, vec3(0.2, 0.0, -2.0));
    });
    let through = pixel(&mut app, MIDDLE);
    assert!(through[0] > 150 && through[1] < 90, "{through:?}");
    let covered = pixel(&mut app, uvec2(94, 60));
    assert!(covered[1] > 150, "{covered:?}");
    let reports = app.world().resource::<PlanReports>().clone();
    reports.ask();
    fluid_stage::step(&mut app, 2);
    let report = &reports.latest()[0].surfaces[0];
    let why = report.skipped.iter().find(|it| it.work == "refraction");
    assert_eq!(why.unwrap().why, "the camera has no DepthPrepass");
}

#[test]
fn a_camera_that_loses_hdr_is_named_once() {
    fluid_stage::log::listen();
    let mut eye = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, camera| eye = camera);
    let before = fluid_stage::log::count("has no `Hdr`");
    app.world_mut().entity_mut(eye).remove::<Hdr>();
    fluid_stage::step(&mut app, 4);
    assert!(pixel(&mut app, MIDDLE)[0] < 110);
    assert_eq!(fluid_stage::log::count("has no `Hdr`"), before + 1);
}
