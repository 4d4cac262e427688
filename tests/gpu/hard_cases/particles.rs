//! h01 to h11: particles that are no good, few, or in degenerate places. Their splats are tested
//! in `tests/cpu/shape`, under the same numbers; here it is what becomes of them on screen.

use bevy::prelude::*;
use bevy_fluid::{prelude::*, render::Layers};

use super::*;

const RADIUS: f32 = 0.1;

fn view() -> View {
    View::new(64, PERSPECTIVE)
}

/// A block with a droplet beside it, five metres ahead.
fn particles() -> Vec<Vec3> {
    let block = lattice(6, 2.0 * RADIUS, 0.1);
    let shifted = block.iter().map(|p| p + vec3(-0.5, -0.7, -5.5));
    shifted.chain([vec3(0.8, 0.8, -5.0)]).collect()
}

/// Particles with others mixed in give the picture that they give without them.
fn assert_dropped(others: &[Vec3], count: u32) {
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    let kernel = SurfaceKernel::default();
    pour(&mut app, fluid(&particles(), RADIUS, kernel));
    let clean = picture(&mut app);
    let mut mixed = particles();
    mixed.splice(70..70, others.iter().copied());
    pour(&mut app, fluid(&mixed, RADIUS, kernel));
    assert_eq!(report(&mut app).dropped(), count);
    assert!(picture(&mut app) == clean);
    pour(&mut app, fluid(others, RADIUS, kernel));
    assert!(view_surfaces(&app).is_none(), "nothing else is drawn");
}

#[test]
fn h01_nan_positions_are_dropped_and_counted() {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * f32::NAN);
    assert_dropped(&[Vec3::NAN, x, y, z], 4);
}

#[test]
fn h02_infinite_positions_are_dropped_and_counted() {
    let far = vec3(0.0, 0.0, f32::INFINITY);
    assert_dropped(&[Vec3::INFINITY, Vec3::NEG_INFINITY, far, Vec3::MAX], 4);
    // What is finite stays, however far: nobody sees it, and it hides nothing.
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    pour(&mut app, fluid(&particles(), RADIUS, STRETCHED));
    let clean = picture(&mut app);
    for far in [1e5, 1e12, 1e20, 1e29, -1e30] {
        for direction in [vec3(1.0, 1.0, 1.0), vec3(0.0, 0.3, -1.0), Vec3::X] {
            let all = [particles(), vec![direction * far]].concat();
            pour(&mut app, fluid(&all, RADIUS, STRETCHED));
            assert_eq!(report(&mut app).dropped(), 0);
            // Less than a pixel of it is ahead, if any.
            let changed = differing(&picture(&mut app), &clean, 1);
            assert!(changed <= 1, "{changed} pixels, {far} m along {direction}");
        }
    }
}

#[test]
fn h03_a_radius_that_is_no_length_draws_nothing_and_is_said_once() {
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    let empty = picture(&mut app);
    // The log is the whole process's: the fluid's name is that of no other test's.
    let others = std::iter::repeat_n((), 4321);
    app.world_mut().spawn_batch(others).for_each(drop);
    for (radius, name) in [
        (0.0, "is 0 m"),
        (-7.25, "is -7.25 m"),
        (f32::NAN, "is NaN m"),
    ] {
        pour(
            &mut app,
            fluid(&particles(), radius, SurfaceKernel::default()),
        );
        for frame in 0..3 {
            let fluid = only::<FluidParticles>(&mut app);
            app.world_mut()
                .get_mut::<FluidParticles>(fluid)
                .unwrap()
                .positions[0]
                .x += 0.1;
            settle(&mut app).unwrap();
            assert!(picture(&mut app) == empty, "radius {radius}, frame {frame}");
        }
        let fluid = only::<FluidParticles>(&mut app);
        let line = format!("fluid {fluid} is not drawn: particle radius {name}");
        assert_eq!(log::count(&line), 1, "{line}");
    }
}

#[test]
fn h04_without_particles_the_picture_is_that_without_the_plugin() {
    let mut plain = fluid_stage::headless_app(view().size, |app| {
        app.world_mut().spawn(view().plain_camera());
        walls(app.world_mut());
    })
    .unwrap();
    settle(&mut plain).unwrap();
    let plain = capture(&mut plain).unwrap();
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    assert!(picture(&mut app) == plain, "no fluid");
    pour(&mut app, fluid(&[], RADIUS, SurfaceKernel::default()));
    assert!(picture(&mut app) == plain, "a fluid of no particles");
    assert!(view_surfaces(&app).is_none());
}

#[test]
fn h05_h06_one_particle_and_two_are_spheres_of_spray() {
    let view = view();
    let mut app = show(&view, RAW, |_| {});
    let one = [vec3(0.1, -0.05, -4.0)];
    let two = [one[0], one[0] + vec3(0.3, 0.2, 0.4) * RADIUS];
    for positions in [&one[..], &two] {
        let radius = 5.0 * RADIUS;
        let fluid = (positions, radius, SurfaceKernel::default());
        assert!(assert_drawn(&view, &mut app, fluid, 1e-3) > 100);
        assert_eq!(report(&mut app).spray() as usize, positions.len());
        let spheres = Ellipsoid::spheres(&view, positions, radius);
        assert_layers(&view, &read(&app, Layers::spray), &spheres, 5e-4);
    }
}

