//! Rays through the layers, held against Snell, Fresnel and Beer–Lambert in f64.

mod light;

use crate::common::*;
use bevy::{math::DVec3, prelude::*};
use bevy_fluid::{
    prelude::*,
    render::{Layers, SearchStatus},
    settings::{Refractions, Search},
};
use fluid_stage::TextureData;

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
            ..Medium::CLEAR
        },
        ..clear(index)
    }
}

/// What is left of light after so many metres of it.
fn kept(path: f64) -> DVec3 {
    DVec3::from(EXTINCTION.map(|b| (-b * path).exp()))
}

fn refracted_angle(sine: f64) -> f64 {
    (sine / INDEX).asin()
}

/// Reflectance for unpolarised light, from the angles on both sides.
fn exact(incident: f64, refracted: f64) -> f64 {
    let [ci, ct] = [incident.cos(), refracted.cos()];
    let s = (ci - INDEX * ct) / (ci + INDEX * ct);
    let p = (INDEX * ci - ct) / (INDEX * ci + ct);
    0.5 * (s * s + p * p)
}

/// The same light from everywhere.
fn surround(app: &mut App, color: Color) {
    let camera = only::<Camera3d>(app);
    let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
    camera.clear_color = ClearColorConfig::Custom(color);
    settle(app).unwrap();
}

fn rgb(light: &TextureData, pixel: UVec2) -> DVec3 {
    let [r, g, b, _] = light.f16x4(pixel.x, pixel.y).map(f64::from);
    DVec3::new(r, g, b)
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

fn sphere(kernel: SurfaceKernel, material: FluidMaterial) -> impl Bundle {
    (FluidParticles::new(vec![CENTER], 1.0), kernel, material)
}

/// A front and a back plate, each at a depth on the axis and turned about y (radians).
fn slab(app: &mut App, [front, back]: [(f32, f32); 2]) {
    let [front, back] = [front, back]
        .map(|(depth, turn)| plate(20.0, Vec3::NEG_Z * depth, Quat::from_rotation_y(turn)));
    pour(app, front);
    app.world_mut().spawn(back);
    settle(app).unwrap();
}

/// The normal of a plate turned about y, towards the viewer.
fn plate_normal(turn: f32) -> DVec3 {
    Quat::from_rotation_y(turn).mul_vec3(Vec3::Z).as_dvec3()
}

/// Rays that leave the liquid on screen, some pixels from the border, where depth has a slope.
fn on_screen(view: &View, exit: &Exit) -> bool {
    let [w, h] = view.half_extent_at(-exit.position.z).to_array();
    exit.searches[0] == SearchStatus::Hit
        && exit.position.x.abs() < 0.95 * w
        && exit.position.y.abs() < 0.95 * h
}

#[test]
fn a_slab_shifts_rays_and_leaves_their_direction() {
    let thickness = 0.5;
    for (view, tilts) in [
        (PARALLEL, [0.0, 30.0, 60.0]),
        (PERSPECTIVE, [0.0, 30.0, 50.0]),
    ] {
        let mut app = show(&view, TRACED, |_| {});
        for turn in tilts.map(f32::to_radians) {
            slab(
                &mut app,
                [(5.0, turn), (5.0 + thickness / turn.cos(), turn)],
            );
            let mut seen = 0;
            for (pixel, ray, exit) in exits(&view, &app) {
                if !on_screen(&view, &exit) {
                    continue;
                }
                seen += 1;
                let incident = angle(-ray.direction, plate_normal(turn)).to_radians();
                let refracted = refracted_angle(incident.sin());
                let wanted = f64::from(thickness) * (incident - refracted).sin() / refracted.cos();
                let shift = (exit.position - ray.origin).cross(ray.direction).length();
                // Directions and normals have 16 bits and less. The search may stop half a
                // pixel (0.009 m) before the surface, which moves the ray by a third of that.
                let bent = angle(exit.direction, ray.direction);
                assert!(bent < 0.1, "{pixel}, turned {turn}: {bent}°");
                assert!(
                    (shift - wanted).abs() < 3e-3,
                    "{pixel}: {shift} m, not {wanted}"
                );
            }
            assert!(seen > 10_000, "{seen}");
        }
    }
}

#[test]
fn a_prism_bends_rays_up_to_the_critical_angle() {
    // 48.6°.
    let critical = (1.0 / INDEX).asin();
    let mut app = show(&PARALLEL, TRACED, |_| {});
    for degrees in [20.0_f32, 40.0, 47.0, 51.0, 65.0] {
        let turn = degrees.to_radians();
        // Rays pass the front at right angles and meet the back at its own.
        slab(&mut app, [(1.0, 0.0), (5.0, turn)]);
        let mut totally = 0;
        for (pixel, ray, exit) in exits(&PARALLEL, &app) {
            if f64::from(turn) > critical {
                // Only rays too near the border to find the surface may miss it.
                totally += usize::from(exit.searches[0] == SearchStatus::TotalReflection);
                continue;
            }
            if on_screen(&PARALLEL, &exit) {
                let out = (INDEX * f64::from(turn).sin()).asin().to_degrees();
                let bent = angle(exit.direction, ray.direction);
                // n cos / cos out turns the normal's error: 6 times just below the critical angle.
                let wanted = out - f64::from(degrees);
                assert!(
                    (bent - wanted).abs() < 0.2,
                    "{pixel}: {bent}°, not {wanted}°"
                );
            }
        }
        if f64::from(turn) > critical {
            assert!(totally > 15_000, "{degrees}°: {totally} totally reflected");
        }
    }
}

/// A cube on its edge: light enters at 45°, is totally reflected by the face beside (at 58°), and leaves
/// through the one opposite, square to how it came.
#[test]
fn after_a_total_reflection_the_next_face_is_found() {
    let (size, radius) = (24, 0.025);
    let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_4);
    let cube: Vec<_> = lattice(size, 2.0 * radius, 0.0)
        .into_iter()
        .map(|p| CENTER + turn * (p - radius * (size as f32 - 1.0)))
        .collect();
    let app = show(&PARALLEL, ScreenSpaceFluid::DEFAULT, |world| {
        world.spawn(fluid(&cube, radius, SurfaceKernel::DEFAULT));
    });
    let exits = exits(&PARALLEL, &app).into_iter();
    let reflected = exits.filter(|(.., exit)| exit.searches[0] == SearchStatus::TotalReflection);
    let turned: Vec<_> = reflected
        .map(|(_, ray, exit)| angle(exit.direction, ray.direction))
        .collect();
    let right = turned.iter().filter(|it| (*it - 90.0).abs() < 10.0).count();
    assert!(
        turned.len() > 1000 && 10 * right > 9 * turned.len(),
        "{right} of {}",
        turned.len()
    );
}

