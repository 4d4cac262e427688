//! What happens where there is no device, or it goes away. What a device may lack is decided, and its
//! absence forced, in `src/render/frame/support.rs` and `tests/gpu/layers/equal.rs`: Bevy itself does
//! not start on devices that lack so much.

use crate::common::*;
use bevy::{
    camera::RenderTarget,
    prelude::*,
    render::{
        error_handler::{ErrorType, RenderErrorHandler, RenderErrorPolicy},
        render_resource::PollType,
        renderer::RenderDevice,
        settings::{RenderCreation, WgpuSettings},
    },
};
use bevy_fluid::{
    inspector::{FluidInspector, FluidInspectorPlugin},
    particles::ShapedFluid,
    prelude::*,
};
use core::time::Duration;
use fluid_stage::{Stage, capture, headless_app, headless_app_with, set_time_step, step};

const VIEW: View = View::new(
    64,
    Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
);
const RADIUS: f32 = 0.1;

fn pool() -> impl Bundle {
    let block = lattice(6, 2.0 * RADIUS, 0.2);
    let shifted = block.iter().map(|p| p + vec3(-0.5, -0.6, -5.5));
    let positions: Vec<_> = shifted.chain([vec3(0.7, 0.8, -5.0)]).collect();
    fluid(&positions, RADIUS, SurfaceKernel::default())
}

fn scene(world: &mut World) {
    let wall = Transform::from_xyz(0.0, 0.4, -8.0);
    spawn_box(world, vec3(3.0, 1.0, 0.1), wall);
    world.spawn(pool());
}

fn show_default() -> App {
    show(&VIEW, ScreenSpaceFluid::default(), scene)
}

/// Destroys the device, and settles on another.
pub(crate) fn lose_device(app: &mut App) {
    app.insert_resource(RenderErrorHandler(|error, _, _| {
        assert_eq!(error.ty, ErrorType::DeviceLost, "{}", error.description);
        RenderErrorPolicy::Recover(RenderCreation::default())
    }));
    let device = app.world().resource::<RenderDevice>().clone();
    device.wgpu_device().destroy();
    // The loss is reported at the next poll; a frame begun before it would write to what is gone.
    let _ = device.poll(PollType::wait_indefinitely());
    for _ in 0..8 {
        app.update();
    }
    settle(app).unwrap();
}

#[test]
fn without_a_gpu_fluids_are_still_shaped() {
    let settings = WgpuSettings {
        backends: None,
        ..default()
    };
    let mut app = headless_app_with(VIEW.size, settings, |app| {
        app.add_plugins(FluidPlugin::default());
        app.world_mut()
            .spawn(VIEW.camera(ScreenSpaceFluid::default()));
        app.world_mut().spawn(pool());
    })
    .unwrap();
    app.update();
    app.update();
    let fluid = only::<FluidParticles>(&mut app);
    let shaped = app.world().get::<ShapedFluid>(fluid).unwrap();
    assert_eq!(shaped.bulk() + shaped.interior() + shaped.spray(), 217);
}

#[test]
fn a_lost_device_is_survived() {
    let mut app = show_default();
    let before = capture(&mut app).unwrap();
    lose_device(&mut app);
    let stage = app.world().resource::<Stage>().image.clone();
    assert!(app.world().resource::<Assets<Image>>().contains(&stage));
    assert_sound(&app);
    assert!(view_surfaces(&app).is_some());
    assert!(capture(&mut app).unwrap() == before);
}

/// The textures of a view, for samples and for several surfaces, are of the device too.
#[test]
fn a_lost_device_is_survived_by_several_surfaces_in_a_multisampled_view() {
    let mut app = show(&VIEW, ScreenSpaceFluid::default(), |world| {
        scene(world);
        let milk = fluid(&[vec3(0.0, 0.0, -3.0)], 0.4, BULK);
        world.spawn(milk).insert(FluidMaterial::MILK);
    });
    look(&mut app, Msaa::Sample4);
    let before = capture(&mut app).unwrap();
    lose_device(&mut app);
    assert_sound(&app);
    assert_eq!(surfaces(&app).len(), 2);
    assert!(capture(&mut app).unwrap() == before);
}

