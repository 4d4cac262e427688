//! The liquid's own antialiasing: how much of each pixel it covers, and its light against the mean
//! over pixels.

use crate::common::*;
use bevy::{camera::SubCameraView, prelude::*};
use bevy_fluid::{
    material::Medium,
    prelude::*,
    render::{LayerBlending, Layers},
    settings::Antialiasing,
};
use fluid_stage::{TextureData, capture, step};
use image::RgbaImage;

const SIDE: u32 = 48;
/// One pixel is one metre.
const PIXELS: Lens = Lens::Orthographic {
    height: SIDE as f32,
    near: 0.0,
    far: 100.0,
};
const EDGES: ScreenSpaceFluid = ScreenSpaceFluid {
    antialiasing: Antialiasing::Edges,
    ..RAW
};

/// The covered part of a pixel.
fn covered(coverage: &TextureData, x: u32, y: u32) -> f32 {
    let quarters: [u8; 4] = coverage.texel(x, y);
    quarters.map(f32::from).iter().sum::<f32>() / (4.0 * 255.0)
}

/// The part of a pixel within any of some discs, from 32 × 32 points.
fn truly_covered(discs: &[Vec3], radius: f32, x: u32, y: u32) -> f32 {
    let places = (0..32 * 32).map(|i| vec2((i % 32) as f32 + 0.5, (i / 32) as f32 + 0.5) / 32.0);
    let pixel = vec2(x as f32, SIDE as f32 - 1.0 - y as f32) - 0.5 * SIDE as f32;
    let hits = places.filter(|&at| {
        let mut discs = discs.iter();
        discs.any(|disc| (pixel + at).distance(disc.truncate()) < radius)
    });
    hits.count() as f32 / 1024.0
}

/// Spheres of a radius in pixels, at places of no regularity.
fn spheres(radius: f32) -> Vec<Vec3> {
    let mut random = Random(3);
    // Some of the larger ones overlap.
    let count = if radius < 1.0 { 60 } else { 12 };
    let place = |_| (random.point() - 0.5) * 0.8 * SIDE as f32;
    (0..count).map(place).map(|at| at.with_z(-50.0)).collect()
}

#[test]
fn coverage_is_the_covered_part_of_each_pixel() {
    let view = View::new(SIDE, PIXELS);
    for blending in [LayerBlending::MaxBlend, LayerBlending::DepthDraws] {
        let plugin = FluidPlugin {
            layer_blending: blending,
            ..default()
        };
        let mut app = show_with(plugin, &view, EDGES, |_| {});
        for radius in [0.2, 0.5, 1.0, 2.5, 7.0] {
            let discs = spheres(radius);
            pour(&mut app, fluid(&discs, radius, SPRAY));
            let coverage = read(&app, Layers::coverage);
            let (mut squares, mut count, mut got_sum, mut true_sum) = (0.0, 0.0, 0.0, 0.0);
            for UVec2 { x, y } in pixels(view.size) {
                let got = covered(&coverage, x, y);
                let truth = truly_covered(&discs, radius, x, y);
                if got > 0.0 && got < 1.0 || truth > 0.0 && truth < 1.0 {
                    squares += (got - truth).powi(2);
                    count += 1.0;
                }
                got_sum += got;
                true_sum += truth;
            }
            let error = f32::sqrt(squares / count);
            println!("radius {radius}: {error}, sum {}", got_sum / true_sum);
            assert!(
                error < 0.03,
                "radius {radius}: {error} in pixels covered in part"
            );
            let sum = got_sum / true_sum;
            assert!(
                (0.9..1.1).contains(&sum),
                "radius {radius}: {sum} of the area"
            );
        }
    }
}

/// What is black and opaque darkens a white background by its coverage, and gives a transparent one
/// its alpha.
#[test]
fn edges_blend_with_the_background_and_its_alpha() {
    let view = View::new(SIDE, PIXELS);
    let mut app = show(&view, EDGES, |_| {});
    let black = FluidMaterial {
        refractive_index: 1.0,
        medium: Medium {
            absorption_density: 1e6,
            absorption_color: LinearRgba::BLACK,
            ..Medium::CLEAR
        },
        ..FluidMaterial::WATER
    };
    pour(
        &mut app,
        (FluidParticles::new(spheres(2.5), 2.5), SPRAY, black),
    );
    let coverage = read(&app, Layers::coverage);
    for (clear, light) in [(Color::WHITE, 1.0), (Color::NONE, 0.0)] {
        let camera = only::<Camera3d>(&mut app);
        let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
        camera.clear_color = ClearColorConfig::Custom(clear);
        step(&mut app, 2);
        let picture = capture(&mut app).unwrap();
        let mut partly = 0;
        for (x, y, pixel) in picture.enumerate_pixels() {
            let part = covered(&coverage, x, y);
            let wanted = Color::linear_rgb(light * (1.0 - part), 0.0, 0.0)
                .to_srgba()
                .red;
            let alpha = if light > 0.0 { 1.0 } else { part };
            // Layers begin where a pixel's middle is covered; light beside them is their mean.
            assert!(
                (f32::from(pixel[0]) / 255.0 - wanted).abs() < 0.02,
                "({x}, {y}): {pixel:?} for {part}"
            );
            assert!(
                (f32::from(pixel[3]) / 255.0 - alpha).abs() < 0.02,
                "({x}, {y})"
            );
            partly += u32::from(part > 0.1 && part < 0.9);
        }
        assert!(partly > 50, "{partly} pixels are covered in part");
    }
}

