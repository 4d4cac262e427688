//! What a game changes at run time, one frame at a time.

use super::*;
use crate::common::assert_sound;
use bevy::{
    asset::RenderAssetUsages,
    camera::{Hdr, RenderTarget, Viewport},
    core_pipeline::tonemapping::Tonemapping,
    render::{RenderApp, render_resource::PipelineCache},
    window::WindowRef,
};
use bevy_fluid::{
    render::{PlanReports, TextureMemory},
    settings::FluidDebugView,
};
use fluid_stage::{Stage, step};

type Change = fn(&mut World, Entity, Entity);

/// Steps through changes, and asserts that the middle of a block of ink is dark in every frame.
fn assert_never_gone(changes: &[(&str, Change)]) {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, it| camera = it);
    let liquid = crate::common::only::<FluidParticles>(&mut app);
    for (name, change) in changes {
        change(app.world_mut(), camera, liquid);
        for frame in 0..4 {
            step(&mut app, 1);
            let middle = pixel(&mut app, MIDDLE);
            assert!(middle[0] < 110, "{name}, frame {frame}: {middle:?}");
        }
        assert_sound(&app);
    }
}

/// The same with pipelines that are compiled in the background, until nothing is waited for.
fn assert_never_gone_meanwhile(changes: &[(&str, Change)]) {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = headless_app_in_background(SIZE, |app| {
        fill(app, Color::WHITE, FluidMaterial::INK, |_, it| camera = it);
    })
    .unwrap();
    settle(&mut app).unwrap();
    let liquid = crate::common::only::<FluidParticles>(&mut app);
    let reports = app.world().resource::<PlanReports>().clone();
    let mut waited = 0;
    for (name, change) in changes {
        change(app.world_mut(), camera, liquid);
        let mut ready = 0;
        for frame in 0.. {
            reports.ask();
            step(&mut app, 1);
            let middle = pixel(&mut app, MIDDLE);
            assert!(middle[0] < 110, "{name}, frame {frame}: {middle:?}");
            let views = reports.latest();
            let surfaces = views.iter().flat_map(|view| &view.surfaces);
            let waiting: Vec<_> = surfaces.filter_map(|it| it.waiting).collect();
            assert!(frame < 3000, "{name} waits for {waiting:?}");
            waited += usize::from(!waiting.is_empty());
            ready = if waiting.is_empty() { ready + 1 } else { 0 };
            if ready == 4 {
                break;
            }
        }
    }
    assert!(waited > 0, "something is waited for");
}

const OF_THE_CAMERA: &[(&str, Change)] = &[
    ("no multisampling", |world, camera, _| {
        world.entity_mut(camera).insert(Msaa::Off);
    }),
    ("multisampling", |world, camera, _| {
        world.entity_mut(camera).insert(Msaa::Sample4);
    }),
    ("layers", |world, camera, liquid| {
        for entity in [camera, liquid] {
            world.entity_mut(entity).insert(RenderLayers::layer(3));
        }
    }),
    ("tonemapping", |world, camera, _| {
        world.entity_mut(camera).insert(Tonemapping::None);
    }),
    ("without a viewport of its own", |world, camera, _| {
        world.get_mut::<Camera>(camera).unwrap().viewport = Some(Viewport {
            physical_position: UVec2::ZERO,
            physical_size: SIZE,
            ..default()
        });
    }),
    ("settings", |world, camera, _| {
        world.entity_mut(camera).insert(ScreenSpaceFluid::FAST);
    }),
    ("no high dynamic range", |world, camera, _| {
        world.entity_mut(camera).remove::<Hdr>();
    }),
    ("high dynamic range", |world, camera, _| {
        world.entity_mut(camera).insert(Hdr);
    }),
];

const OF_THE_FLUID: &[(&str, Change)] = &[
    ("the first droplet", |world, _, liquid| {
        let mut fluid = world.get_mut::<FluidParticles>(liquid).unwrap();
        fluid.positions.push(vec3(0.0, 0.8, 0.0));
    }),
    ("the terms of its medium", |world, _, liquid| {
        let mut material = world.get_mut::<FluidMaterial>(liquid).unwrap();
        material.medium.emission = LinearRgba::rgb(0.01, 0.0, 0.0);
    }),
    ("radius", |world, _, liquid| {
        world.get_mut::<FluidParticles>(liquid).unwrap().radius = 0.04;
    }),
    ("kernel", |world, _, liquid| {
        let kernel = SurfaceKernel {
            neighbor_radius: 3.0,
            ..default()
        };
        world.entity_mut(liquid).insert(kernel);
    }),
    ("a second fluid", |world, _, _| {
        world.spawn(drop_of(FluidMaterial::HONEY, vec3(1.0, 0.5, -4.0)));
    }),
    ("a second fluid of ink", |world, _, _| {
        world.spawn(drop_of(FluidMaterial::INK, vec3(-0.5, 0.5, -4.0)));
    }),
    ("the fluid anew", |world, _, liquid| {
        world.despawn(liquid);
        world.spawn(drop_of(FluidMaterial::INK, Vec3::NEG_Z * 3.0));
    }),
];

