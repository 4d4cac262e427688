//! A small scene without a window: what the picture shows, and what the stage reports.

use bevy::{
    math::bounding::Aabb3d,
    prelude::*,
    render::{
        render_resource::{BufferInitDescriptor, BufferUsages},
        renderer::{RenderDevice, RenderQueue},
    },
};
use fluid_stage::{
    Stage, StageError, adapter_name, capture, gpu_spans, headless_app, median_gpu_ms, resize,
    scenery::{Scenery, frame_camera, orbit_camera},
    set_time_step, settle, step, validation_errors,
};
use image::Rgba;

const SIZE: UVec2 = UVec2::new(160, 120);
const TO_SUN: Vec3 = Vec3::new(0.6, 0.8, 0.5);

fn red_cube_on_a_floor(mut scenery: Scenery) {
    let tank = Aabb3d::new(Vec3::Y, Vec3::ONE);
    let sky = scenery.sky(TO_SUN);
    scenery.checker_floor(Vec3::ZERO, 6.0, 12);
    scenery.pillars(tank, 5);
    scenery.tank(tank);
    scenery.sun(TO_SUN, 12.0, true);
    let cube = scenery.meshes.add(Cuboid::default());
    let red = scenery.materials.add(Color::srgb(0.9, 0.1, 0.1));
    scenery.commands.spawn((
        Mesh3d(cube),
        MeshMaterial3d(red),
        Transform::from_translation(Vec3::Y),
    ));
    let (eye, target) = frame_camera(tank, 45_f32.to_radians(), 4.0 / 3.0);
    scenery
        .commands
        .spawn((orbit_camera(eye, target), sky.bundle()));
}

fn settled() -> App {
    let mut app = headless_app(SIZE, |app| {
        app.add_systems(Startup, red_cube_on_a_floor);
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

fn empty() -> App {
    headless_app(SIZE, |_| {}).unwrap()
}

#[test]
fn the_picture_shows_the_scene() {
    let mut app = settled();
    assert!(!adapter_name(&app).is_empty());
    let picture = capture(&mut app).unwrap();
    assert_eq!(picture.dimensions(), SIZE.into());

    let Rgba([red, green, blue, _]) = *picture.get_pixel(80, 60);
    assert!(red > 2 * green.max(blue), "a red cube in the middle");
    let Rgba([red, _, blue, _]) = *picture.get_pixel(3, 2);
    assert!(blue > red, "a blue sky above");
    let floor = (0..SIZE.x).map(|x| picture.get_pixel(x, SIZE.y - 2).0[1]);
    let (darkest, lightest) = (floor.clone().min(), floor.max());
    assert!(
        lightest > darkest.map(|dark| dark + 60),
        "a chequered floor"
    );

    assert_eq!(
        picture,
        capture(&mut app).unwrap(),
        "the same picture twice"
    );
    step(&mut app, 2);
    assert_eq!(picture, capture(&mut app).unwrap(), "nothing moves");
    assert!(validation_errors(&app).is_empty());
}

#[test]
fn passes_are_timed() {
    let mut app = settled();
    step(&mut app, 3);
    let spans = gpu_spans(&app);
    if let Some(span) = spans.iter().find(|span| span.contains("main_opaque")) {
        assert!(median_gpu_ms(&app, span).unwrap() > 0.0);
    }
    assert_eq!(median_gpu_ms(&app, "render/no_such_pass/elapsed_gpu"), None);
}

#[test]
fn the_clock_stands_while_pipelines_compile() {
    let mut app = settled();
    let elapsed = |app: &App| app.world().resource::<Time>().elapsed_secs();
    assert_eq!(elapsed(&app), 0.0);
    set_time_step(&mut app, std::time::Duration::from_millis(250));
    settle(&mut app).unwrap();
    assert_eq!(elapsed(&app), 0.0);
    step(&mut app, 4);
    assert_eq!(elapsed(&app), 1.0);
}

#[test]
fn the_picture_is_resized_and_viewports_kept() {
    let mut app = settled();
    let smaller = UVec2::new(64, 48);
    for size in [smaller, SIZE * 2, smaller] {
        resize(&mut app, size).unwrap();
        step(&mut app, 1);
        let picture = capture(&mut app).unwrap();
        assert_eq!(picture.dimensions(), size.into());
        let Rgba([red, green, ..]) = *picture.get_pixel(size.x / 2, size.y / 2);
        assert!(red > 2 * green, "the cube stays in the middle at {size}");
    }
    assert!(matches!(
        resize(&mut app, UVec2::new(0, 48)),
        Err(StageError::Size(_))
    ));
}

#[test]
fn later_cameras_render_to_the_stage_too() {
    let mut app = empty();
    settle(&mut app).unwrap();
    let green = Color::srgb(0.0, 1.0, 0.0);
    let viewport = bevy::camera::Viewport {
        physical_position: UVec2::new(80, 0),
        physical_size: UVec2::new(80, 120),
        ..default()
    };
    app.world_mut().spawn((
        Camera3d::default(),
        bevy::core_pipeline::tonemapping::Tonemapping::None,
        Camera {
            viewport: Some(viewport),
            clear_color: ClearColorConfig::Custom(green),
            ..default()
        },
    ));
    settle(&mut app).unwrap();
    let picture = capture(&mut app).unwrap();
    assert_eq!(*picture.get_pixel(81, 60), Rgba([0, 255, 0, 255]));
    assert_ne!(*picture.get_pixel(79, 60), Rgba([0, 255, 0, 255]));
    assert_eq!(app.world().resource::<Stage>().size, SIZE);
}

#[test]
fn validation_errors_do_not_pass_unnoticed() {
    let mut app = empty();
    settle(&mut app).unwrap();
    // A buffer that nobody may write to.
    app.world().resource::<RenderQueue>().write_buffer(
        &app.world()
            .resource::<RenderDevice>()
            .create_buffer_with_data(&BufferInitDescriptor {
                label: Some("read only"),
                contents: &[0; 16],
                usage: BufferUsages::COPY_SRC,
            }),
        0,
        &[1; 16],
    );
    assert!(validation_errors(&app)[0].contains("read only"));
    assert!(matches!(capture(&mut app), Err(StageError::Validation(_))));
    assert!(matches!(settle(&mut app), Err(StageError::Validation(_))));
}