/// A splash in miniature: a lump of bulk with droplets before it, over a wall of stripes.
fn splash(world: &mut World) {
    for i in -6..6 {
        let place = Transform::from_xyz(0.4 * i as f32, 0.0, -9.0);
        spawn_box(world, vec3(0.2, 6.0, 0.1), place);
    }
    let lump = lattice(7, 0.2, 0.3).into_iter();
    let lump = lump.map(|p| p + vec3(-0.6, -0.9, -6.5));
    let mut random = Random(5);
    let droplets = (0..150).map(|_| (random.point() - 0.5) * 2.0 + vec3(0.0, 0.3, -5.0));
    let all: Vec<_> = lump.chain(droplets).collect();
    world.spawn(fluid(&all, 0.1, SurfaceKernel::default()));
    world.spawn((
        DirectionalLight::default(),
        Transform::default().looking_to(vec3(-0.4, -1.0, -0.6), Vec3::Y),
    ));
}

fn shift(app: &mut App, offset: Vec2) -> RgbaImage {
    let camera = only::<Camera3d>(app);
    let size = UVec2::splat(64);
    app.world_mut()
        .get_mut::<Camera>(camera)
        .unwrap()
        .sub_camera_view = Some(SubCameraView {
        full_size: size,
        offset,
        size,
    });
    step(app, 2);
    capture(app).unwrap()
}

fn linear(picture: &RgbaImage) -> Vec<Vec3> {
    let decode = |[r, g, b, _]: [u8; 4]| Color::srgb_u8(r, g, b).to_linear().to_vec3();
    picture.pixels().map(|pixel| decode(pixel.0)).collect()
}

fn encoded(light: &[Vec3]) -> Vec<Vec3> {
    let encode = |&c: &Vec3| LinearRgba::from_vec3(c);
    let srgb = light.iter().map(encode).map(Srgba::from);
    srgb.map(|c| vec3(c.red, c.green, c.blue)).collect()
}

fn rmse(a: &[Vec3], b: &[Vec3]) -> f32 {
    let squares = a.iter().zip(b).map(|(a, b)| a.distance_squared(*b) / 3.0);
    (squares.sum::<f32>() / a.len() as f32).sqrt()
}

/// The energy of differences to the next pixel.
fn sharpness(picture: &[Vec3]) -> f32 {
    let across = picture
        .windows(2)
        .map(|pair| pair[0].distance_squared(pair[1]));
    let down = picture.iter().zip(&picture[64..]);
    across.sum::<f32>() + down.map(|(a, b)| a.distance_squared(*b)).sum::<f32>()
}

#[test]
fn pixels_show_the_mean_over_them() {
    let settings = |antialiasing| ScreenSpaceFluid {
        antialiasing,
        ..default()
    };
    let view = View::new(
        64,
        Lens::Perspective {
            fov: 0.7,
            near: 0.1,
        },
    );
    let mut app = show(&view, settings(Antialiasing::None), splash);
    // For the stripes beside the liquid.
    look(&mut app, Msaa::Sample4);
    // The mean of 36 pictures without antialiasing, from places all over the pixels.
    let mut truth = vec![Vec3::ZERO; 64 * 64];
    for i in 0..36 {
        let offset = (vec2((i % 6) as f32, (i / 6) as f32) + 0.5) / 6.0 - 0.5;
        for (sum, light) in truth.iter_mut().zip(linear(&shift(&mut app, offset))) {
            *sum += light / 36.0;
        }
    }
    let truth = encoded(&truth);
    let kinds = [
        Antialiasing::None,
        Antialiasing::Edges,
        Antialiasing::FULL,
        Antialiasing::Full { rays: 8 },
    ];
    let measured = kinds.map(|antialiasing| {
        look(&mut app, settings(antialiasing));
        let got = encoded(&linear(&shift(&mut app, Vec2::ZERO)));
        (rmse(&got, &truth), sharpness(&got) / sharpness(&truth))
    });
    println!("{measured:?}");
    let [none, edges, full, many] = measured;
    assert!(edges.0 < 0.97 * none.0, "{measured:?}");
    assert!(full.0 < 0.7 * none.0, "{measured:?}");
    assert!(many.0 < 0.95 * full.0, "{measured:?}");
    // A blur would be less sharp than the truth; noise is more than twice as sharp.
    assert!(none.1 > 2.0, "{measured:?}");
    for (_, sharpness) in [full, many] {
        assert!((0.9..1.7).contains(&sharpness), "{measured:?}");
    }
}

/// Where nothing aliases, the mean over a pixel is what its middle shows.
#[test]
fn smooth_light_stays_as_it_is() {
    let plate = || plate(2.0, vec3(0.0, 0.0, -5.0), Quat::from_rotation_x(0.6));
    let mut app = show(&View::new(64, PERSPECTIVE), RAW, |_| {});
    pour(&mut app, plate());
    let pictures = [Antialiasing::None, Antialiasing::FULL].map(|antialiasing| {
        let settings = ScreenSpaceFluid {
            antialiasing,
            ..default()
        };
        look(&mut app, settings);
        shift(&mut app, Vec2::ZERO)
    });
    for y in 24..40 {
        for x in 24..40 {
            let [none, full] = pictures.each_ref().map(|picture| picture.get_pixel(x, y).0);
            let apart = none.iter().zip(full).map(|(a, b)| a.abs_diff(b)).max();
            assert!(apart <= Some(1), "({x}, {y}): {none:?}, {full:?}");
        }
    }
}

#[test]
fn without_antialiasing_there_is_no_coverage() {
    let app = show(&View::new(32, PERSPECTIVE), RAW, |world| {
        world.spawn(fluid(&[Vec3::NEG_Z * 5.0], 1.0, BULK));
    });
    assert!(surface(&app).1.coverage().is_none());
}

const PERSPECTIVE: Lens = Lens::Perspective {
    fov: 0.7,
    near: 0.1,
};