/// Liquid that is simulated in a tank, in rain, beside the inspector.
fn busy_app() -> App {
    let mut app = headless_app(uvec2(480, 320), |app| {
        app.add_plugins((
            FluidPlugin::default(),
            RainPlugin {
                synchronous_bake: true,
            },
            SalvaPlugin,
            FluidInspectorPlugin {
                open: true,
                ..default()
            },
        ))
        .insert_resource(SalvaSettings {
            mode: SalvaMode::Lockstep,
            ..default()
        });
        let world = app.world_mut();
        world.spawn((
            Camera3d::default(),
            ScreenSpaceFluid::default(),
            Rain::HEAVY,
            Transform::from_xyz(-0.4, 1.0, 3.0).looking_at(vec3(-0.4, 0.5, 0.0), Vec3::Y),
        ));
        let tank = SalvaBoundary::tank(vec3(1.2, 2.0, 0.8));
        world.spawn((tank, Transform::from_xyz(0.0, 1.0, 0.0)));
        let block = lattice(6, 0.1, 0.0);
        let positions = block.iter().map(|p| p + vec3(-0.55, 0.3, -0.25)).collect();
        world.spawn((
            FluidParticles::new(positions, 0.05),
            SalvaFluid::WATER,
            FluidMaterial::MILK,
        ));
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

/// Mean height of all particles.
fn height(app: &mut App) -> f32 {
    let fluid = only::<FluidParticles>(app);
    let positions = &app.world().get::<FluidParticles>(fluid).unwrap().positions;
    positions.iter().map(|p| p.y).sum::<f32>() / positions.len() as f32
}

/// The picture without the inspector, whose figures change, and how many of its pixels that covers.
fn beside_inspector(app: &mut App) -> (image::RgbaImage, usize) {
    let mut draw = |open| {
        app.world_mut().resource_mut::<FluidInspector>().open = open;
        // Its window fades.
        set_time_step(app, Duration::from_millis(100));
        app.world_mut().resource_mut::<SalvaSettings>().paused = true;
        app.world_mut().resource_mut::<Time<Virtual>>().pause();
        step(app, 8);
        set_time_step(app, Duration::ZERO);
        capture(app).unwrap()
    };
    let (with, without) = (draw(true), draw(false));
    let covered = with.pixels().zip(without.pixels());
    let covered = covered.filter(|(a, b)| a != b).count();
    (without, covered)
}

#[test]
fn h53_a_lost_device_is_survived_by_rain_simulation_and_inspector() {
    let mut app = busy_app();
    let start = height(&mut app);
    set_time_step(&mut app, Duration::from_secs_f32(1.0 / 60.0));
    step(&mut app, 4);
    let before = height(&mut app);
    lose_device(&mut app);
    assert_sound(&app);
    let after = height(&mut app);
    assert!(after < before && before < start, "{start} {before} {after}");
    step(&mut app, 4);
    let later = height(&mut app);
    assert!(later < after, "{after} {later}");

    let (before, covered) = beside_inspector(&mut app);
    assert!(covered > 10_000, "the inspector covers {covered} pixels");
    lose_device(&mut app);
    assert_sound(&app);
    let (after, covers) = beside_inspector(&mut app);
    assert!(before == after, "the picture comes back");
    let change = (covers as f64 / covered as f64 - 1.0).abs();
    assert!(
        change < 0.05,
        "the inspector covers {covered}, then {covers}"
    );
}

#[test]
fn a_camera_whose_target_is_gone_draws_nothing_and_harms_nobody() {
    let mut app = show_default();
    let before = capture(&mut app).unwrap();
    let image = Image::new_target_texture(
        32,
        32,
        bevy::render::render_resource::TextureFormat::Rgba8UnormSrgb,
        None,
    );
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let camera = (
        VIEW.camera(ScreenSpaceFluid::default()),
        RenderTarget::from(image.clone()),
    );
    app.world_mut().spawn(camera);
    settle(&mut app).unwrap();
    assert_sound(&app);
    app.world_mut()
        .resource_mut::<Assets<Image>>()
        .remove(&image);
    step(&mut app, 4);
    assert_sound(&app);
    assert!(capture(&mut app).unwrap() == before);
}
