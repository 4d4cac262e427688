//! Layers of the bulk before and after smoothing.

use crate::common::*;
use bevy::{math::DVec3, prelude::*};
use bevy_fluid::{
    prelude::{ScreenSpaceFluid, SurfaceKernel},
    render::Layers,
    settings::{Bilateral, PlaneFit, PlaneFitForm, Smoothing, Window},
};

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
pub(super) fn surface(view: &View, app: &App, margin: u32) -> Vec<(UVec2, DVec3, DVec3)> {
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
    (
        Vec3::NEG_Z * 5.0,
        Quat::from_axis_angle(axis, degrees.to_radians()),
    )
}

/// The largest errors on a tilted plane: depth in particle radii, normal in degrees.
fn plane_errors(view: &View, app: &mut App, degrees: f32) -> (f64, f64) {
    let half_width = 30.0;
    let (center, rotation) = tilted(degrees);
    let place = plate_transform(half_width, center, rotation);
    pour(app, plate(half_width, center, rotation));
    let normal = (rotation * Vec3::Z).as_dvec3();
    let ellipsoid = Ellipsoid::new(view, &place, Vec3::ZERO, 1.0);
    let radius = f64::from(place.scale.element_product().cbrt());
    let surface = surface(view, app, 0);
    assert_eq!(surface.len() as u32, view.size.element_product());
    let errors = surface.into_iter().map(|(pixel, point, got)| {
        let ray = view.ray(View::center(pixel));
        let [front, _] = ellipsoid.crossings(&ray).unwrap();
        let depth = (point.z - ray.at(front).z).abs();
        (depth / radius, angle(got, normal))
    });
    errors.fold((0.0, 0.0), |(a, b), (c, d)| {
        (f64::max(a, c), f64::max(b, d))
    })
}

/// At every pixel, the border's as well: depth to 1e-3 r (f32 gives 2e-5), and normals to what
/// the 11 bits of their two halves hold (0.033°).
fn assert_plane(settings: ScreenSpaceFluid, tilts: &[f32]) {
    let mut app = show(&PERSPECTIVE, settings, |_| {});
    for view in [PERSPECTIVE, PARALLEL] {
        look(&mut app, view.projection());
        for &degrees in tilts {
            let (depth, normal) = plane_errors(&view, &mut app, degrees);
            assert!(
                depth < 1e-3 && normal < 0.1,
                "{:?}, {:?}, {degrees}°: {depth} r, {normal}°",
                settings.smoothing,
                view.lens
            );
        }
    }
}

#[test]
fn a_plane_stays_a_plane_under_every_fit() {
    for form in FORMS {
        assert_plane(fitted(form), &[0.0, 60.0, 80.0]);
    }
}

#[test]
fn a_window_in_pixels_fits_planes_as_well() {
    let settings = ScreenSpaceFluid {
        smoothing: Smoothing::PlaneFit(PlaneFit::THESIS),
        ..RAW
    };
    assert_plane(settings, &[60.0]);
}

#[test]
fn without_smoothing_layers_are_the_splats_and_normals_come_from_depth() {
    assert_plane(RAW, &[0.0, 60.0, 80.0]);
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
        assert_eq!(raw, layers(settings), "{:?}", settings.smoothing);
    }
}

#[test]
fn a_step_of_ten_radii_is_not_bridged() {
    // The body's radius is the larger one: that of the far disc.
    let far = plate_transform(20.0, Vec3::NEG_Z * 9.0, Quat::IDENTITY);
    let radius = far.scale.element_product().cbrt();
    let depths = [9.0 - 10.0 * radius, 9.0].map(f64::from);
    for settings in all() {
        // The weight of a tap across the step is exp(-25) for the fits. That of the published
        // bilateral filter is exp(-6.25), which adds up over its 22 iterations.
        let tolerance = match settings.smoothing {
            Smoothing::Bilateral(_) => 0.1,
            _ => 1e-3,
        };
        let app = show(&PARALLEL, settings, |world| {
            world.spawn(plate(20.0, Vec3::NEG_Z * 9.0, Quat::IDENTITY));
            world.spawn(plate(
                0.3,
                vec3(0.0, 0.0, 10.0 * radius - 9.0),
                Quat::IDENTITY,
            ));
        });
        let near_disc = |pixel: UVec2| {
            let ray = PARALLEL.ray(View::center(pixel));
            ray.origin.truncate().length() < 0.3
        };
        for (pixel, point, _) in surface(&PARALLEL, &app, 0) {
            let wanted = depths[usize::from(!near_disc(pixel))];
            let error = (-point.z - wanted).abs() / f64::from(radius);
            assert!(
                error < tolerance,
                "{:?}, {pixel}: {error} r",
                settings.smoothing
            );
        }
    }
}

/// A slab of overlapping spheres, each a tenth of the spacing off its place, turned about y.
fn bumpy_slab(radius: f32, rotation: Quat) -> impl Bundle {
    let mut random = Random(3);
    let cells = (0..60 * 24 * 3).map(|i| uvec3(i % 60, i / 60 % 24, i / 60 / 24));
    let positions: Vec<_> = cells
        .map(|cell| {
            let jitter = 0.1 * (2.0 * random.point() - 1.0);
            let place = cell.as_vec3() - vec3(29.5, 11.5, 1.0) + jitter;
            Vec3::NEG_Z * 5.0 + rotation * (2.0 * radius * place)
        })
        .collect();
    fluid(&positions, 1.5 * radius, BULK)
}

