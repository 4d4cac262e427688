//! What a game changes at run time, one frame at a time.

use super::*;
use crate::common::assert_sound;
use bevy::{
    asset::RenderAssetUsages,
    camera::{Hdr, RenderTarget, Viewport},
    core_pipeline::tonemapping::Tonemapping,
};
use bevy_fluid::settings::FluidDebugView;
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

#[test]
fn ink_stays_through_changes_of_the_camera() {
    assert_never_gone(&[
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
    ]);
}

#[test]
fn ink_stays_through_changes_of_the_fluid() {
    assert_never_gone(&[
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
    ]);
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
