//! The liquid under each of Bevy's ways of antialiasing.

use bevy::{
    core_pipeline::prepass::MotionVectorPrepass,
    prelude::*,
    render::{RenderApp, render_resource::TextureFormat, renderer::RenderAdapter},
};
use bevy_anti_alias::{AntiAliasPlugin, fxaa::Fxaa, smaa::Smaa, taa::TemporalAntiAliasing};
use bevy_fluid::prelude::*;
use bevy_post_process::{PostProcessPlugin, motion_blur::MotionBlur};
use core::time::Duration;
use fluid_stage::{capture, headless_app, set_time_step, settle, step};
use image::RgbaImage;

use crate::common::*;

const SIZE: UVec2 = uvec2(96, 72);
const RADIUS: f32 = 0.25;
/// m.
const STEP: f32 = 0.08;

fn paint(world: &mut World, shape: impl Into<Mesh>, color: Color, at: Transform) -> Entity {
    let mesh = world.resource_mut::<Assets<Mesh>>().add(shape.into());
    let material = StandardMaterial {
        unlit: true,
        ..color.into()
    };
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material);
    world
        .spawn((Mesh3d(mesh), MeshMaterial3d(material), at))
        .id()
}

/// A dark droplet, or a mesh of the same shape, before a wall of two colours.
fn scene(mesh: bool, camera: impl Bundle) -> App {
    let mut app = headless_app(SIZE, |app| {
        app.add_plugins((FluidPlugin::default(), AntiAliasPlugin, PostProcessPlugin));
        let world = app.world_mut();
        let eye = (Camera3d::default(), ScreenSpaceFluid::default(), Msaa::Off);
        world.spawn(eye).insert(camera);
        let ochre = Color::srgb(0.9, 0.7, 0.2);
        for (color, x) in [(Color::WHITE, 3.0), (ochre, -3.0)] {
            let half = Cuboid::new(6.0, 9.0, 0.1);
            paint(world, half, color, Transform::from_xyz(x, 0.0, -6.0));
        }
        // An edge for every way of antialiasing.
        let slanted = Transform::from_xyz(-2.4, -1.0, -5.8);
        let slanted = slanted.with_rotation(Quat::from_rotation_z(0.3));
        paint(world, Cuboid::new(0.2, 1.5, 0.1), Color::WHITE, slanted);
        if mesh {
            let ball = paint(world, Sphere::new(RADIUS), Color::BLACK, default());
            world.entity_mut(ball).insert(Droplet);
        } else {
            let mut particles = FluidParticles::new(vec![Vec3::ZERO], RADIUS);
            particles.ids = vec![1];
            world.spawn((particles, SPRAY, TAR, Droplet));
        }
    })
    .unwrap();
    put(&mut app, START);
    settle(&mut app).unwrap();
    set_time_step(&mut app, Duration::from_secs_f32(1.0 / 60.0));
    app
}

#[derive(Component)]
struct Droplet;

/// Nothing is seen through it, nor in it.
const TAR: FluidMaterial = FluidMaterial {
    medium: Medium {
        absorption_density: 1e6,
        absorption_color: LinearRgba::BLACK,
        ..Medium::CLEAR
    },
    ..FluidMaterial::WATER
};

const START: Vec3 = vec3(-0.55, 0.1, -3.0);

/// Puts the particle, or the mesh, at a place.
fn put(app: &mut App, at: Vec3) {
    let droplet = only::<Droplet>(app);
    let mut droplet = app.world_mut().entity_mut(droplet);
    if let Some(mut particles) = droplet.get_mut::<FluidParticles>() {
        particles.positions[0] = at;
    } else {
        *droplet.get_mut::<Transform>().unwrap() = Transform::from_translation(at);
    }
}

/// Sum of the differences of all pixels.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let pairs = a.as_raw().iter().zip(b.as_raw());
    pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum()
}

/// Whether the adapter draws with so many samples.
fn has_samples(app: &App, samples: u32) -> bool {
    let adapter = app.sub_app(RenderApp).world().resource::<RenderAdapter>();
    let formats = [
        TextureFormat::Rgba16Float,
        TextureFormat::Depth32Float,
        TextureFormat::Rg16Float,
    ];
    formats.into_iter().all(|format| {
        let features = adapter.get_texture_format_features(format);
        features.flags.sample_count_supported(samples)
    })
}

/// The largest excursion of a picture out of the range that another spans about each pixel.
fn excursion(picture: &RgbaImage, plain: &RgbaImage) -> u8 {
    let mut most = 0;
    for y in 1..SIZE.y - 1 {
        for x in 1..SIZE.x - 1 {
            let around = || (0..9).map(|i| plain.get_pixel(x + i % 3 - 1, y + i / 3 - 1).0);
            for channel in 0..3 {
                let value = picture.get_pixel(x, y).0[channel];
                let low = around().map(|it| it[channel]).min().unwrap();
                let high = around().map(|it| it[channel]).max().unwrap();
                let out = low.saturating_sub(value).max(value.saturating_sub(high));
                most = most.max(out);
            }
        }
    }
    most
}

