//! temp: look
use bevy::{math::bounding::Aabb3d, prelude::*};
use fluid_stage::{scenery::*, *};
fn setup(mut s: Scenery) {
    let tank = Aabb3d::new(Vec3::new(0., 0.6, 0.), Vec3::new(1.0, 0.6, 0.6));
    let to_sun = Vec3::new(0.6, 0.8, 0.5);
    s.checker_floor(Vec3::ZERO, 6.0, 24);
    s.pillars(tank, 6);
    s.tank(tank);
    s.sun(to_sun, 12.0, true);
    let sky = s.sky(to_sun);
    let (eye, target) = frame_camera(tank, 45_f32.to_radians(), 16.0 / 9.0);
    s.commands.spawn((orbit_camera(eye, target), sky.bundle()));
    let (m, mm) = (
        s.meshes.add(Sphere::new(0.35)),
        s.materials.add(StandardMaterial {
            metallic: 1.0,
            perceptual_roughness: 0.05,
            ..default()
        }),
    );
    s.commands.spawn((
        Mesh3d(m.clone()),
        MeshMaterial3d(mm),
        Transform::from_xyz(-0.5, 0.35, 0.0),
    ));
    let mm = s.materials.add(StandardMaterial {
        perceptual_roughness: 0.5,
        metallic: 1.0,
        ..default()
    });
    s.commands.spawn((
        Mesh3d(m),
        MeshMaterial3d(mm),
        Transform::from_xyz(0.4, 0.35, 0.0),
    ));
}
fn up(mut s: Scenery) {
    let to_sun = Vec3::new(0.2, 0.5, -1.0);
    let sky = s.sky(to_sun);
    s.commands.spawn((
        orbit_camera(Vec3::ZERO, Vec3::new(0., 0.35, -1.0)),
        sky.bundle(),
    ));
    s.checker_floor(Vec3::NEG_Y, 60.0, 120);
}
#[test]
fn look() {
    let t = std::time::Instant::now();
    let mut app = headless_app(UVec2::new(1280, 720), |app| {
        app.add_systems(Startup, setup);
    })
    .unwrap();
    settle(&mut app).unwrap();
    capture(&mut app).unwrap().save("/tmp/look.png").unwrap();
    println!("{:?}", t.elapsed());
    let mut app = headless_app(UVec2::new(1280, 720), |app| {
        app.add_systems(Startup, up);
    })
    .unwrap();
    settle(&mut app).unwrap();
    capture(&mut app).unwrap().save("/tmp/sky.png").unwrap();
    println!("{:?}", t.elapsed());
}
