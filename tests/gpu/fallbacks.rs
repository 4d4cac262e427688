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
use bevy_fluid::{particles::ShapedFluid, prelude::*};
use fluid_stage::{Stage, capture, headless_app_with, step};

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
