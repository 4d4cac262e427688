//! h40, h42 and h46: cameras that are not the usual ones.

use bevy::{camera::CameraProjection, math::DVec3, prelude::*};
use bevy_fluid::{
    prelude::*,
    render::Layers,
    settings::{PlaneFit, PlaneFitForm, Refractions, Smoothing},
};

use super::*;

const FORMS: [PlaneFitForm; 3] = [
    PlaneFitForm::TotalLeastSquares,
    PlaneFitForm::DeviceDepth,
    PlaneFitForm::Separable,
];

fn fitted(form: PlaneFitForm) -> ScreenSpaceFluid {
    ScreenSpaceFluid {
        smoothing: Smoothing::PlaneFit(PlaneFit {
            form,
            ..PlaneFit::DEFAULT
        }),
        ..RAW
    }
}

/// Ellipsoids of many shapes, in and beside the view, before and behind its near plane.
fn assert_ellipsoids(view: &View, app: &mut App, depth: f32, spread: f32) {
    look(app, (view.projection(), RAW));
    let mut random = Random(3);
    let mut total = 0;
    for kernel in [BULK, SPRAY] {
        let positions: Vec<_> = (0..40)
            .map(|_| (2.0 * random.point() - 1.0) * spread)
            .collect();
        let place = Transform {
            translation: Vec3::NEG_Z * depth,
            rotation: Quat::from_euler(EulerRot::XYZ, 0.4, 0.9, -0.3),
            scale: vec3(1.0, 0.3, 0.7),
        };
        let radius = 0.2 * spread;
        pour(app, (fluid(&positions, radius, kernel), place));
        assert_sound(app);
        let bodies: Vec<_> = positions
            .iter()
            .map(|&p| Ellipsoid::new(view, &place, p, radius))
            .collect();
        let layers = if kernel == BULK {
            Layers::bulk
        } else {
            Layers::spray
        };
        total += compare_layers(view, &read(app, layers), &bodies, 1e-3 * f64::from(radius));
    }
    assert!(total > 200, "{total} pixels, {:?}", view.lens);
}

/// Plane fits keep planes: depth to 1e-3 of the distance, normals to 0.2°. Two halves hold 0.05°; the
/// rest is for 170°, where neighbouring taps are metres apart.
fn assert_planes(view: &View, app: &mut App, depth: f32, half_width: f32, tilt: f32) {
    for degrees in [0.0, tilt] {
        let rotation = Quat::from_axis_angle(vec3(0.6, 0.8, 0.0), degrees.to_radians());
        let center = Vec3::NEG_Z * depth;
        let place = plate_transform(half_width, center, rotation);
        pour(app, plate(half_width, center, rotation));
        let disc = Ellipsoid::new(view, &place, Vec3::ZERO, 1.0);
        let normal = (rotation * Vec3::Z).as_dvec3();
        for form in FORMS {
            look(app, (view.projection(), fitted(form)));
            assert_sound(app);
            let layers = read(app, Layers::bulk);
            let normals = read(app, Layers::bulk_normals);
            let mut seen = 0;
            for pixel in pixels(view.size) {
                let ray = view.ray(View::center(pixel));
                let Some([front, _]) = disc.crossings(&ray) else {
                    continue;
                };
                // Its border, and the near plane, are no planes.
                let at = ray.at(front);
                let [got, _] = layers.f32x2(pixel.x, pixel.y);
                if got == 0.0
                    || got == INSIDE
                    || at.distance(center.as_dvec3()) > 4.0 * f64::from(depth)
                {
                    continue;
                }
                seen += 1;
                let off = view.unproject(View::center(pixel), got).distance(at);
                let [x, y, ..] = normals.f16x4(pixel.x, pixel.y);
                let turned = angle(decode_normal([x, y]), normal);
                assert!(
                    off < 1e-3 * at.length() && turned < 0.2,
                    "{:?}, {degrees}°, {form:?}, {pixel}: {off} m, {turned}°",
                    view.lens
                );
            }
            assert!(seen > 300, "{:?}, {degrees}°: {seen}", view.lens);
        }
    }
}

