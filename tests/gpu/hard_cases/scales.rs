//! h12 to h14, h36: far from the origin, very small, very large, very far apart.

use bevy::prelude::*;
use bevy_fluid::prelude::*;

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

/// The scene's liquid at `offset`, whether by its particles' positions or by its transform.
fn show_far(offset: Vec3) -> App {
    let mut view = view();
    view.pose.translation += offset;
    // No walls: far away Bevy's own meshes lose their digits.
    let mut app = show(&view, ScreenSpaceFluid::default(), |world| {
        world.spawn((
            DirectionalLight::default(),
            Transform::default().looking_to(vec3(-0.4, -1.0, -0.6), Vec3::Y),
        ));
    });
    let camera = only::<Camera3d>(&mut app);
    let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
    camera.clear_color = ClearColorConfig::Custom(Color::WHITE);
    app
}

fn ink(app: &mut App, positions: Vec<Vec3>, kernel: SurfaceKernel, at: Vec3) -> RgbaImage {
    let particles = FluidParticles::new(positions, RADIUS);
    let place = Transform::from_translation(at);
    pour(app, (particles, kernel, FluidMaterial::INK, place));
    picture(app)
}

#[test]
fn h12_a_million_metres_from_the_origin() {
    let offset = vec3(1e6, -5e5, 7.5e5);
    let [mut near, mut far] = [Vec3::ZERO, offset].map(show_far);
    let moved: Vec<_> = particles().iter().map(|p| p + offset).collect();
    let kernel = SurfaceKernel::default();
    // Centres move towards their neighbours' mean, and where positions are large the sum rounds to
    // 1/16 m, half a radius: the loss the docs speak of. Spheres at the particles round nowhere.
    let spheres = SurfaceKernel {
        anisotropic: false,
        ..kernel
    };
    for kernel in [kernel, spheres] {
        let wanted = ink(&mut near, particles(), kernel, Vec3::ZERO);
        let fluid_far = ink(&mut far, particles(), kernel, offset);
        let changed = differing(&fluid_far, &wanted, 1);
        assert!(changed <= 4, "a fluid far away: {changed} pixels");
        let particles_far = ink(&mut far, moved.clone(), kernel, Vec3::ZERO);
        let changed = differing(&particles_far, &wanted, 1);
        if kernel == spheres {
            assert!(changed <= 4, "particles far away: {changed} pixels");
        } else {
            let covered = |picture: &RgbaImage| {
                picture.pixels().filter(|pixel| pixel.0[0] < 250).count() as f64
            };
            let ratio = covered(&particles_far) / covered(&wanted);
            assert!((0.9..1.1).contains(&ratio), "{ratio} of the pixels");
        }
    }
}

#[test]
fn the_transform_leaves_particles_of_the_world_where_they_are() {
    let mut app = show_far(Vec3::ZERO);
    let kernel = SurfaceKernel::default();
    let wanted = ink(&mut app, particles(), kernel, Vec3::ZERO);
    let fluid = FluidParticles {
        space: ParticleSpace::World,
        ..FluidParticles::new(particles(), RADIUS)
    };
    let elsewhere = Transform::from_xyz(1.0, -2.0, 3.0)
        .with_rotation(Quat::from_rotation_y(1.0))
        .with_scale(vec3(2.0, 0.5, 3.0));
    pour(&mut app, (fluid, kernel, FluidMaterial::INK, elsewhere));
    assert_eq!(differing(&picture(&mut app), &wanted, 0), 0);
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
    // Silhouettes may round to the next pixel, of which their neighbours show a part.
    assert!(changed <= 60, "{changed} of {} pixels", 64 * 64);
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
