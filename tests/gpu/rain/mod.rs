//! What rain looks like, measured on the GPU, and what it costs a game without any.

mod depth;
mod life;
mod light;
mod opacity;
mod shelters;

use core::time::Duration;

use crate::common::{self, Lens, View, only, settle, spawn_box};
use bevy::{
    camera::{Exposure as CameraExposure, Viewport, visibility::RenderLayers},
    core_pipeline::tonemapping::DebandDither,
    prelude::*,
    render::{RenderApp, view::ViewTarget},
};
use bevy_fluid::{
    prelude::*,
    rain::{
        BakedStreaks, Exposure, RainMethod, RainQuads, RainShelter, RainStreakSettings,
        drops::{LARGEST, SMALLEST, extinction, extinction_between},
        phase::phase,
    },
};
use fluid_stage::{
    TextureData, capture, gpu_spans, headless_app, log, read_texture, resize, set_time_step, step,
    validation_errors,
};
use image::RgbaImage;

/// At this setting a luminance of 1 cd/m² is a pixel of 1.
const UNIT_EXPOSURE: CameraExposure = CameraExposure {
    ev100: -0.263_034_4,
};

const VIEW: View = View {
    size: uvec2(160, 120),
    lens: Lens::Perspective {
        fov: 0.9,
        near: 0.05,
    },
    pose: Transform::from_xyz(0.3, 50.2, 0.7),
};

/// Rain that is as bright as opaque from all around, and nothing beyond it: a pixel is its opacity.
fn white_rain(rate: f32, distance: f32) -> Rain {
    Rain {
        distance,
        extent: 0.0,
        ..Rain::falling(rate)
    }
}

fn camera(view: &View, rain: Rain) -> impl Bundle {
    (
        view.plain_camera(),
        UNIT_EXPOSURE,
        DebandDither::Disabled,
        rain,
    )
}

/// An app whose warnings can be counted.
fn new_app(size: UVec2, configure: impl FnOnce(&mut App)) -> App {
    headless_app(size, configure).unwrap()
}

/// An app in which rain falls before black, lit by 1 cd/m² from all around.
fn show(view: &View, rain: Rain, exposure: f32, scene: impl FnOnce(&mut World)) -> App {
    let mut app = new_app(view.size, |app| {
        app.add_plugins(RainPlugin {
            synchronous_bake: true,
        })
        .insert_resource(RainStreakSettings {
            exposure: Exposure::Seconds(exposure),
            ..default()
        });
        let world = app.world_mut();
        world.insert_resource(GlobalAmbientLight {
            brightness: 1.0,
            ..default()
        });
        world.spawn(camera(view, rain));
        scene(world);
    });
    settle(&mut app).unwrap();
    app
}

/// The only camera's rain from now on.
fn set_rain(app: &mut App, rain: Rain) {
    let camera = only::<Camera3d>(app);
    app.world_mut().entity_mut(camera).insert(rain);
    settle(app).unwrap();
}

/// From now on only lamps and suns give light.
fn no_surroundings(app: &mut App) {
    app.world_mut()
        .resource_mut::<GlobalAmbientLight>()
        .brightness = 0.0;
    settle(app).unwrap();
}

fn show_plain(rain: Rain) -> App {
    show(&VIEW, rain, 1.0 / 60.0, |_| {})
}

/// The camera's picture before it is rounded to 8 bits.
fn radiance(app: &App) -> TextureData {
    let target = app
        .sub_app(RenderApp)
        .world()
        .iter_entities()
        .find_map(|entity| entity.get::<ViewTarget>())
        .unwrap();
    assert!(validation_errors(app).is_empty());
    read_texture(app, target.main_texture()).unwrap()
}

fn mean(data: &TextureData) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..data.size.y {
        for x in 0..data.size.x {
            sum += f64::from(data.f16x4(x, y)[1]);
            count += 1.0;
        }
    }
    sum / count
}

/// Optical depth of the rain in view, over `looks` level directions and moments.
fn optical_depth(app: &mut App, looks: u32) -> f64 {
    optical_depth_at(app, 0.0, looks)
}

/// The same for a view that looks up by `pitch`.
fn optical_depth_at(app: &mut App, pitch: f32, looks: u32) -> f64 {
    set_time_step(app, Duration::from_secs_f64(0.37));
    let camera = only::<Camera3d>(app);
    let mut sum = 0.0;
    for look in 0..looks {
        let mut transform = app.world_mut().get_mut::<Transform>(camera).unwrap();
        transform.rotation = Quat::from_euler(EulerRot::YXZ, 2.4 * look as f32, pitch, 0.0);
        transform.translation += vec3(1.7, 0.9, 2.3);
        step(app, 1);
        sum += mean(&radiance(app));
    }
    set_time_step(app, Duration::ZERO);
    -(1.0 - sum / f64::from(looks)).ln()
}

fn quads(app: &App) -> Option<usize> {
    app.sub_app(RenderApp)
        .world()
        .iter_entities()
        .find_map(|entity| entity.get::<RainQuads>())
        .map(RainQuads::len)
}

fn picture(app: &mut App) -> RgbaImage {
    capture(app).unwrap()
}
