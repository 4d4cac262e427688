//! The length of the way through a body: from its layers, summed up over particles, and exact.

use bevy_fluid::{
    prelude::{FluidPlugin, SurfaceKernel},
    render::LayerBlending,
};

use super::*;
use bevy_fluid::render::Layers;

fn smoke(softness: f32) -> FluidMaterial {
    FluidMaterial {
        thickness: Thickness::Accumulated { softness },
        ..FluidMaterial::SMOKE
    }
}

/// The only surface's thickness, in m.
fn thickness(app: &App) -> impl Fn(UVec2) -> f64 + use<> {
    let data = read(app, Layers::thickness);
    move |pixel| {
        let i = (pixel.y * data.size.x + pixel.x) as usize;
        f64::from(match data.format {
            bevy::render::render_resource::TextureFormat::R32Float => {
                bytemuck::pod_read_unaligned::<f32>(&data.bytes[4 * i..4 * i + 4])
            }
            _ => half::f16::from_le_bytes([data.bytes[2 * i], data.bytes[2 * i + 1]]).to_f32(),
        })
    }
}

const TURN: Quat = Quat::from_xyzw(0.2, 0.4, 0.1, 0.888_819_4);

/// What a particle holds, (2r)³, over its sphere.
const FILLED: f64 = 6.0 / core::f64::consts::PI;

#[test]
fn a_puff_is_as_thick_as_its_chords() {
    let mut app = show(&PARALLEL, TRACED, |_| {});
    for softness in [0.0, 1.0, 3.0] {
        pour(&mut app, sphere(smoke(softness)));
        let thickness = thickness(&app);
        for pixel in pixels(PARALLEL.size) {
            let Some(chord) = chord(pixel) else { continue };
            let s = f64::from(softness);
            // (1 − q²)^s along the chord, scaled so that the whole holds as much for every s.
            let wanted = FILLED * chord * (0.25 * chord * chord).powf(s) * (1.0 + 2.0 / 3.0 * s);
            let error = (thickness(pixel) - wanted).abs();
            assert!(
                error < 1e-5 * wanted.max(1.0),
                "{softness}, {pixel}: {error}"
            );
        }
    }
}

#[test]
fn gaps_between_puffs_are_empty_where_the_sum_is_asked_for() {
    let far = CENTER + vec3(0.5, 0.0, -4.0);
    let puffs = |thickness| {
        let material = FluidMaterial {
            thickness,
            ..unbent(Medium::absorbing(LinearRgba::gray(0.5), 1.0))
        };
        (FluidParticles::new(vec![CENTER, far], 1.0), SPRAY, material)
    };
    let chord_of = |center: Vec3, pixel: UVec2| {
        let ray = PARALLEL.ray(View::center(pixel));
        let sine = (center.as_dvec3() - ray.origin)
            .cross(ray.direction)
            .length();
        2.0 * (1.0 - sine * sine).max(0.0).sqrt()
    };
    let exact = |pixel| chord_of(CENTER, pixel) + chord_of(far, pixel);
    let mut app = show(&PARALLEL, TRACED, |_| {});

    pour(&mut app, puffs(Thickness::Accumulated { softness: 0.0 }));
    let summed = thickness(&app);
    pour(&mut app, puffs(Thickness::Layers));
    let transmission = read(&app, Layers::transmission);
    let layered = |pixel| -rgb(&transmission, pixel).x.log2();

    let (mut sum_error, mut layer_error, mut both) = (0.0_f64, 0.0_f64, 0);
    for pixel in pixels(PARALLEL.size) {
        let error = (summed(pixel) - FILLED * exact(pixel)).abs();
        sum_error = sum_error.max(error / FILLED);
        // From the front of the one to the back of the other, 4 m apart.
        if chord_of(CENTER, pixel) > 0.5 && chord_of(far, pixel) > 0.5 {
            both += 1;
            layer_error = layer_error.max(layered(pixel) - exact(pixel));
        }
    }
    println!("off by at most {sum_error:.1e} m summed up, {layer_error:.2} m from layers");
    assert!(both > 1000, "{both}");
    assert!(sum_error < 1e-5, "{sum_error}");
    assert!((layer_error - 3.0).abs() < 0.6, "{layer_error}");
}

#[test]
fn what_is_summed_up_is_the_particles_volume() {
    let radius = 0.08;
    let block: Vec<_> = lattice(8, 2.0 * radius, 0.2)
        .iter()
        .map(|p| p + vec3(-0.56, -0.56, -5.6))
        .chain([vec3(0.9, 0.9, -5.0), vec3(-0.9, 0.8, -4.0)])
        .collect();
    let held = block.len() as f64 * (2.0 * f64::from(radius)).powi(3);
    let mut app = show(&PARALLEL, TRACED, |_| {});
    let area = (2.2 / f64::from(PARALLEL.size.y)).powi(2);
    // Many particles lie between bulk and spray: they count once.
    let between = SurfaceKernel {
        spray_threshold: 24,
        ..SurfaceKernel::default()
    };
    for (kernel, softness) in [
        (SurfaceKernel::default(), 0.0),
        (between, 0.0),
        (SurfaceKernel::default(), 1.0),
        (SurfaceKernel::EARLIER, 2.0),
    ] {
        pour(
            &mut app,
            (
                FluidParticles::new(block.clone(), radius),
                kernel,
                smoke(softness),
            ),
        );
        let thickness = thickness(&app);
        let sum: f64 = pixels(PARALLEL.size).map(thickness).sum();
        let off = sum * area / held - 1.0;
        println!("softness {softness}: off by {off:.1e}");
        // A particle spans seven pixels, whose middles stand for their areas.
        assert!(off.abs() < 0.01, "{softness}: {off}");
    }
}

