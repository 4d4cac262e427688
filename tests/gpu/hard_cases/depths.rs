//! h19 to h26: what smoothing must leave alone.

use bevy::prelude::*;
use bevy_fluid::{
    prelude::ScreenSpaceFluid,
    render::Layers,
    settings::{Bilateral, PlaneFit, PlaneFitForm, Smoothing},
};
use fluid_stage::TextureData;

use super::*;

const PARALLEL: View = View::new(
    64,
    Lens::Orthographic {
        height: 1.0,
        near: 0.0,
        far: 12.0,
    },
);

fn smoothed(smoothing: Smoothing) -> ScreenSpaceFluid {
    ScreenSpaceFluid { smoothing, ..RAW }
}

/// The plane fits in all forms, and the methods of others.
fn all() -> Vec<ScreenSpaceFluid> {
    let fit = |form| {
        Smoothing::PlaneFit(PlaneFit {
            form,
            ..PlaneFit::DEFAULT
        })
    };
    let all = [
        fit(PlaneFitForm::TotalLeastSquares),
        fit(PlaneFitForm::DeviceDepth),
        fit(PlaneFitForm::Separable),
        Smoothing::Bilateral(Bilateral::THESIS),
        Smoothing::NormalAverage(default()),
        Smoothing::NarrowRange(default()),
        Smoothing::CurvatureFlow(default()),
    ];
    all.map(smoothed).into()
}

/// Layers of the only body's bulk under every kind of smoothing.
fn under_all(app: &mut App, mut check: impl FnMut(&ScreenSpaceFluid, &TextureData)) {
    for settings in all() {
        look(app, settings);
        assert_sound(app);
        check(&settings, &read(app, Layers::bulk));
    }
}

#[test]
fn h19_a_plane_at_89_9_degrees() {
    let mut app = show(&PARALLEL, RAW, |_| {});
    let turn = Quat::from_axis_angle(vec3(0.6, 0.8, 0.0), 89.9_f32.to_radians());
    let center = Vec3::NEG_Z * 6.0;
    let place = plate_transform(2e3, center, turn);
    for (size, share) in [(2e3, 0.0), (2.0, 0.0)] {
        pour(&mut app, plate(size, center, turn));
        look(&mut app, RAW);
        let raw = read(&app, Layers::bulk);
        let radius = f64::from(
            plate_transform(size, center, turn)
                .scale
                .element_product()
                .cbrt(),
        );
        under_all(&mut app, |settings, layers| {
            let mut off = 0;
            for pixel in pixels(PARALLEL.size) {
                let [front, back] = layers.f32x2(pixel.x, pixel.y);
                let [raw_front, raw_back] = raw.f32x2(pixel.x, pixel.y);
                assert_eq!(front > 0.0, raw_front > 0.0);
                assert_eq!(back > NOTHING[1], raw_back > NOTHING[1]);
                let moved = (PARALLEL.depth(front) - PARALLEL.depth(raw_front)).abs();
                // On the plane, or left as it was.
                off += usize::from(moved > 2.0 * radius);
            }
            assert_eq!(off as f64, share, "{:?}", settings.smoothing);
        });
    }
    assert!(place.is_finite());
}

/// Droplets of `radius` in pixels, one in each cell of ten pixels, at different places in a pixel.
fn droplets(radius: f32, shift: f32) -> (Vec<Vec3>, f32) {
    let cells = (0..36).map(|i| uvec2(i % 6, i / 6));
    let positions = cells.enumerate().map(|(i, cell)| {
        let within = vec2(
            (i as f32 * 0.37 + shift) % 1.0,
            (i as f32 * 0.61 + 0.3 * shift) % 1.0,
        );
        let at = cell.as_vec2() * 10.0 + 5.0 + within;
        PARALLEL.ray(at.as_dvec2()).at(5.0).as_vec3()
    });
    (positions.collect(), radius / PARALLEL.size.y as f32)
}