/// All light is accounted for where all around is white.
fn assert_white(view: &View, app: &mut App, depth: f32) {
    let settings = ScreenSpaceFluid {
        refractions: Refractions::Four,
        ..default()
    };
    look(app, (view.projection(), settings));
    let camera = only::<Camera3d>(app);
    let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
    camera.clear_color = ClearColorConfig::Custom(Color::WHITE);
    let block: Vec<_> = lattice(5, 0.16 * depth, 0.2)
        .iter()
        .map(|p| p - Vec3::splat(0.32 * depth) + Vec3::NEG_Z * depth)
        .collect();
    pour(app, fluid(&block, 0.08 * depth, SurfaceKernel::default()));
    assert_sound(app);
    let [radiance, transmission] = [Layers::radiance, Layers::transmission].map(|of| read(app, of));
    let mut seen = 0;
    for pixel in pixels(view.size) {
        let [a, b] = [&radiance, &transmission].map(|of| of.f16x4(pixel.x, pixel.y));
        if a[3] == 0.0 {
            continue;
        }
        seen += 1;
        let sum = DVec3::from([0, 1, 2].map(|c| f64::from(a[c] + b[c])));
        assert!((sum - 1.0).abs().max_element() < 4e-3, "{pixel}: {sum}");
    }
    assert!(seen > 10, "{seen}");
}

#[test]
fn h40_orthographic_rays_start_side_by_side() {
    let view = View::new(64, PARALLEL);
    let mut app = show(&view, RAW, |_| {});
    assert_ellipsoids(&view, &mut app, 5.0, 1.5);
    assert_planes(&view, &mut app, 5.0, 50.0, 50.0);
    assert_white(&view, &mut app, 5.0);
    // Straight on, each pixel's ray leaves where it has entered on screen.
    pour(&mut app, (plate(40.0, Vec3::NEG_Z * 5.0, Quat::IDENTITY),));
    let exits = read(&app, Layers::exits);
    for pixel in pixels(view.size) {
        let exit = Exit::at(&view, &exits, pixel.x, pixel.y).unwrap();
        let ray = view.ray(View::center(pixel));
        let apart = (exit.position - ray.origin).truncate().length();
        // A position on screen has 16 bits, a normal 11.
        assert!(apart < 1e-3, "{pixel}: {apart} m");
        assert!(angle(exit.direction, ray.direction) < 0.1);
    }
}

#[test]
fn h42_fields_of_view_of_1_and_170_degrees() {
    for (degrees, depth, spread) in [(1.0_f32, 100.0, 0.6), (170.0, 2.0, 2.5)] {
        let lens = Lens::Perspective {
            fov: degrees.to_radians(),
            near: 0.1,
        };
        let view = View::new(64, lens);
        let mut app = show(&view, RAW, |_| {});
        assert_ellipsoids(&view, &mut app, depth, spread);
        // So wide and level that neighbouring pixels lie within the range of 2 r, and a radius is
        // more than a pixel: else there is nothing to fit to.
        let tilt = if degrees < 90.0 { 50.0 } else { 10.0 };
        assert_planes(&view, &mut app, depth, 200.0, tilt);
        let size = if degrees < 90.0 { 1.0 } else { 2.0 };
        if degrees > 90.0 {
            assert_white(&view, &mut app, size);
        }
    }
}

/// Off-centre, mirrored, oblique, and all at once.
fn matrices() -> Vec<Mat4> {
    let perspective = |near_clip_plane| {
        PerspectiveProjection {
            fov: 0.9,
            aspect_ratio: 1.0,
            near: 0.1,
            near_clip_plane,
            ..default()
        }
        .get_clip_from_view()
    };
    let straight = perspective(vec4(0.0, 0.0, -1.0, -0.1));
    let tilted = |x: f32, y: f32, distance: f32| {
        let normal = vec3(x, y, -1.0).normalize();
        perspective(normal.extend(-distance))
    };
    let mut off_center = straight;
    off_center.z_axis.x = 0.6;
    off_center.z_axis.y = -0.4;
    let mirror = Mat4::from_scale(vec3(-1.0, 1.0, 1.0));
    let parallel = Mat4::orthographic_rh(-1.0, 3.0, -2.5, 1.5, 12.0, 0.1);
    vec![
        off_center,
        mirror * straight,
        tilted(0.8, 0.3, 2.0),
        tilted(-1.5, 0.0, 1.5),
        tilted(0.0, 2.5, 1.0),
        parallel,
        mirror * parallel,
        mirror * tilted(0.5, -0.6, 2.0) * Mat4::from_rotation_z(0.3),
    ]
}

#[test]
fn h46_oblique_mirrored_and_off_centre_projections() {
    let mut view = View::new(64, PERSPECTIVE);
    let mut app = show(&view, RAW, |_| {});
    for matrix in matrices() {
        view.lens = Lens::Matrix(matrix);
        assert_ellipsoids(&view, &mut app, 4.0, 1.5);
        assert_planes(&view, &mut app, 5.0, 50.0, 50.0);
        assert_white(&view, &mut app, 4.5);
    }
}
