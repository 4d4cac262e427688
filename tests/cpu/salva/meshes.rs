//! Bodies of meshes: the default of `SalvaBody`.

use bevy::prelude::*;
use bevy_fluid::prelude::*;

use super::pool::{app, mean, pool, run};

fn spawn(app: &mut App, body: SalvaBody, mesh: impl Into<Mesh>, at: Transform) -> Entity {
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let mesh = Mesh3d(meshes.add(mesh));
    app.world_mut().spawn((body, mesh, at)).id()
}

#[test]
fn a_mesh_floats_as_the_shape_that_it_is() {
    let heights = [false, true].map(|is_mesh| {
        let mut app = app();
        pool(&mut app, vec3(1.0, 2.0, 1.0), 0.6);
        let size = Vec3::splat(0.3);
        let at = Transform::from_xyz(0.0, 0.9, 0.0);
        let body = if is_mesh {
            // Half as large, scaled by two.
            let at = at.with_scale(Vec3::splat(2.0));
            spawn(
                &mut app,
                SalvaBody::default(),
                Cuboid::from_size(0.5 * size),
                at,
            )
        } else {
            let body = SalvaBody::new(Cuboid::from_size(size), SalvaBody::default().density);
            app.world_mut().spawn((body, at)).id()
        };
        run(&mut app, 2.0);
        let heights = (0..60).map(|_| {
            app.update();
            app.world().get::<Transform>(body).unwrap().translation.y
        });
        mean(heights)
    });
    let [shape, mesh] = heights;
    assert!((shape - mesh).abs() < 0.02, "{shape} and {mesh}");
}

#[test]
fn what_encloses_nothing_is_no_body() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    let body = SalvaBody {
        velocity: Vec3::X,
        ..default()
    };
    let tilted = Transform::from_rotation(Quat::from_rotation_x(0.4));
    let sheet = Plane3d::default().mesh().size(1.0, 0.7);
    let sheet = spawn(&mut app, body, sheet, tilted);
    let thin = spawn(&mut app, body, Cuboid::new(1.0, 1e-3, 0.7), tilted);
    run(&mut app, 0.5);
    let x = |id: Entity| app.world().get::<Transform>(id).unwrap().translation.x;
    assert_eq!(x(sheet), 0.0);
    assert!((x(thin) - 0.5).abs() < 0.02, "{}", x(thin));
}

#[test]
fn a_refused_mesh_is_taken_when_it_is_another() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    let body = SalvaBody {
        velocity: Vec3::X,
        ..default()
    };
    let id = app.world_mut().spawn((body, Transform::default())).id();
    let x = |app: &App| app.world().get::<Transform>(id).unwrap().translation.x;
    run(&mut app, 0.1);
    assert_eq!(x(&app), 0.0, "without a mesh");
    let sheet = Plane3d::default().mesh().size(1.0, 0.7).build();
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(sheet);
    app.world_mut()
        .entity_mut(id)
        .insert(Mesh3d(handle.clone()));
    run(&mut app, 0.1);
    assert_eq!(x(&app), 0.0, "a sheet");
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&handle).unwrap() = Cuboid::default().into();
    run(&mut app, 0.1);
    assert!(x(&app) > 0.05, "the sheet has become a cube: {}", x(&app));
}