#[test]
fn ink_stays_through_changes_of_the_camera() {
    assert_never_gone(OF_THE_CAMERA);
}

#[test]
fn ink_stays_through_changes_of_the_fluid() {
    assert_never_gone(OF_THE_FLUID);
}

#[test]
fn ink_stays_while_pipelines_are_compiled_in_the_background() {
    assert_never_gone_meanwhile(OF_THE_CAMERA);
    assert_never_gone_meanwhile(OF_THE_FLUID);
}

#[test]
fn a_debug_view_is_shown_at_once_and_is_gone_at_once() {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, it| camera = it);
    for view in [FluidDebugView::BulkFront, FluidDebugView::Normals] {
        app.world_mut().entity_mut(camera).insert(view);
        for _ in 0..3 {
            step(&mut app, 1);
            assert_ne!(pixel(&mut app, MIDDLE), [255; 4]);
        }
    }
    app.world_mut()
        .entity_mut(camera)
        .remove::<FluidDebugView>();
    for _ in 0..3 {
        step(&mut app, 1);
        assert!(pixel(&mut app, MIDDLE)[0] < 110);
    }
}

#[test]
fn hidden_liquid_is_gone_and_comes_back_at_once() {
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, _| {});
    let liquid = crate::common::only::<FluidParticles>(&mut app);
    for visibility in [Visibility::Hidden, Visibility::Visible] {
        app.world_mut().entity_mut(liquid).insert(visibility);
        for _ in 0..3 {
            step(&mut app, 1);
            let is_there = pixel(&mut app, MIDDLE)[0] < 110;
            assert_eq!(is_there, visibility == Visibility::Visible);
        }
    }
}

#[test]
fn a_camera_that_comes_back_draws_the_liquid() {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, it| camera = it);
    for _ in 0..2 {
        app.world_mut().despawn(camera);
        step(&mut app, 2);
        let stage = app.world().resource::<Stage>().image.clone();
        let new = (
            Camera3d::default(),
            ScreenSpaceFluid::default(),
            RenderTarget::from(stage),
        );
        camera = app.world_mut().spawn(new).id();
        step(&mut app, 2);
        assert!(pixel(&mut app, MIDDLE)[0] < 110);
        assert_sound(&app);
    }
}

/// To an image of another size and format, and back.
#[test]
fn the_target_may_change() {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, it| camera = it);
    let stage = app.world().resource::<Stage>().image.clone();
    for size in [uvec2(1, 1), uvec2(64, 300)] {
        let mut image = Image::new_target_texture(
            size.x,
            size.y,
            bevy::render::render_resource::TextureFormat::Rgba16Float,
            None,
        );
        image.asset_usage = RenderAssetUsages::all();
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        app.world_mut()
            .entity_mut(camera)
            .insert(RenderTarget::from(image));
        step(&mut app, 2);
        assert_sound(&app);
    }
    app.world_mut()
        .entity_mut(camera)
        .insert(RenderTarget::from(stage));
    for _ in 0..3 {
        step(&mut app, 1);
        assert!(pixel(&mut app, MIDDLE)[0] < 110);
    }
}

/// In the background too: rain is there in every frame after its target has changed.
#[test]
fn rain_stays_while_its_target_changes() {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = headless_app_in_background(SIZE, |app| {
        fill(app, Color::BLACK, FluidMaterial::INK, |world, it| {
            camera = it;
            world.entity_mut(camera).insert(bright_rain(100.0));
        });
    })
    .unwrap();
    settle(&mut app).unwrap();
    let wet = |app: &mut App| {
        let picture = capture(app).unwrap();
        picture.pixels().filter(|pixel| pixel.0[1] > 0).count()
    };
    let before = wet(&mut app);
    assert!(before > 3000, "{before}");
    let changes: [fn(EntityWorldMut); 4] = [
        |mut camera| {
            camera.insert(Msaa::Off);
        },
        |mut camera| {
            camera.insert(Msaa::Sample4);
        },
        |mut camera| {
            camera.remove::<Hdr>();
        },
        |mut camera| {
            camera.insert(Hdr);
        },
    ];
    for (index, change) in changes.into_iter().enumerate() {
        change(app.world_mut().entity_mut(camera));
        for frame in 0..4 {
            step(&mut app, 1);
            let now = wet(&mut app);
            assert!(
                2 * now > before,
                "change {index}, frame {frame}: {now} of {before}"
            );
        }
    }
}