#[test]
fn a_sphere_turns_rays_twice() {
    for view in [PARALLEL, PERSPECTIVE] {
        let app = show(&view, TRACED, |world| {
            world.spawn(sphere(SPRAY, clear(INDEX)));
        });
        for (pixel, ray, exit) in exits(&view, &app) {
            let sine = sphere_sine(&ray);
            if sine > 0.9 {
                continue;
            }
            let wanted = 2.0 * (sine.asin() - refracted_angle(sine)).to_degrees();
            let bent = angle(exit.direction, ray.direction);
            // The search stops within a fiftieth of the radius; out here that is most of a degree
            // of the sphere, of which the exit direction takes a part.
            assert!(
                (bent - wanted).abs() < 0.5,
                "{pixel}, sine {sine}: {bent}°, not {wanted}°"
            );
            assert_eq!((exit.searches[0], exit.interfaces), (SearchStatus::Hit, 2));
        }
    }
}

#[test]
fn index_one_bends_nothing_and_absorbs_along_the_chord() {
    for view in [PARALLEL, PERSPECTIVE] {
        for kernel in [SPRAY, BULK] {
            let mut app = show(&view, TRACED, |world| {
                world.spawn(sphere(kernel, tinted(1.0)));
            });
            surround(&mut app, Color::WHITE);
            let radiance = read(&app, Layers::radiance);
            let transmission = read(&app, Layers::transmission);
            for (pixel, ray, exit) in exits(&view, &app) {
                assert!(exit.direct && exit.interfaces == 0, "{pixel}");
                // 16 bits a direction: 0.002°.
                assert!(angle(exit.direction, ray.direction) < 0.01, "{pixel}");
                assert_eq!(rgb(&radiance, pixel), DVec3::ZERO, "{pixel}");
                let sine = sphere_sine(&ray);
                // Beyond it the chord's f32 depths differ in their last digits only.
                if sine < 0.999 {
                    let wanted = kept(2.0 * (1.0 - sine * sine).sqrt());
                    let error = (rgb(&transmission, pixel) - wanted).abs().max_element();
                    assert!(error < 2.0 * HALF, "{pixel}: {error}");
                }
            }
        }
    }
}