#[test]
fn h20_one_pixel_droplets_have_the_normals_of_their_ellipsoids() {
    let (positions, radius) = droplets(0.5, 0.0);
    let app = show(&PARALLEL, ScreenSpaceFluid::default(), |world| {
        world.spawn(fluid(&positions, radius, SPRAY));
    });
    assert_sound(&app);
    let layers = read(&app, Layers::spray);
    let normals = read(&app, Layers::spray_normals);
    let spheres = Ellipsoid::spheres(&PARALLEL, &positions, radius);
    let mut seen = 0;
    for pixel in pixels(PARALLEL.size) {
        let ray = PARALLEL.ray(View::center(pixel));
        let crossings = spheres.iter().find_map(|s| Some((s, s.crossings(&ray)?)));
        let Some((sphere, [front, _])) = crossings else {
            continue;
        };
        assert!(layers.f32x2(pixel.x, pixel.y)[0] > 0.0, "{pixel} is a hole");
        let [x, y, ..] = normals.f16x4(pixel.x, pixel.y);
        let wanted = sphere.normal(ray.at(front));
        if wanted.z < 0.3 {
            continue;
        }
        seen += 1;
        let off = angle(decode_normal([x, y]), wanted);
        assert!(off < 0.3, "{pixel}: {off}°");
    }
    assert!(seen > 20, "{seen}");
}

#[test]
fn h21_sub_pixel_droplets_in_motion_do_not_pop() {
    let mut app = show(&PARALLEL, ScreenSpaceFluid::default(), |_| {});
    for radius in [0.02, 0.2, 0.45, 0.6, 0.75] {
        for step in 0..6 {
            let (positions, metres) = droplets(radius, 0.17 * step as f32);
            pour(&mut app, fluid(&positions, metres, SPRAY));
            assert_sound(&app);
            let layers = read(&app, Layers::spray);
            // Every droplet is there, in the pixel that holds its centre at least.
            for (cell, position) in positions.iter().enumerate() {
                let ndc = position.truncate() * 2.0;
                let at = (ndc * vec2(0.5, -0.5) + 0.5) * PARALLEL.size.as_vec2();
                let pixel = at.as_uvec2();
                let [front, back] = layers.f32x2(pixel.x, pixel.y);
                assert!(
                    front > 0.0 && -back > 0.0 && front >= -back,
                    "radius {radius} px, step {step}, droplet {cell}: {front} {back}"
                );
                let off = (PARALLEL.depth(front) + f64::from(position.z)).abs();
                assert!(off < 2.0 * f64::from(metres) + 2e-6, "{off} m off in depth");
            }
            let covered = layers
                .texels()
                .filter(|&[front, _]: &[f32; 2]| front > 0.0)
                .count();
            let most = if radius < 0.5 { 1 } else { 4 };
            assert!(
                (36..=36 * most).contains(&covered),
                "radius {radius} px: {covered} pixels"
            );
        }
    }
}

#[test]
fn h22_a_step_of_ten_radii_is_not_bridged() {
    let far = plate_transform(20.0, Vec3::NEG_Z * 9.0, Quat::IDENTITY);
    // The body's radius is the larger one: that of the far disc.
    let radius = far.scale.element_product().cbrt();
    let near = 9.0 - 10.0 * radius;
    let mut app = show(&PARALLEL, RAW, |world| {
        world.spawn(plate(20.0, Vec3::NEG_Z * 9.0, Quat::IDENTITY));
        world.spawn(plate(0.3, Vec3::NEG_Z * near, Quat::IDENTITY));
    });
    under_all(&mut app, |settings, layers| {
        // The weight of a tap across the step is exp(−25) for the fits, but exp(−6.25) for the
        // published bilateral filter, which adds up over its 22 iterations; the narrow-range
        // filter's published range is ten radii itself, so there the step is no step.
        let tolerance = match settings.smoothing {
            Smoothing::Bilateral(_) => 0.1,
            Smoothing::NarrowRange(_) => 10.0,
            _ => 1e-3,
        };
        for pixel in pixels(PARALLEL.size) {
            let ray = PARALLEL.ray(View::center(pixel));
            let hits = ray.origin.truncate().length() < 0.3;
            let wanted = f64::from(if hits { near } else { 9.0 });
            let got = PARALLEL.depth(layers.f32x2(pixel.x, pixel.y)[0]);
            let error = (got - wanted).abs() / f64::from(radius);
            assert!(
                error < tolerance,
                "{:?}, {pixel}: {error} r",
                settings.smoothing
            );
        }
    });
}

