//! Rays through the layers, held against Snell, Fresnel and Beer–Lambert in f64.

mod common;

use bevy::{math::DVec3, prelude::*};
use bevy_fluid::{
    Fresnel, Medium, Refractions, ScreenSpaceFluid, Search,
    prelude::*,
    render::{Layers, SearchStatus},
};
use common::*;

/// Two metres square; depth 10 m.
const PARALLEL: View = View::new(
    128,
    Lens::Orthographic {
        height: 2.2,
        near: 0.0,
        far: 10.0,
    },
);
const PERSPECTIVE: View = View::new(
    128,
    Lens::Perspective {
        fov: 0.45,
        near: 0.1,
    },
);
const TRACED: ScreenSpaceFluid = ScreenSpaceFluid {
    refractions: Refractions::Four,
    ..RAW
};
const INDEX: f64 = 1.333;
/// f16 has 11 bits: half a unit in the last place of a number below 1.
const HALF: f64 = 2.5e-4;

fn clear(index: f64) -> FluidMaterial {
    FluidMaterial {
        refractive_index: index as f32,
        ..FluidMaterial::CLEAR_WATER
    }
}

/// Extinction per channel, in 1/m.
const EXTINCTION: [f64; 3] = [1.0, 0.5, 0.0];

fn tinted(index: f64) -> FluidMaterial {
    FluidMaterial {
        medium: Medium {
            absorption_density: 1.0,
            absorption_color: LinearRgba::rgb(0.0, 0.5, 1.0),
        },
        ..clear(index)
    }
}

fn refracted_angle(sin: f64, index: f64) -> f64 {
    (sin / index).asin()
}

/// Reflectance of a dielectric for unpolarised light, from the angles on both sides.
fn fresnel(incident: f64, refracted: f64) -> f64 {
    let [ci, ct] = [incident.cos(), refracted.cos()];
    let s = (ci - INDEX * ct) / (ci + INDEX * ct);
    let p = (INDEX * ci - ct) / (INDEX * ci + ct);
    0.5 * (s * s + p * p)
}

/// White all around.
fn white() -> Camera {
    Camera {
        clear_color: ClearColorConfig::Custom(Color::WHITE),
        ..default()
    }
}

/// Radiance and transmission of a pixel, red, green, blue.
fn light(app: &App, pixel: UVec2) -> [DVec3; 2] {
    [Layers::radiance, Layers::transmission].map(|pick| {
        let [r, g, b, _] = read(app, pick).f16x4(pixel.x, pixel.y);
        Vec3::new(r, g, b).as_dvec3()
    })
}

/// The exit rays of all pixels, with their entry rays.
fn exits(view: &View, app: &App) -> Vec<(UVec2, Ray, Exit)> {
    let texels = read(app, Layers::exits);
    pixels(view.size)
        .filter_map(|pixel| {
            let exit = Exit::at(view, &texels, pixel.x, pixel.y)?;
            Some((pixel, view.ray(View::center(pixel)), exit))
        })
        .collect()
}

/// A sphere of 1 m, 5 m away, and the sine of the angle at which a ray meets it.
const CENTER: Vec3 = Vec3::new(0.0, 0.0, -5.0);

fn sphere_sine(ray: &Ray) -> f64 {
    let to_center = CENTER.as_dvec3() - ray.origin;
    to_center.cross(ray.direction).length()
}

fn sphere(kernel: bevy_fluid::SurfaceKernel, material: FluidMaterial) -> impl Bundle {
    (FluidParticles::new(vec![CENTER], 1.0), kernel, material)
}

/// Two plates, `turned` about y, so far apart along z that the first is in front everywhere.
fn slab(app: &mut App, turned: [f32; 2], front: f32, back: f32) {
    pour(
        app,
        plate(20.0, Vec3::Z * front, Quat::from_rotation_y(turned[0])),
    );
    app.world_mut().spawn(plate(
        20.0,
        Vec3::Z * back,
        Quat::from_rotation_y(turned[1]),
    ));
    settle(app).unwrap();
}

#[test]
fn a_slab_shifts_rays_and_leaves_their_direction() {
    for (view, tilts) in [
        (PARALLEL, [0.0, 30.0, 60.0]),
        (PERSPECTIVE, [0.0, 30.0, 50.0]),
    ] {
        let mut app = show(&view, TRACED, |_| {});
        for tilt in tilts {
            let turn = f32::to_radians(tilt);
            let apart = 0.5;
            let back = -5.0 - apart / turn.cos();
            slab(&mut app, [turn, turn], -5.0, back);
            let normal = Quat::from_rotation_y(turn).mul_vec3(Vec3::Z).as_dvec3();
            let mut worst = [0.0_f64; 2];
            let mut seen = 0;
            for (pixel, ray, exit) in exits(&view, &app) {
                // Near the border rays leave the screen inside the slab.
                if exit.searches[0] != SearchStatus::Hit {
                    continue;
                }
                seen += 1;
                let incident = angle(-ray.direction, normal).to_radians();
                let refracted = refracted_angle(incident.sin(), INDEX);
                let wanted = f64::from(apart) * (incident - refracted).sin() / refracted.cos();
                let moved = exit.position - ray.origin;
                let shift = moved.cross(ray.direction).length();
                if pixel.y == 64 && pixel.x % 8 == 3 && tilt == 30.0 {
                    println!("{pixel} {exit:?} {}", (shift - wanted));
                }
                worst[0] = worst[0].max(angle(exit.direction, ray.direction));
                worst[1] = worst[1].max((shift - wanted).abs());
            }
            println!(
                "tilt {tilt}: {seen} seen, direction {}°, shift {} m",
                worst[0], worst[1]
            );
            assert!(seen > 8000, "{seen}");
        }
    }
}

#[test]
fn a_sphere_turns_rays_twice() {
    for view in [PARALLEL, PERSPECTIVE] {
        for kernel in [SPRAY, BULK] {
            let app = show(&view, TRACED, |world| {
                world.spawn(sphere(kernel, clear(INDEX)));
            });
            let mut worst = [0.0_f64; 10];
            for (_, ray, exit) in exits(&view, &app) {
                let sine = sphere_sine(&ray);
                if sine > 0.9 {
                    continue;
                }
                let turn = 2.0 * (sine.asin() - refracted_angle(sine, INDEX)).to_degrees();
                let error = (angle(exit.direction, ray.direction) - turn).abs();
                let w = &mut worst[(sine * 10.0) as usize];
                *w = w.max(error);
                if exit.searches[0] != SearchStatus::Hit || exit.interfaces != 2 {
                    println!("{sine} {:?}", exit.searches[0]);
                }
            }
            println!("{worst:.3?}");
        }
    }
}
