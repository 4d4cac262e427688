//! Settings out of range: what is drawn and simulated reads a clamped copy, and one line is logged.

use bevy::prelude::*;
use bevy_fluid::{
    prelude::*,
    settings::{PlaneFit, Smoothing, Window},
    test_hooks::Checked,
};
use fluid_stage::log;

/// An app without a renderer, and an entity that other tests' apps log nothing about.
fn app() -> (App, Entity) {
    log::listen();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins(FluidPlugins);
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    let entity = (0..5000).map(|_| world.spawn_empty().id()).last();
    (app, entity.unwrap())
}

fn checked<C: Settings + Component>(app: &App, entity: Entity) -> C {
    let checked = app.world().get::<Checked<C>>(entity).unwrap();
    (**checked).clone()
}

#[test]
fn a_cameras_settings_are_clamped_and_logged_once() {
    let (mut app, camera) = app();
    let fit = |half_taps, window| ScreenSpaceFluid {
        smoothing: Smoothing::PlaneFit(PlaneFit {
            half_taps,
            window,
            ..PlaneFit::DEFAULT
        }),
        ..ScreenSpaceFluid::DEFAULT
    };
    for (name, bad, clamped) in [
        (
            "contact` is NaN",
            ScreenSpaceFluid {
                contact: f32::NAN,
                ..ScreenSpaceFluid::THESIS
            },
            ScreenSpaceFluid {
                contact: 1.0,
                ..ScreenSpaceFluid::THESIS
            },
        ),
        (
            "smoothing.half_taps` is 1000",
            fit(1000, Window::Pixels),
            fit(8, Window::Pixels),
        ),
        (
            "smoothing.window` is -1",
            fit(5, Window::Radii(-1.0)),
            fit(5, Window::Radii(0.05)),
        ),
    ] {
        for _ in 0..3 {
            app.world_mut().entity_mut(camera).insert(bad);
            app.update();
            assert_eq!(checked::<ScreenSpaceFluid>(&app, camera), clamped);
        }
        let line = format!("entity {camera}: `ScreenSpaceFluid::{name}; it must be from ");
        assert_eq!(log::count(&line), 1, "{line}");
    }
}

#[test]
fn a_warning_is_logged_once() {
    let (mut app, a) = app();
    let b = app.world_mut().spawn_empty().id();
    let mut bad = FluidMaterial::WATER;
    let mut set = |entity: Entity, density: f32| {
        bad.medium.absorption_density = density;
        app.world_mut().entity_mut(entity).insert(bad);
        app.update();
        let name = "`FluidMaterial::medium.absorption_density`";
        log::count(&format!("entity {entity}: {name}"))
    };
    assert_eq!(set(a, f32::NAN), 1);
    assert_eq!(set(a, f32::NAN), 1, "said already");
    assert_eq!(set(a, -1.0), 1, "of the same field");
    assert_eq!(set(b, -1.0), 1, "another fluid");
    assert_eq!(set(a, 1.0), 1, "mended");
    assert_eq!(set(a, -1.0), 2, "bad again");
}

/// Copies come with their settings, change with them, and go with them.
#[test]
fn copies_follow_their_settings() {
    let (mut app, fluid) = app();
    app.world_mut().entity_mut(fluid).insert(FluidMaterial::INK);
    assert_eq!(
        checked::<FluidMaterial>(&app, fluid),
        FluidMaterial::INK,
        "at once"
    );
    let mut material = app.world_mut().get_mut::<FluidMaterial>(fluid).unwrap();
    material.refractive_index = 100.0;
    app.update();
    assert_eq!(checked::<FluidMaterial>(&app, fluid).refractive_index, 5.0);
    let mut entity = app.world_mut().entity_mut(fluid);
    entity.remove::<FluidMaterial>();
    app.update();
    assert!(app.world().get::<Checked<FluidMaterial>>(fluid).is_none());
}

/// An invalid kernel is clamped, like any other settings, and the fluid is drawn.
#[test]
fn a_fluid_with_an_invalid_kernel_is_shaped() {
    let (mut app, fluid) = app();
    app.world_mut().entity_mut(fluid).insert((
        FluidParticles::new(vec![Vec3::ZERO], 0.05),
        SurfaceKernel {
            neighbor_radius: f32::NAN,
            sphere_neighbors: 20,
            full_neighbors: 10,
            ..default()
        },
    ));
    app.update();
    let kernel = checked::<SurfaceKernel>(&app, fluid);
    assert_eq!(kernel.neighbor_radius, 4.0);
    assert_eq!((kernel.sphere_neighbors, kernel.full_neighbors), (10, 10));
    let shaped = app
        .world()
        .get::<bevy_fluid::particles::ShapedFluid>(fluid)
        .unwrap();
    assert_eq!(shaped.spray(), 1);
    assert_eq!(log::count(&format!("entity {fluid}: `SurfaceKernel::")), 1);
}