#[test]
fn h06_two_particles_of_the_bulk_fall_back_to_spheres() {
    let view = view();
    let mut app = show(&view, RAW, |_| {});
    let positions = [vec3(0.0, 0.0, -4.0), vec3(0.3, 0.0, -4.2)];
    // No neighbour is enough for a direction across the line through both.
    let kernel = SurfaceKernel {
        spray_threshold: 0,
        ..default()
    };
    assert_drawn(&view, &mut app, (&positions, 0.4, kernel), 1e-3);
    let spheres = Ellipsoid::spheres(&view, &positions, 0.4);
    assert_layers(&view, &read(&app, Layers::bulk), &spheres, 4e-4);
}

#[test]
fn h07_four_coplanar_particles_do_not_pop() {
    let view = view();
    let mut app = show(&view, ScreenSpaceFluid::default(), walls);
    let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y];
    let flat = flat.map(|p| p * 0.6 + vec3(-0.3, -0.3, -4.0));
    for kernel in [SurfaceKernel::default(), STRETCHED] {
        pour(&mut app, fluid(&flat, 0.3, kernel));
        let still = picture(&mut app);
        let layers = read_both(&app);
        let mut bent = flat;
        bent[3].z += 1e-4 * 0.3;
        pour(&mut app, fluid(&bent, 0.3, kernel));
        // A pixel whose centre the silhouette passes may change sides.
        assert!(differing(&picture(&mut app), &still, 4) <= 2);
        for (still, bent) in layers.iter().zip(&read_both(&app)) {
            let depths = still.texels::<[f32; 2]>().zip(bent.texels::<[f32; 2]>());
            let moved = |(a, b): (f32, f32)| (view.depth(a.abs()) - view.depth(b.abs())).abs();
            let jumped = depths.filter(|(a, b)| {
                let there = a[0] > 0.0 && b[0] > 0.0;
                there && (moved((a[0], b[0])) > 3e-3 || moved((a[1], b[1])) > 3e-3)
            });
            assert!(jumped.count() <= 2);
        }
    }
}

fn read_both(app: &App) -> Vec<fluid_stage::TextureData> {
    let plan = *surface(app).0.plan().unwrap();
    let bulk = plan.bulk.then(|| read(app, Layers::bulk));
    let spray = plan.spray.then(|| read(app, Layers::spray));
    bulk.into_iter().chain(spray).collect()
}

#[test]
fn h08_coincident_particles_are_one_sphere() {
    let view = view();
    let mut app = show(&view, RAW, |_| {});
    let at = vec3(0.1, 0.0, -4.0);
    for count in [3, 40, 5000] {
        for kernel in [SurfaceKernel::default(), STRETCHED] {
            let positions = vec![at; count];
            assert_drawn(&view, &mut app, (&positions[..], 0.5, kernel), 1e-3);
            let bulk = report(&mut app).bulk() > 0;
            let layers = read(&app, if bulk { Layers::bulk } else { Layers::spray });
            assert_layers(&view, &layers, &Ellipsoid::spheres(&view, &[at], 0.5), 5e-4);
        }
    }
}

/// The layers of particles are those of their ellipsoids, seen along, across and between axes.
fn assert_from_all_sides(positions: &[Vec3], radius: f32, kernel: SurfaceKernel) {
    let mut view = view();
    let mut app = show(&view, RAW, |_| {});
    for from in [Vec3::Z, Vec3::X, vec3(1.0, 2.0, 3.0), vec3(-1.0, 0.3, -0.2)] {
        view.pose = Transform::from_translation(4.0 * from.normalize())
            .looking_at(Vec3::ZERO, vec3(0.1, 1.0, 0.2));
        look(&mut app, view.pose);
        // Shorter axes mean steeper sides, where a pixel's ray rounds to more of a depth.
        let covered = assert_drawn(&view, &mut app, (positions, radius, kernel), 4e-3);
        assert!(covered > 10, "{covered} pixels, from {from}");
    }
    look(&mut app, ScreenSpaceFluid::default());
    assert_sound(&app);
}

#[test]
fn h09_collinear_particles_are_finite_spindles() {
    let along = vec3(2.0, -1.0, 0.5).normalize();
    let line = |i: i32| along * (i as f32 * 0.4 * RADIUS);
    let positions: Vec<_> = (-15..=15).map(line).collect();
    assert_from_all_sides(&positions, RADIUS, STRETCHED);
    let axis = (0..31).map(|i| Vec3::Z * (0.05 * (i - 15) as f32));
    assert_from_all_sides(&axis.collect::<Vec<_>>(), RADIUS, STRETCHED);
}

#[test]
fn h10_a_coplanar_sheet_is_of_discs() {
    let sheet = (0..196).map(|i| vec3((i % 14) as f32 - 6.5, (i / 14) as f32 - 6.5, 0.0));
    let positions: Vec<_> = sheet.map(|p| p * 1.4 * RADIUS).collect();
    assert_from_all_sides(
        &positions,
        RADIUS,
        SurfaceKernel {
            skip_interior: false,
            ..default()
        },
    );
}

#[test]
fn h11_an_isotropic_neighborhood_is_a_sphere() {
    let lattice = lattice(7, 2.0 * RADIUS, 0.0);
    let middle = lattice[lattice.len() / 2];
    let positions: Vec<_> = lattice.iter().map(|&p| p - middle).collect();
    let splats = shaped(&positions, RADIUS, &STRETCHED);
    let center = positions.len() / 2;
    let splat = splats.splats.iter().find(|s| s.particle as usize == center);
    let matrix = splat.unwrap().matrix() * (1.0 / (1.24 * RADIUS));
    // f16 rounds the axes by up to 1/2048.
    assert!(
        (matrix - Mat3::IDENTITY)
            .to_cols_array()
            .iter()
            .all(|d| d.abs() < 1e-3)
    );
    assert_from_all_sides(&positions, RADIUS, STRETCHED);
}
