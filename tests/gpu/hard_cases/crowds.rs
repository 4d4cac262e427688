//! h35, h37, h38, h48 and h49: many particles, in any order, come and gone.

use std::time::Duration;

use bevy::{
    prelude::*,
    render::settings::{WgpuLimits, WgpuSettings},
};
use bevy_fluid::{prelude::*, render::Layers};
use fluid_stage::{headless_app_with, step};

use super::*;

const RADIUS: f32 = 0.1;

fn view() -> View {
    View::new(64, PERSPECTIVE)
}

/// A block with droplets around it, five metres ahead.
fn particles() -> Vec<Vec3> {
    let mut random = Random(12);
    let block = lattice(8, 2.0 * RADIUS, 0.2);
    let droplets = (0..60).map(|_| (2.0 * random.point() - 1.0) * 1.6 + vec3(0.0, 0.0, -5.0));
    let shifted = block.iter().map(|p| p + vec3(-0.7, -0.9, -5.7));
    shifted.chain(droplets.collect::<Vec<_>>()).collect()
}

#[test]
fn h35_a_hundred_thousand_particles_in_one_cell() {
    let mut random = Random(2);
    let crowd: Vec<_> = (0..100_000).map(|_| random.point() * RADIUS).collect();
    let kernel = SurfaceKernel::default();
    let time = |count: usize| {
        let once = |_| shaped(&crowd[..count], RADIUS, &kernel).times.total;
        (0..3).map(once).min().unwrap()
    };
    let [few, many] = [12_500, 100_000].map(time);
    assert!(few > Duration::ZERO, "times are reported");
    // Linear would be 8 times as long, quadratic 64 times.
    let ratio = many.as_secs_f64() / few.as_secs_f64();
    assert!(ratio < 24.0, "{few:?} for an eighth, {many:?} for all");
    // On screen they are one lump of bulk.
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    let moved: Vec<_> = crowd
        .iter()
        .map(|p| p - 0.5 * RADIUS + vec3(0.0, 0.0, -5.0))
        .collect();
    pour(&mut app, fluid(&moved, RADIUS, kernel));
    assert_sound(&app);
    assert_eq!(report(&mut app).bulk(), 100_000);
    assert!(report(&mut app).times().total > Duration::ZERO);
    let layers = read(&app, Layers::bulk);
    let covered = layers.texels().filter(|&[front, _]: &[f32; 2]| front > 0.0);
    // 3 r about the middle at most: the crowd's half, the splat's offset and its own radius.
    let covered = covered.count();
    assert!((4..90).contains(&covered), "{covered} pixels");
}

#[test]
fn h37_particles_on_cell_boundaries_count_once() {
    // Cells are wider than the reach by 1e-5: on, just below and just above their sides.
    let reach = 4.0 * RADIUS;
    for side in [
        reach,
        reach * (1.0 + 1e-5),
        reach * (1.0 - 6e-8),
        0.5 * reach,
    ] {
        let mut positions = lattice(5, side, 0.0);
        positions.extend(lattice(4, side, 0.0).iter().map(|p| p - Vec3::splat(side)));
        let neighbors: Vec<_> = (0..positions.len())
            .map(|of| oracle::crowd(&positions, of, reach))
            .collect();
        for spray_threshold in [1, 2, 4, 6, 7, 8, 12, 19, 20, 27] {
            let kernel = SurfaceKernel {
                spray_threshold,
                skip_interior: false,
                ..default()
            };
            let splats = shaped(&positions, RADIUS, &kernel);
            let particles = splats.bulk + splats.spray;
            assert_eq!(particles as usize, positions.len());
            let weight = |&count: &f64| oracle::bulk_weight(count, spray_threshold);
            // Beside the reach by less than a rounding, a neighbour may count for a trifle.
            let few = neighbors.iter().map(weight).filter(|&it| it < 1.0 - 1e-3);
            let spray = splats.by_class()[2].iter();
            let spray = spray.filter(|splat| splat.scale > 1e-3 * RADIUS);
            assert_eq!(spray.count(), few.count(), "side {side}");
        }
    }
}

