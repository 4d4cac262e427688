//! h12 to h14, h36: far from the origin, very small, very large, very far apart.

use bevy::prelude::*;
use bevy_fluid::{ScreenSpaceFluid, prelude::*};

use super::*;

const RADIUS: f32 = 0.125;

/// On multiples of 1/16 m, which f32 still resolves 1e6 m away.
fn particles() -> Vec<Vec3> {
    let block = lattice(6, 2.0 * RADIUS, 0.3);
    let droplet = vec3(1.0, 1.25, 0.5);
    let all = block
        .iter()
        .map(|p| p - vec3(0.6, 0.8, 0.6))
        .chain([droplet]);
    all.map(|p| (p * 16.0).round() / 16.0).collect()
}

fn view() -> View {
    View {
        // A power of two apart, so that the camera's place is on the grid as well.
        pose: Transform::from_xyz(2.0, 1.5, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
        ..View::new(64, PERSPECTIVE)
    }
}

fn walls_behind(world: &mut World, offset: Vec3) {
    for at in [vec3(-3.0, 0.0, -4.0), vec3(-1.0, -1.0, -5.0)] {
        let place = Transform::from_translation(offset + at);
        spawn_box(world, vec3(1.0, 3.0, 0.25), place);
    }
}

#[test]
fn h12_a_million_metres_from_the_origin() {
    let mut app = show(&view(), ScreenSpaceFluid::default(), |world| {
        walls_behind(world, Vec3::ZERO);
    });
    let kernel = SurfaceKernel::default();
    pour(&mut app, fluid(&particles(), RADIUS, kernel));
    let near = picture(&mut app);
    let offset = vec3(1e6, -5e5, 7.5e5);
    let mut view = view();
    view.pose.translation += offset;
    let mut app = show(&view, ScreenSpaceFluid::default(), |world| {
        walls_behind(world, offset);
    });
    // Once the particles are far from their own origin, once the fluid stands far away.
    let moved: Vec<_> = particles().iter().map(|p| p + offset).collect();
    pour(&mut app, fluid(&particles(), RADIUS, kernel));
    let fluid_entity = only::<FluidParticles>(&mut app);
    app.world_mut()
        .entity_mut(fluid_entity)
        .insert(Transform::from_translation(offset));
    settle(&mut app).unwrap();
    let far = picture(&mut app);
    // Nothing rounds: the eye is subtracted before anything is turned.
    let changed = differing(&far, &near, 1);
    assert!(changed <= 4, "a fluid far away: {changed} pixels");
    // Centres move towards their neighbours' mean, and there the sum rounds to 1/16 m: half a
    // radius, which is the loss the docs speak of. With spheres at the particles nothing rounds.
    let spheres = SurfaceKernel {
        center_shift: 0.0,
        ..kernel
    };
    pour(
        &mut app,
        (
            fluid(&particles(), RADIUS, spheres),
            Transform::from_translation(offset),
        ),
    );
    let fluid_far = picture(&mut app);
    pour(&mut app, fluid(&moved, RADIUS, spheres));
    let changed = differing(&picture(&mut app), &fluid_far, 1);
    assert!(changed <= 4, "particles far away: {changed} pixels");
    pour(&mut app, fluid(&moved, RADIUS, kernel));
    let covered = |picture: &RgbaImage| {
        let first = *picture.get_pixel(0, 0);
        picture.pixels().filter(|&&pixel| pixel != first).count() as f64
    };
    let ratio = covered(&picture(&mut app)) / covered(&near);
    assert!((0.9..1.1).contains(&ratio), "{ratio} of the pixels");
}

/// The whole scene, camera and walls included, `scale` times as large.
fn scaled(scale: f32) -> RgbaImage {
    let mut view = view();
    view.pose.translation *= scale;
    view.lens = Lens::Perspective {
        fov: 0.7,
        near: 0.1 * scale,
    };
    let mut app = show(&view, ScreenSpaceFluid::default(), |world| {
        for at in [vec3(-3.0, 0.0, -4.0), vec3(-1.0, -1.0, -5.0)] {
            spawn_box(
                world,
                vec3(1.0, 3.0, 0.25) * scale,
                Transform::from_translation(at * scale),
            );
        }
        let positions = particles().iter().map(|&p| p * scale).collect();
        let mut material = FluidMaterial::INK;
        material.medium.absorption_density /= scale;
        world.spawn((FluidParticles::new(positions, RADIUS * scale), material));
        world.spawn((
            DirectionalLight::default(),
            Transform::default().looking_to(vec3(-0.4, -1.0, -0.6), Vec3::Y),
        ));
    });
    picture(&mut app)
}

#[test]
fn h13_everything_scaled_by_1e_minus_4() {
    assert_scaled(1e-4);
}

#[test]
fn h14_everything_scaled_by_1e4() {
    assert_scaled(1e4);
}

fn assert_scaled(scale: f32) {
    let changed = differing(&scaled(scale), &scaled(1.0), 2);
    // Silhouettes may round to the next pixel.
    assert!(changed <= 20, "{changed} of {} pixels", 64 * 64);
}

#[test]
fn h36_clusters_1e5_apart() {
    let mut app = show(&view(), ScreenSpaceFluid::default(), |world| {
        walls_behind(world, Vec3::ZERO);
    });
    pour(
        &mut app,
        fluid(&particles(), RADIUS, SurfaceKernel::default()),
    );
    let alone = picture(&mut app);
    for apart in [
        vec3(1e5, 0.0, 0.0),
        vec3(0.0, 0.0, 1e5),
        vec3(-1e5, -2e4, -1e5),
    ] {
        let other = particles().into_iter().map(|p| p + apart);
        let both: Vec<_> = particles().into_iter().chain(other).collect();
        pour(&mut app, fluid(&both, RADIUS, SurfaceKernel::default()));
        // The far cluster is at most one pixel.
        let changed = differing(&picture(&mut app), &alone, 1);
        assert!(changed <= 2, "{changed} pixels, {apart} apart");
    }
    // Memory: as many splats as particles, and the grid is tested where it is seen, in
    // `shape::tests::h36_memory_follows_the_particles`.
    assert_eq!(
        report(&mut app).bulk() + report(&mut app).interior() + report(&mut app).spray(),
        2 * particles().len() as u32
    );
}
