//! What is changed while it is simulated.

use bevy::prelude::*;
use bevy_fluid::{prelude::*, salva::SalvaLoad};

use super::pool::{STEP, app, load, particles, pool, run, spawn_water, status, weight_of};

const VELOCITY: Vec3 = vec3(1.0, 0.0, 0.5);

/// A ball that flies without a weight, for a tenth of a second already.
fn flying() -> (App, Entity) {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    let body = SalvaBody {
        velocity: VELOCITY,
        ..SalvaBody::new(Sphere::new(0.1), 500.0)
    };
    let body = app.world_mut().spawn(body).id();
    run(&mut app, 0.1);
    // By a push on its way, so that it is no longer what it started with.
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::Y * 10.0;
    run(&mut app, 0.1);
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    run(&mut app, 0.1);
    (app, body)
}

fn place(app: &App, body: Entity) -> Vec3 {
    app.world().get::<Transform>(body).unwrap().translation
}

fn velocity(app: &mut App, body: Entity) -> Vec3 {
    let before = place(app, body);
    app.update();
    (place(app, body) - before) / STEP
}

fn edit(app: &mut App, body: Entity, change: impl Fn(&mut SalvaBody)) {
    change(&mut app.world_mut().get_mut::<SalvaBody>(body).unwrap());
}

#[test]
fn a_body_goes_on_when_its_material_or_size_is_edited() {
    let (mut app, body) = flying();
    let pushed = VELOCITY + Vec3::Y;
    let now = velocity(&mut app, body);
    assert!(now.abs_diff_eq(pushed, 1e-2), "{now}");
    let changes: [fn(&mut SalvaBody); 4] = [
        |it| it.friction = 0.1,
        |it| it.density = 900.0,
        |it| it.restitution = 0.9,
        |it| it.shape = Sphere::new(0.15).into(),
    ];
    for (i, change) in changes.into_iter().enumerate() {
        edit(&mut app, body, change);
        for _ in 0..3 {
            let now = velocity(&mut app, body);
            assert!(now.abs_diff_eq(pushed, 1e-2), "{now} after change {i}");
        }
    }
    let mut transform = app.world_mut().get_mut::<Transform>(body).unwrap();
    transform.scale = Vec3::splat(2.0);
    for _ in 0..3 {
        let now = velocity(&mut app, body);
        assert!(now.abs_diff_eq(pushed, 1e-2), "{now} when scaled");
    }
}

#[test]
fn a_body_starts_anew_when_it_is_told_to() {
    let (mut app, body) = flying();
    let other = Vec3::Z * 3.0;
    edit(&mut app, body, |it| it.velocity = other);
    app.update();
    let now = velocity(&mut app, body);
    assert!(now.abs_diff_eq(other, 1e-2), "launched: {now}");
    let own = *app.world().get::<SalvaBody>(body).unwrap();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::Y * 10.0;
    run(&mut app, 0.1);
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    app.world_mut().entity_mut(body).insert(own);
    app.update();
    let now = velocity(&mut app, body);
    assert!(now.abs_diff_eq(other, 1e-2), "inserted: {now}");
}

#[test]
fn a_boundary_inserted_again_is_elsewhere_at_once() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    let wall = SalvaBoundary::new(Cuboid::new(0.2, 1.0, 1.0));
    let id = app
        .world_mut()
        .spawn((wall, Transform::from_xyz(-1.0, 0.0, 0.0)))
        .id();
    let water = spawn_water(&mut app, vec![Vec3::ZERO]);
    run(&mut app, 0.05);
    let there = Transform::from_xyz(1.0, 0.0, 0.0);
    app.world_mut().entity_mut(id).insert((wall, there));
    run(&mut app, 0.05);
    assert_eq!(particles(&app, water), [Vec3::ZERO]);
    // Merely moved it sweeps the particle along.
    for _ in 0..20 {
        app.world_mut()
            .get_mut::<Transform>(id)
            .unwrap()
            .translation
            .x -= 0.1;
        app.update();
    }
    let swept = particles(&app, water)[0].x;
    assert!(swept < -1.0, "{swept}");
    // Faster than anything may be it does not.
    app.world_mut().resource_mut::<SalvaSettings>().max_speed = 50.0;
    let before = particles(&app, water)[0];
    app.world_mut()
        .get_mut::<Transform>(id)
        .unwrap()
        .translation
        .x = -50.0;
    app.update();
    let way = particles(&app, water)[0] - before;
    assert!(way.length() < 0.5, "{way}");
}

#[test]
fn a_load_that_comes_later_is_written() {
    let mut app = app();
    let (tank, water) = pool(&mut app, vec3(0.6, 1.0, 0.6), 0.5);
    app.world_mut().entity_mut(tank).remove::<SalvaLoad>();
    run(&mut app, 1.0);
    app.world_mut()
        .entity_mut(tank)
        .insert(SalvaLoad::default());
    let mut sum = 0.0;
    for _ in 0..60 {
        app.update();
        sum += load(&app, tank).force.y / 60.0;
    }
    let weight = weight_of(particles(&app, water).len());
    assert!((-sum / weight - 1.0).abs() < 0.2, "{sum} of {weight}");
}

#[test]
fn a_fluid_without_particles_is_not_simulated() {
    let mut app = app();
    let water = spawn_water(&mut app, vec![Vec3::ZERO; 2]);
    run(&mut app, 0.05);
    app.world_mut().entity_mut(water).remove::<FluidParticles>();
    run(&mut app, 0.05);
    assert_eq!(status(&app).particles, 0);
    let again = FluidParticles::new(vec![Vec3::ZERO], 0.02);
    app.world_mut().entity_mut(water).insert(again);
    run(&mut app, 0.05);
    assert_eq!(status(&app).particles, 1, "of another radius");
}