#[test]
fn every_way_of_antialiasing_stays_between_the_colours_at_the_silhouette() {
    let plain = capture(&mut scene(false, ())).unwrap();
    let dark = plain.pixels().filter(|it| it.0[1] < 60).count();
    assert!(dark > 60, "the droplet covers {dark} pixels");

    // `allowed`: by how much the picture may be out of range.
    let check = |name: &str, mut app: App, allowed: u8| {
        step(&mut app, 16);
        assert_sound(&app);
        let picture = capture(&mut app).unwrap();
        let out = excursion(&picture, &plain);
        assert!(out <= allowed, "{name}: {out} of 255 out of range");
        let change = difference(&picture, &plain);
        assert!(change > 0.0, "{name} changes something");
        let dark = picture.pixels().filter(|it| it.0[1] < 60).count();
        assert!(dark > 50, "{name}: the droplet covers {dark} pixels");
    };
    check("FXAA", scene(false, Fxaa::default()), 6);
    check("SMAA", scene(false, Smaa::default()), 6);
    // It sharpens: a mesh's silhouette is out of range too.
    let plain_mesh = capture(&mut scene(true, ())).unwrap();
    let mut mesh = scene(true, TemporalAntiAliasing::default());
    step(&mut mesh, 16);
    let sharpened = excursion(&capture(&mut mesh).unwrap(), &plain_mesh);
    check(
        "TAA",
        scene(false, TemporalAntiAliasing::default()),
        sharpened + 6,
    );
    for msaa in [Msaa::Sample2, Msaa::Sample4, Msaa::Sample8] {
        let app = scene(false, ());
        if has_samples(&app, msaa.samples()) {
            check("MSAA", scene(false, msaa), 6);
        } else {
            println!("this adapter has no {msaa:?}");
        }
    }
}

/// A droplet that jumps is at its new place, and no longer at its old one, at the third frame.
#[test]
fn temporal_antialiasing_follows_a_jump() {
    // A droplet that is known, a new one, and a mesh.
    for (mesh, known) in [(false, true), (false, false), (true, true)] {
        let mut app = scene(mesh, TemporalAntiAliasing::default());
        put(&mut app, vec3(-0.5, 0.1, -1.5));
        step(&mut app, 40);
        let before = capture(&mut app).unwrap();
        put(&mut app, vec3(0.45, -0.2, -1.5));
        if !known {
            let droplet = only::<Droplet>(&mut app);
            let mut droplet = app.world_mut().entity_mut(droplet);
            droplet.get_mut::<FluidParticles>().unwrap().ids = vec![2];
        }
        step(&mut app, 3);
        let third = capture(&mut app).unwrap();
        step(&mut app, 37);
        let after = capture(&mut app).unwrap();
        let whole = difference(&before, &after);
        assert!(whole > 50_000.0, "{whole}");
        let there = 1.0 - difference(&third, &after) / whole;
        assert!(there >= 0.95, "mesh: {mesh}, known: {known}: {there}");
    }
}

/// A moving droplet is antialiased, and leaves no trail, as a mesh.
#[test]
fn temporal_antialiasing_follows_a_motion_as_a_meshs() {
    // How far the picture of a moving thing is from that of one at rest at the same place.
    let error = |mesh: bool, vectors: bool| {
        let mut app = scene(mesh, TemporalAntiAliasing::default());
        let last = START + 10.0 * STEP * Vec3::X;
        step(&mut app, 16);
        for i in 1..=10 {
            put(&mut app, START + i as f32 * STEP * Vec3::X);
            if !vectors {
                // Another particle each time.
                let droplet = only::<Droplet>(&mut app);
                let mut droplet = app.world_mut().entity_mut(droplet);
                droplet.get_mut::<FluidParticles>().unwrap().ids = vec![i];
            }
            step(&mut app, 1);
        }
        let moving = capture(&mut app).unwrap();
        put(&mut app, last);
        step(&mut app, 40);
        difference(&moving, &capture(&mut app).unwrap())
    };
    let (liquid, mesh, without) = (error(false, true), error(true, true), error(false, false));
    assert!(liquid < 1.15 * mesh, "{liquid}, a mesh {mesh}");
    assert!(
        liquid < 0.8 * without,
        "{liquid}, without vectors {without}"
    );
}

/// Where the picture of a thing in motion is blurred: the range of columns that differ from the wall.
fn blurred(mesh: bool, msaa: Msaa) -> u32 {
    let mut app = scene(
        mesh,
        (
            MotionBlur {
                shutter_angle: 1.0,
                samples: 8,
            },
            msaa,
        ),
    );
    // Over the light half.
    let at = |i: f32| vec3(0.4 + 3.0 * STEP * i, 0.1, -3.0);
    put(&mut app, at(0.0));
    step(&mut app, 4);
    put(&mut app, at(1.0));
    step(&mut app, 1);
    assert_sound(&app);
    let picture = capture(&mut app).unwrap();
    // What is mixed of the droplet and the light half of the wall.
    let white = picture.get_pixel(SIZE.x - 2, 2).0[0];
    let mixed = picture.enumerate_pixels().filter(|(x, _, pixel)| {
        let is_mixed = (30..white - 20).contains(&pixel.0[0]);
        *x > SIZE.x / 2 + 1 && is_mixed
    });
    mixed.count() as u32
}

#[test]
fn motion_blur_blurs_a_moving_droplet_as_a_mesh() {
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let (liquid, mesh) = (blurred(false, msaa), blurred(true, msaa));
        let ratio = f64::from(liquid) / f64::from(mesh);
        assert!(mesh > 40 && (0.75..1.3).contains(&ratio), "{liquid} {mesh}");
    }
}

/// Both effects ask for motion vectors themselves.
#[test]
fn temporal_antialiasing_and_motion_blur_ask_for_motion_vectors() {
    let asks = |mut app: App| {
        let camera = only::<Camera3d>(&mut app);
        let asks = app.world().entity(camera).contains::<MotionVectorPrepass>();
        asks && surface(&app).0.plan().unwrap().motion_vectors
    };
    assert!(asks(scene(false, TemporalAntiAliasing::default())));
    assert!(asks(scene(false, MotionBlur::default())));
    assert!(!asks(scene(false, Fxaa::default())));
}