#[test]
fn a_ball_of_particles_is_as_thick_as_the_ball() {
    let radius = 0.08_f32;
    let side = 26;
    let half = (side as f32 - 1.0) * radius;
    let ball: Vec<_> = lattice(side, 2.0 * radius, 0.2)
        .iter()
        // Turned, or all rays would pass the particles of a column alike.
        .map(|p| TURN * (p - Vec3::splat(half)))
        .filter(|p| p.length() < 1.0)
        .map(|p| p + CENTER)
        .collect();
    let mut app = show(&PARALLEL, TRACED, |_| {});
    let fluid = |thickness, radius_scale| {
        let material = FluidMaterial {
            thickness,
            ..unbent(Medium::absorbing(LinearRgba::gray(0.5), 1.0))
        };
        let kernel = SurfaceKernel {
            radius_scale,
            ..default()
        };
        (FluidParticles::new(ball.clone(), radius), kernel, material)
    };
    // Mean of the error and of its size.
    let error = |thickness: &dyn Fn(UVec2) -> f64| {
        let errors: Vec<_> = pixels(PARALLEL.size)
            // The rim is as wide as a particle.
            .filter_map(|pixel| Some((pixel, chord(pixel).filter(|chord| *chord > 0.8)?)))
            .map(|(pixel, chord)| thickness(pixel) - chord)
            .collect();
        let mean = |sum: f64| sum / errors.len() as f64;
        [
            mean(errors.iter().sum()),
            mean(errors.iter().map(|e| e.abs()).sum()),
        ]
    };
    // Splats that just fill the ball leave it grainy; the wider they are the less.
    for (softness, radius_scale, grain) in [(0.0, 1.24, 0.3), (1.0, 1.24, 0.35), (1.0, 2.5, 0.2)] {
        pour(
            &mut app,
            fluid(Thickness::Accumulated { softness }, radius_scale),
        );
        let [bias, size] = error(&thickness(&app));
        println!("softness {softness}, scale {radius_scale}: {bias:.3} m off, grain {size:.3} m");
        // Splats at the surface are drawn inwards, and their volume with them.
        assert!(
            bias.abs() < 0.12 && size < grain,
            "{softness} {radius_scale}: {bias} {size}"
        );
    }
    pour(&mut app, fluid(Thickness::Layers, 1.24));
    let transmission = read(&app, Layers::transmission);
    let [bias, size] = error(&|pixel| -rgb(&transmission, pixel).x.log2());
    println!("layers: {bias:.3} m off, grain {size:.3} m");
    assert!(size < 0.3, "{size}");
}

#[test]
fn an_opaque_thing_cuts_the_sum() {
    let app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(smoke(0.0)));
        let wall = Transform::from_translation(CENTER - 0.55 * Vec3::Z);
        spawn_box(world, vec3(0.8, 0.8, 0.1), wall);
    });
    let thickness = thickness(&app);
    let axis = PARALLEL.size / 2;
    // Half a metre behind the centre, which is a metre behind the front.
    assert!((thickness(axis) / FILLED - 1.5).abs() < 1e-3);
    let beside = axis + uvec2(30, 0);
    let whole = FILLED * chord(beside).unwrap();
    assert!((thickness(beside) - whole).abs() < 1e-3);
}

#[test]
fn from_the_middle_of_a_puff_half_of_it_is_passed() {
    let app = show(&PARALLEL, TRACED, |world| {
        let around = FluidParticles::new(vec![Vec3::ZERO], 1.0);
        world.spawn((around, SPRAY, smoke(0.0)));
    });
    let thickness = thickness(&app);
    let axis = PARALLEL.size / 2;
    assert!(
        (thickness(axis) / FILLED - 1.0).abs() < 1e-3,
        "{}",
        thickness(axis)
    );
}

#[test]
fn sums_in_halves_are_nearly_as_good() {
    let plugin = FluidPlugin {
        layer_blending: LayerBlending::DepthDraws,
        ..default()
    };
    let block: Vec<_> = lattice(10, 0.16, 0.2)
        .iter()
        .map(|p| TURN * (p - 0.72) + CENTER)
        .collect();
    let [halves, floats] = [plugin, FluidPlugin::default()].map(|plugin| {
        let app = show_with(plugin, &PARALLEL, TRACED, |world| {
            let fluid = FluidParticles::new(block.clone(), 0.08);
            world.spawn((fluid, SurfaceKernel::default(), smoke(1.0)));
        });
        let thickness = thickness(&app);
        pixels(PARALLEL.size).map(thickness).collect::<Vec<_>>()
    });
    let worst = halves.iter().zip(&floats).map(|(a, b)| (a - b).abs());
    let worst = worst.fold(0.0, f64::max);
    // Some forty sums of up to 2 m, each cut off to a multiple of 0.001 m.
    assert!(worst > 0.0 && worst < 0.04, "{worst}");
}