/// A sheet of overlapping spheres, bumpy on both sides, `thickness` of a pixel thick between
/// bumps, and slanting so that all depths occur.
fn sheet(app: &mut App) {
    let mut random = Random(8);
    let radius = 0.02;
    let positions: Vec<_> = (0..2500)
        .map(|_| {
            let p = random.point() - 0.5;
            vec3(1.2 * p.x, 1.2 * p.y, -5.0 + 1.5 * p.x + 0.3 * radius * p.z)
        })
        .collect();
    // Flattened to a hundredth of a pixel.
    let place = Transform::from_scale(vec3(1.0, 1.0, 1e-2));
    pour(app, (fluid(&positions, radius, BULK), place));
}

#[test]
fn h23_a_sheet_thinner_than_a_pixel_keeps_its_sides() {
    let view = View::new(
        64,
        Lens::Orthographic {
            height: 1.0,
            near: 0.0,
            far: 0.2,
        },
    );
    let mut app = show(&view, RAW, |_| {});
    sheet(&mut app);
    let mut seen = 0;
    under_all(&mut app, |settings, layers| {
        seen += assert_sides(settings, layers);
    });
    assert!(seen > 10_000, "{seen}");
}

/// Where there are both, the front is not behind the back.
fn assert_sides(settings: &ScreenSpaceFluid, layers: &TextureData) -> usize {
    let mut seen = 0;
    for pixel in pixels(layers.size) {
        let [front, back] = layers.f32x2(pixel.x, pixel.y);
        if front > 0.0 && back > NOTHING[1] {
            seen += 1;
            assert!(
                front >= -back,
                "{:?}, {pixel}: {front} {back}",
                settings.smoothing
            );
        }
    }
    seen
}

#[test]
fn h24_front_and_back_that_cross_are_clamped_to_no_thickness() {
    // Two sheets of bumps that touch: fitted one by one, planes through the fronts of many small
    // particles and through the backs of few large ones pass each other.
    let view = View::new(96, PERSPECTIVE);
    let mut app = show(&view, RAW, |_| {});
    let mut random = Random(4);
    let dust: Vec<_> = (0..900)
        .map(|_| {
            let p = 2.0 * random.point() - 1.0;
            vec3(p.x, p.y, -4.0 + 0.9 * p.x + 0.05 * p.z)
        })
        .collect();
    pour(&mut app, fluid(&dust, 0.05, BULK));
    let raw = read(&app, Layers::bulk);
    under_all(&mut app, |settings, layers| {
        assert_sides(settings, layers);
        for pixel in pixels(view.size) {
            let [a, b] = [&raw, layers].map(|l| l.f32x2(pixel.x, pixel.y));
            assert_eq!(
                (a[0] > 0.0, a[1] > NOTHING[1]),
                (b[0] > 0.0, b[1] > NOTHING[1])
            );
        }
    });
    // And a path of no length lets all light through that the surfaces do.
    look(&mut app, ScreenSpaceFluid::default());
    assert_sound(&app);
}

#[test]
fn h25_an_isolated_pixel_is_unchanged() {
    let ray = PARALLEL.ray(View::center(uvec2(30, 40)));
    let center = ray.at(5.0).as_vec3();
    let mut app = show(&PARALLEL, RAW, |world| {
        world.spawn(fluid(&[center], 0.5 / 64.0, BULK));
    });
    let raw = read(&app, Layers::bulk);
    let there = raw.texels().filter(|&[front, _]: &[f32; 2]| front > 0.0);
    assert_eq!(there.count(), 1);
    under_all(&mut app, |settings, layers| {
        assert!(*layers == raw, "{:?}", settings.smoothing);
    });
}

#[test]
fn h26_invalid_pixels_are_unchanged() {
    // A ring: nothing within, nothing without, and windows of nothing but nothing.
    let positions: Vec<_> = (0..40)
        .map(|i| {
            let turn = Vec2::from_angle(i as f32 * core::f32::consts::TAU / 40.0);
            (0.3 * turn).extend(-5.0)
        })
        .collect();
    let mut app = show(&PARALLEL, RAW, |world| {
        world.spawn(fluid(&positions, 0.04, BULK));
    });
    let raw = read(&app, Layers::bulk);
    let empty = raw.texels().filter(|&layers: &[f32; 2]| layers == NOTHING);
    assert!(empty.count() > 2000);
    under_all(&mut app, |settings, layers| {
        for pixel in pixels(PARALLEL.size) {
            let [was, is] = [&raw, layers].map(|l| l.f32x2(pixel.x, pixel.y));
            assert_eq!(
                was == NOTHING,
                is == NOTHING,
                "{:?}, {pixel}",
                settings.smoothing
            );
        }
    });
}