#[test]
fn h38_permuted_particles_give_the_same_layers() {
    let positions = particles();
    let mut order: Vec<_> = (0..positions.len()).collect();
    let mut random = Random(9);
    order.sort_by_cached_key(|_| (random.next() * 1e6) as u32);
    let permuted: Vec<_> = order.iter().map(|&i| positions[i]).collect();
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    let mut layers = |positions: &[Vec3]| {
        pour(&mut app, fluid(positions, RADIUS, SurfaceKernel::default()));
        (
            picture(&mut app),
            [Layers::bulk, Layers::spray].map(|of| read(&app, of)),
        )
    };
    let (a, a_layers) = layers(&positions);
    let (b, b_layers) = layers(&permuted);
    // Sums in another order round differently, and silhouettes with them.
    assert!(differing(&a, &b, 2) <= 4, "{} pixels", differing(&a, &b, 2));
    for (a, b) in a_layers.iter().zip(&b_layers) {
        let pairs = a.texels::<[f32; 2]>().zip(b.texels::<[f32; 2]>());
        let moved = pairs.filter(|(a, b)| {
            a.iter()
                .zip(b)
                .any(|(a, b)| (a - b).abs() > 1e-4 * a.abs().max(b.abs()))
        });
        assert!(moved.count() <= 4);
    }
}

#[test]
fn h48_particles_appear_and_vanish_every_frame() {
    let all = particles();
    let mut app = show(&view(), ScreenSpaceFluid::default(), walls);
    let empty = picture(&mut app);
    pour(&mut app, fluid(&all, RADIUS, SurfaceKernel::default()));
    let full = picture(&mut app);
    let liquid = only::<FluidParticles>(&mut app);
    let mut random = Random(6);
    for frame in 0..40 {
        // Nothing, little, all, and all three times over.
        let count = match frame % 5 {
            0 => 0,
            1 => (20.0 * random.next()) as usize,
            2 => all.len(),
            3 => 3 * all.len(),
            _ => (random.next() * all.len() as f32) as usize,
        };
        let mut particles = app.world_mut().get_mut::<FluidParticles>(liquid).unwrap();
        particles.positions.clear();
        particles.positions.extend(all.iter().cycle().take(count));
        if frame % 7 == 6 {
            particles.positions.shrink_to_fit();
        }
        step(&mut app, 1);
        let report = report(&mut app);
        assert_eq!(
            (report.bulk() + report.interior() + report.spray()) as usize,
            count
        );
        match frame % 5 {
            0 => assert!(picture(&mut app) == empty, "frame {frame}: stale particles"),
            2 => assert!(picture(&mut app) == full, "frame {frame}"),
            _ => assert_sound(&app),
        }
    }
    app.world_mut().despawn(liquid);
    step(&mut app, 1);
    assert!(picture(&mut app) == empty, "a fluid that is gone");
}

#[test]
fn h49_more_particles_than_the_devices_buffers_hold() {
    // 256 KiB hold 8192 splats.
    let settings = WgpuSettings {
        constrained_limits: Some(WgpuLimits {
            max_storage_buffer_binding_size: 1 << 18,
            ..default()
        }),
        ..default()
    };
    let view = view();
    let mut app = headless_app_with(view.size, settings, |app| {
        app.add_plugins(FluidPlugin::default());
        app.world_mut().spawn(view.camera(RAW));
    })
    .unwrap();
    settle(&mut app).unwrap();
    let positions: Vec<_> = lattice(21, 0.1, 0.3)
        .iter()
        .map(|p| p + vec3(-1.0, -1.0, -7.0))
        .collect();
    pour(&mut app, fluid(&positions, 0.05, BULK));
    assert_sound(&app);
    let splats = shaped(&positions, 0.05, &BULK);
    let drawn = ellipsoids(&view, &Transform::IDENTITY, &splats.splats[..8192]);
    assert_layers(&view, &read(&app, Layers::bulk), &drawn, 1e-4);
    for _ in 0..3 {
        let liquid = only::<FluidParticles>(&mut app);
        app.world_mut()
            .get_mut::<FluidParticles>(liquid)
            .unwrap()
            .positions[0]
            .x += 1e-5;
        step(&mut app, 1);
    }
    assert_sound(&app);
    assert_eq!(log::count("the first 8192 are drawn"), 1);
    // Fewer again: all of them.
    let few = (&positions[..500], 0.05, BULK);
    assert!(assert_drawn(&view, &mut app, few, 2e-3) > 100);
}