#[test]
fn the_budget_limits_the_interfaces() {
    let mut app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(BULK, clear(INDEX)));
        let behind = vec3(0.0, 0.0, -8.0);
        world.spawn(fluid(&[behind], 1.0, SPRAY));
    });
    let normal_reflectance = exact(0.0, 0.0);
    for (refractions, count) in [
        (Refractions::Zero, 0),
        (Refractions::One, 1),
        (Refractions::Two, 2),
        (Refractions::Four, 4),
    ] {
        look(
            &mut app,
            ScreenSpaceFluid {
                refractions,
                ..TRACED
            },
        );
        for (pixel, _, exit) in exits(&PARALLEL, &app) {
            assert!(exit.interfaces <= count, "{pixel}: {}", exit.interfaces);
        }
        // Next to the axis rays go straight through both.
        let axis = PARALLEL.size / 2;
        let exit = Exit::at(&PARALLEL, &read(&app, Layers::exits), axis.x, axis.y).unwrap();
        assert_eq!(exit.interfaces, count);
        assert!(!exit.spray_first);
        let passed = rgb(&read(&app, Layers::transmission), axis).x;
        let wanted = (1.0 - normal_reflectance).powi(count.max(1) as i32);
        assert!(
            (passed - wanted).abs() < 2.0 * HALF,
            "{count}: {passed}, not {wanted}"
        );
        if count == 4 {
            assert_eq!(exit.searches[..3], [SearchStatus::Hit; 3]);
            let depth = -exit.position.z;
            assert!(
                (depth - 9.0).abs() < 0.03,
                "leaves the second sphere at {depth} m"
            );
        }
    }
}

#[test]
fn both_searches_find_the_same_surface() {
    let mut app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(SPRAY, clear(INDEX)));
    });
    let coarse = Search::Bracketed { coarse_samples: 8 };
    let [bracketed, secant, coarse] = [Search::BRACKETED, Search::Secant, coarse].map(|search| {
        look(&mut app, ScreenSpaceFluid { search, ..TRACED });
        exits(&PARALLEL, &app)
    });
    for other in [secant, coarse] {
        let mut hits = 0;
        for ((pixel, ray, a), (_, _, b)) in bracketed.iter().zip(&other) {
            if sphere_sine(ray) > 0.9 || b.searches[0] != SearchStatus::Hit {
                continue;
            }
            hits += 1;
            // Each may stop a fiftieth of the radius before or behind the surface.
            let apart = a.position.distance(b.position);
            assert!(apart < 0.05, "{pixel}: {apart} m apart");
            let turned = angle(a.direction, b.direction);
            assert!(turned < 1.5, "{pixel}: {turned}° apart");
        }
        // The secant fails for some 4 % of all rays.
        assert!(hits > 7500, "{hits} of {}", bracketed.len());
    }
}

#[test]
fn an_opaque_thing_in_the_liquid_ends_the_path() {
    let mut app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(SPRAY, tinted(INDEX)));
        spawn_box(world, Vec3::splat(0.3), Transform::from_translation(CENTER));
    });
    surround(&mut app, Color::WHITE);
    let axis = PARALLEL.size / 2;
    let exit = Exit::at(&PARALLEL, &read(&app, Layers::exits), axis.x, axis.y).unwrap();
    assert_eq!(exit.searches[0], SearchStatus::Opaque);
    assert!(exit.direct && exit.interfaces == 1);
    // The sphere's front is 4 m away, that of the box 4.85 m. The search stops within 0.02 m.
    assert!((-exit.position.z - 4.85).abs() < 0.02, "{}", exit.position);
    let passed = rgb(&read(&app, Layers::transmission), axis);
    let wanted = (1.0 - exact(0.0, 0.0)) * kept(0.85);
    assert!(
        (passed - wanted).abs().max_element() < 0.02,
        "{passed}, not {wanted}"
    );
    // Rays that pass the box on their bent way go on.
    let beside = axis + uvec2(30, 0);
    let exit = Exit::at(&PARALLEL, &read(&app, Layers::exits), beside.x, beside.y).unwrap();
    assert_eq!((exit.searches[0], exit.interfaces), (SearchStatus::Hit, 2));
}

#[test]
fn from_the_middle_of_a_sphere_rays_leave_unbent() {
    let app = show(&PERSPECTIVE, TRACED, |world| {
        world.spawn(fluid(&[Vec3::ZERO], 1.0, SPRAY));
    });
    let transmission = read(&app, Layers::transmission);
    let exits = exits(&PERSPECTIVE, &app);
    assert_eq!(exits.len() as u32, PERSPECTIVE.size.element_product());
    for (pixel, ray, exit) in exits {
        assert_eq!(
            (exit.interfaces, exit.searches[0]),
            (1, SearchStatus::Hit),
            "{pixel}"
        );
        // A normal of two halves is off by up to 0.05°, and so is the ray, by a third of it.
        let bent = angle(exit.direction, ray.direction);
        assert!(bent < 0.05, "{pixel}: {bent}°");
        let passed = rgb(&transmission, pixel).x;
        let wanted = 1.0 - exact(0.0, 0.0);
        assert!((passed - wanted).abs() < 2.0 * HALF, "{pixel}: {passed}");
    }
}
