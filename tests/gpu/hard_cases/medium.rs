//! h50: absorption from none to all, over no way and a long one. The GPU's form is held against
//! the same f64 in `render::shader_tests`.

use bevy::prelude::*;
use bevy_fluid::{prelude::*, render::Layers, settings::Refractions};

use super::*;

const EXTINCTIONS: [f32; 6] = [0.0, 1e-9, 1e-6, 1e-3, 1.0, 1e3];
const DISTANCES: [f32; 4] = [0.0, 1e-6, 1.0, 1e6];

fn medium(extinction: f32) -> Medium {
    Medium {
        absorption_density: extinction,
        absorption_color: LinearRgba::BLACK,
        ..Medium::CLEAR
    }
}

#[test]
fn h50_the_medium_equals_f64() {
    for extinction in EXTINCTIONS {
        assert_eq!(medium(extinction).extinction(), Vec3::splat(extinction));
        for distance in DISTANCES {
            let exact = (-f64::from(extinction) * f64::from(distance)).exp();
            let left = medium(extinction).transmitted(distance);
            let error = (left.as_dvec3() - exact).abs().max_element();
            assert!(
                error < 1e-6,
                "B = {extinction}, d = {distance}: {left}, not {exact}"
            );
        }
    }
    // On screen, through spheres as thick as the distances.
    for distance in &DISTANCES[1..] {
        let view = View {
            pose: Transform::from_xyz(0.0, 0.0, *distance),
            ..View::new(
                16,
                Lens::Orthographic {
                    height: 0.1 * distance,
                    near: 0.0,
                    far: 3.0 * distance,
                },
            )
        };
        let settings = ScreenSpaceFluid {
            refractions: Refractions::Zero,
            ..RAW
        };
        let mut app = show(&view, settings, |_| {});
        for extinction in EXTINCTIONS {
            let material = FluidMaterial {
                refractive_index: 1.0,
                medium: medium(extinction),
                ..default()
            };
            let sphere = FluidParticles::new(vec![Vec3::ZERO], 0.5 * distance);
            pour(&mut app, (sphere, SPRAY, material));
            assert_sound(&app);
            let transmission = read(&app, Layers::transmission);
            for pixel in pixels(view.size) {
                let ray = view.ray(View::center(pixel));
                let across = ray.origin.truncate().length() / (0.5 * f64::from(*distance));
                let chord = f64::from(*distance) * (1.0 - across * across).sqrt();
                let wanted = (-f64::from(extinction) * chord).exp();
                let [left, ..] = transmission.f16x4(pixel.x, pixel.y);
                // f16 holds it with 11 bits.
                let error = (f64::from(left) - wanted).abs();
                assert!(
                    error < 5e-4,
                    "B = {extinction}, d = {distance}: {left}, not {wanted}"
                );
            }
        }
    }
}