/// Roughness (RMS distance from the mean plane, in m) and the normals' median error in degrees.
fn bumpiness(view: &View, app: &App, normal: DVec3) -> (f64, f64) {
    let surface = surface(view, app, 8);
    assert!(surface.len() > 10_000);
    let heights = surface.iter().map(|(_, point, _)| point.dot(normal));
    let mean = heights.clone().sum::<f64>() / surface.len() as f64;
    let variance = heights.map(|h| (h - mean).powi(2)).sum::<f64>() / surface.len() as f64;
    let mut errors: Vec<_> = surface.iter().map(|(.., n)| angle(*n, normal)).collect();
    errors.sort_by(f64::total_cmp);
    (variance.sqrt(), errors[errors.len() / 2])
}

#[test]
fn bumps_are_smoothed_away() {
    let view = View::new(128, PARALLEL.lens);
    let mut app = show(&view, RAW, |_| {});
    for degrees in [0.0_f32, 60.0] {
        let rotation = Quat::from_rotation_y(degrees.to_radians());
        let normal = (rotation * Vec3::Z).as_dvec3();
        // 6.4 pixels a radius.
        pour(&mut app, bumpy_slab(0.05, rotation));
        look(&mut app, RAW);
        let (raw, raw_normal) = bumpiness(&view, &app, normal);
        assert!(raw_normal > 20.0, "{raw_normal}°");
        for settings in all() {
            look(&mut app, settings);
            let (smooth, error) = bumpiness(&view, &app, normal);
            assert!(
                smooth < 0.5 * raw && error < 4.0,
                "{degrees}°, {:?}: {raw} m to {smooth} m, {raw_normal}° to {error}°",
                settings.smoothing
            );
        }
    }
}

/// The second fit takes the slope from twice the window where the surface is flat. That is better than
/// one fit to twice the window, too.
#[test]
fn a_flat_surface_is_smoothed_over_twice_the_window() {
    let view = View::new(128, PARALLEL.lens);
    let mut app = show(&view, RAW, |_| {});
    pour(&mut app, bumpy_slab(0.05, Quat::IDENTITY));
    let mut error = |iterations, window| {
        let smoothing = Smoothing::PlaneFit(PlaneFit {
            iterations,
            window: Window::Radii(window),
            ..PlaneFit::DEFAULT
        });
        look(&mut app, ScreenSpaceFluid { smoothing, ..RAW });
        bumpiness(&view, &app, DVec3::Z).1
    };
    let [twice, once, wide] = [error(2, 1.7), error(1, 1.7), error(1, 3.4)];
    println!("{twice}° {once}° {wide}°");
    assert!(
        twice < 0.45 * once && twice < wide,
        "{twice}° {once}° {wide}°"
    );
}

/// Errors of the normals of a block of liquid, by the face that they lie on. Unit: degrees.
fn errors_on_faces(view: &View, app: &App, rotation: Quat) -> Vec<f64> {
    let to_block = rotation.inverse().as_dquat();
    let mut errors: Vec<_> = surface(view, app, 0)
        .into_iter()
        .map(|(_, point, normal)| {
            let point = to_block * (point - DVec3::NEG_Z * 5.0);
            let face = point.abs().max_position();
            let axis = DVec3::AXES[face] * point[face].signum();
            angle(to_block * normal, axis)
        })
        .collect();
    assert!(errors.len() > 2000);
    errors.sort_by(f64::total_cmp);
    errors
}

/// A block seen over its corner: three faces, three edges, and a silhouette around them.
#[test]
fn windows_do_not_reach_around_an_edge() {
    let view = View::new(128, PARALLEL.lens);
    let rotation = Quat::from_euler(EulerRot::XYZ, 0.5, 0.7, 0.0);
    let radius = 0.025;
    let places = lattice(12, 2.0 * radius, 0.05).into_iter();
    let middle = Vec3::splat(11.0 * radius);
    let block: Vec<_> = places
        .map(|place| Vec3::NEG_Z * 5.0 + rotation * (place - middle))
        .collect();
    let app = show(&view, fitted(PlaneFitForm::Separable), |world| {
        world.spawn(fluid(&block, radius, SurfaceKernel::default()));
    });
    let errors = errors_on_faces(&view, &app, rotation);
    let [median, most] = [0.5, 0.9].map(|part| errors[(part * errors.len() as f64) as usize]);
    println!("{median}° {most}°");
    assert!(median < 1.5 && most < 10.0, "{median}° {most}°");
}

/// The peers smooth too, each in its way: narrow range and curvature flow the depth and with it
/// the normals, the average the normals alone. How well is for the measurements to say.
#[test]
fn the_peers_halve_the_normals_error() {
    let view = View::new(128, PARALLEL.lens);
    let mut app = show(&view, RAW, |_| {});
    pour(&mut app, bumpy_slab(0.05, Quat::IDENTITY));
    look(&mut app, RAW);
    let (raw, raw_normal) = bumpiness(&view, &app, DVec3::Z);
    for (smoothing, moves_depth) in [
        (Smoothing::NormalAverage(default()), false),
        (Smoothing::NarrowRange(default()), true),
        (Smoothing::CurvatureFlow(default()), true),
    ] {
        look(&mut app, ScreenSpaceFluid { smoothing, ..RAW });
        let (smooth, error) = bumpiness(&view, &app, DVec3::Z);
        assert!(
            error < 0.5 * raw_normal,
            "{smoothing:?}: {raw_normal}° to {error}°"
        );
        if moves_depth {
            assert!(smooth < 0.5 * raw, "{smoothing:?}: {raw} m to {smooth} m");
        } else {
            assert_eq!(smooth, raw);
        }
    }
}