/// A second camera, in a window that is made smaller, minimised and closed.
#[test]
fn a_window_that_is_minimised_or_closed_stops_no_liquid_elsewhere() {
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, _| {});
    let window = app.world_mut().spawn(Window::default()).id();
    let target = RenderTarget::Window(WindowRef::Entity(window));
    let other = (Camera3d::default(), ScreenSpaceFluid::default(), target);
    let other = app.world_mut().spawn(other).id();
    let sizes = [uvec2(640, 480), uvec2(1, 1), UVec2::ZERO, uvec2(320, 200)];
    for size in sizes.map(Some).into_iter().chain([None]) {
        match size {
            Some(size) => {
                let mut window = app.world_mut().get_mut::<Window>(window).unwrap();
                window.resolution.set_physical_resolution(size.x, size.y);
            }
            None => {
                app.world_mut().despawn(window);
            }
        }
        for _ in 0..3 {
            step(&mut app, 1);
            assert!(pixel(&mut app, MIDDLE)[0] < 110, "{size:?}");
        }
        assert_sound(&app);
    }
    assert!(app.world().get_entity(other).is_ok());
}

/// Sixteen times in a row, as a lava lamp does: the same surface, textures and pipelines.
#[test]
fn a_material_may_change_in_every_frame() {
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |_, _| {});
    let liquid = crate::common::only::<FluidParticles>(&mut app);
    let state = |app: &App| {
        let surfaces = crate::common::view_surfaces(app).unwrap().surfaces.clone();
        let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
        let memory = app.world().resource::<TextureMemory>().bytes();
        (surfaces, cache.pipelines().count(), memory)
    };
    let change = |app: &mut App, i: i32| {
        let mut material = app.world_mut().get_mut::<FluidMaterial>(liquid).unwrap();
        material.medium.absorption_color = LinearRgba::rgb(1.0, 1.0 - 0.02 * i as f32, 1.0);
        material.refractive_index = 1.3 + 0.01 * i as f32;
        step(app, 1);
    };
    change(&mut app, 0);
    settle(&mut app).unwrap();
    let before = state(&app);
    for i in 1..16 {
        change(&mut app, i);
        assert!(state(&app) == before, "frame {i}");
    }
}

/// The eye goes down through the surface of a pool, a centimetre a frame.
#[test]
fn the_waterline_passes_the_eye_without_a_flash() {
    let mut camera = Entity::PLACEHOLDER;
    let mut app = headless_app(SIZE, |app| {
        app.add_plugins(FluidPlugin::default())
            .insert_resource(ClearColor(Color::srgb(1.0, 0.0, 1.0)));
        let world = app.world_mut();
        let view = (Camera3d::default(), ScreenSpaceFluid::default(), Msaa::Off);
        camera = world.spawn(view).id();
        let (low, high) = (vec3(-1.6, -1.0, -2.6), vec3(1.6, 0.0, 0.6));
        let pool = fluid_stage::lattice(low, high, 0.08);
        world.spawn((FluidParticles::new(pool, 0.04), FluidMaterial::WATER));
        let grey = unlit(Color::srgb(0.5, 0.5, 0.5));
        for (size, at) in [
            (vec3(9.0, 9.0, 0.1), vec3(0.0, 0.0, -2.8)),
            (vec3(9.0, 0.1, 9.0), vec3(0.0, -1.1, 0.0)),
            (vec3(0.1, 9.0, 9.0), vec3(-1.75, 0.0, 0.0)),
            (vec3(0.1, 9.0, 9.0), vec3(1.75, 0.0, 0.0)),
        ] {
            paint(world, size, grey.clone(), at);
        }
    })
    .unwrap();
    settle(&mut app).unwrap();
    // Mean light of the lower half, and how much of it is the sky's colour: a hole.
    let mut seen = Vec::new();
    for i in 0..=24 {
        let y = 0.12 - 0.01 * i as f32;
        let at = Transform::from_xyz(0.0, y, 0.0);
        app.world_mut().entity_mut(camera).insert(at);
        step(&mut app, 1);
        assert_sound(&app);
        let picture = capture(&mut app).unwrap();
        let below = || {
            picture
                .enumerate_pixels()
                .filter(|(_, y, _)| *y > SIZE.y / 2)
        };
        let sum: u64 = below().map(|(_, _, pixel)| u64::from(pixel.0[1])).sum();
        let holes = below().filter(|(_, _, pixel)| pixel.0[1] < 20).count();
        seen.push((sum as f64 / below().count() as f64, holes));
    }
    for (frame, pair) in seen.windows(2).enumerate() {
        let step = (pair[1].0 - pair[0].0).abs();
        // 28.7: the smoother the surface, the fewer frames it takes from above it to below.
        assert!(step < 30.0, "between {frame} and the next: {seen:?}");
    }
    assert!(seen.iter().all(|(_, holes)| *holes < 40), "{seen:?}");
}
