//! Layers of the bulk before and after smoothing.

mod common;

use bevy::{math::DVec3, prelude::*};
use bevy_fluid::{
    Bilateral, PlaneFit, PlaneFitForm, ScreenSpaceFluid, Smoothing, SurfaceKernel, Window, render::Layers,
};
use common::*;

const FORMS: [PlaneFitForm; 3] = [
    PlaneFitForm::TotalLeastSquares,
    PlaneFitForm::DeviceDepth,
    PlaneFitForm::Separable,
];
/// Narrow, so that a plane seen at 80° fills it.
const PERSPECTIVE: View = View::new(
    96,
    Lens::Perspective {
        fov: 0.2,
        near: 0.1,
    },
);
const PARALLEL: View = View::new(
    96,
    Lens::Orthographic {
        height: 1.0,
        near: 0.0,
        far: 12.0,
    },
);

fn fitted(form: PlaneFitForm) -> ScreenSpaceFluid {
    ScreenSpaceFluid {
        smoothing: Smoothing::PlaneFit(PlaneFit {
            form,
            ..PlaneFit::DEFAULT
        }),
        ..RAW
    }
}

fn bilateral() -> ScreenSpaceFluid {
    ScreenSpaceFluid {
        smoothing: Smoothing::Bilateral(Bilateral::THESIS),
        ..RAW
    }
}

/// Front point and normal of every pixel of the bulk at least `margin` pixels from the border.
fn surface(view: &View, app: &App, margin: u32) -> Vec<(UVec2, DVec3, DVec3)> {
    let layers = read(app, Layers::bulk);
    let normals = read(app, Layers::bulk_normals);
    pixels(view.size)
        .filter(|p| p.cmpge(UVec2::splat(margin)).all() && (p + margin).cmplt(view.size).all())
        .filter_map(|pixel| {
            let [front, _] = layers.f32x2(pixel.x, pixel.y);
            let [x, y, ..] = normals.f16x4(pixel.x, pixel.y);
            (front > 0.0).then(|| {
                let point = view.unproject(View::center(pixel), front);
                (pixel, point, decode_normal([x, y]))
            })
        })
        .collect()
}

/// A disc five metres away, turned about a slanting axis, and its normal.
fn tilted(degrees: f32) -> (Vec3, Quat) {
    let axis = vec3(0.6, 0.8, 0.0);
    (Vec3::NEG_Z * 5.0, Quat::from_axis_angle(axis, degrees.to_radians()))
}

/// The largest errors on a tilted plane: depth in particle radii, normal in degrees.
fn plane_errors(view: &View, settings: ScreenSpaceFluid, degrees: f32, margin: u32) -> (f64, f64) {
    let half_width = 30.0;
    let (center, rotation) = tilted(degrees);
    let app = show(view, settings, |world| {
        world.spawn(plate(half_width, center, rotation));
    });
    let normal = (rotation * Vec3::Z).as_dvec3();
    let place = plate_transform(half_width, center, rotation);
    let ellipsoid = Ellipsoid::new(view, &place, Vec3::ZERO, 1.0);
    let surface = surface(view, &app, margin);
    assert!(surface.len() > 3000, "{}", surface.len());
    let radius = f64::from(place.scale.element_product().cbrt());
    let errors = surface.into_iter().map(|(pixel, point, got)| {
        let ray = view.ray(View::center(pixel));
        let [front, _] = ellipsoid.crossings(&ray).unwrap();
        ((point.z - ray.at(front).z).abs() / radius, angle(got, normal))
    });
    errors.fold((0.0, 0.0), |(a, b), (c, d)| (f64::max(a, c), f64::max(b, d)))
}

#[test]
fn a_plane_stays_a_plane_under_every_fit() {
    for form in FORMS {
        for view in [PERSPECTIVE, PARALLEL] {
            for degrees in [0.0, 60.0, 80.0] {
                for window in [Window::Radii(0.65), Window::Pixels] {
                    let mut settings = fitted(form);
                    settings.smoothing = Smoothing::PlaneFit(PlaneFit { form, window, ..default() });
                    let (depth, normal) = plane_errors(&view, settings, degrees, 0);
                    println!("{form:?} {:?} {degrees}° {window:?}: {depth:.1e} r, {normal:.3}°", view.lens);
                }
            }
        }
    }
}

#[test]
fn planes_have_their_normals_without_a_fit() {
    for smoothing in [Smoothing::None, Smoothing::Bilateral(Bilateral::THESIS)] {
        for view in [PERSPECTIVE, PARALLEL] {
            for degrees in [0.0, 60.0] {
            for margin in [0, 1, 2, 20] {
                let settings = ScreenSpaceFluid { smoothing, ..RAW };
                let (depth, normal) = plane_errors(&view, settings, degrees, margin);
                println!("{smoothing:?} {:?} {degrees}° margin {margin}: {depth:.1e} r, {normal:.3}°", view.lens);
            }
            }
        }
    }
}

/// All ways of smoothing.
fn all() -> impl Iterator<Item = ScreenSpaceFluid> {
    FORMS.into_iter().map(fitted).chain([bilateral()])
}

#[test]
fn a_lonely_pixel_stays() {
    // Half a pixel in radius, about the middle of one.
    let ray = PARALLEL.ray(View::center(uvec2(40, 50)));
    let center = ray.at(5.0).as_vec3();
    let layers = |settings| {
        let app = show(&PARALLEL, settings, |world| {
            world.spawn(fluid(&[center], 0.5 / 96.0, BULK));
        });
        read(&app, Layers::bulk)
    };
    let raw = layers(RAW);
    let there = raw.texels().filter(|&[front, _]: &[f32; 2]| front > 0.0);
    assert_eq!(there.count(), 1);
    for settings in all() {
        let smooth = layers(settings);
        let [a, b] = [&raw, &smooth].map(|layers| layers.f32x2(40, 50));
        println!("{:?} {a:?} {b:?}", settings.smoothing);
        assert_eq!(raw, smooth, "{:?}", settings.smoothing);
    }
}

#[test]
fn a_step_of_ten_radii_is_not_bridged() {
    // The body's radius is the larger one: that of the far disc.
    let far = plate_transform(20.0, Vec3::NEG_Z * 9.0, Quat::IDENTITY);
    let radius = far.scale.element_product().cbrt();
    let depths = [9.0 - 10.0 * radius, 9.0].map(f64::from);
    for settings in all() {
        let app = show(&PARALLEL, settings, |world| {
            world.spawn(plate(20.0, Vec3::NEG_Z * 9.0, Quat::IDENTITY));
            world.spawn(plate(0.3, vec3(0.0, 0.0, 10.0 * radius - 9.0), Quat::IDENTITY));
        });
        let near_disc = |pixel: UVec2| {
            let ray = PARALLEL.ray(View::center(pixel));
            ray.origin.truncate().length() < 0.3
        };
        for (pixel, point, _) in surface(&PARALLEL, &app, 0) {
            let wanted = depths[usize::from(!near_disc(pixel))];
            let error = (-point.z - wanted).abs() / f64::from(radius);
            // The weight of a tap across the step is exp(-25).
            assert!(error < 1e-3, "{:?}, {pixel}: {error} r", settings.smoothing);
        }
    }}
}
