//! What holds for every frame, whatever was asked for.

use bevy::{
    prelude::*,
    render::{
        RenderApp,
        render_resource::{Texture, TextureFormat},
        view::ViewTarget,
    },
};
use bevy_fluid::render::Layers;
use fluid_stage::{TextureData, read_texture, validation_errors};

/// No complaint of the GPU's validation; no NaN and no infinity in any layer, normal, light or
/// exit ray of any view, nor in what the cameras show.
#[track_caller]
pub(crate) fn assert_sound(app: &App) {
    assert_eq!(validation_errors(app), [""; 0]);
    for entity in app.sub_app(RenderApp).world().iter_entities() {
        if let Some(layers) = entity.get::<Layers>() {
            for (name, texture) in [
                ("bulk", layers.bulk()),
                ("bulk normals", layers.bulk_normals()),
                ("spray", layers.spray()),
                ("spray normals", layers.spray_normals()),
                ("radiance", layers.radiance()),
                ("transmission", layers.transmission()),
                ("exits", layers.exits()),
            ] {
                if let Some(texture) = texture {
                    assert_finite(app, name, texture);
                }
            }
        }
        if let Some(target) = entity.get::<ViewTarget>() {
            assert_finite(app, "picture", target.main_texture());
        }
    }
}

#[track_caller]
fn assert_finite(app: &App, name: &str, texture: &Texture) {
    let data = read_texture(app, texture).unwrap();
    for y in 0..data.size.y {
        for x in 0..data.size.x {
            let values = values(&data, x, y);
            assert!(
                values.iter().all(|value| value.is_finite()),
                "{name} at ({x}, {y}): {values:?}"
            );
        }
    }
}

fn values(data: &TextureData, x: u32, y: u32) -> Vec<f32> {
    match data.format {
        TextureFormat::Rg32Float => data.f32x2(x, y).into(),
        TextureFormat::Rg16Float => {
            let halves: [u16; 2] = data.texel(x, y);
            halves
                .map(|half| half::f16::from_bits(half).to_f32())
                .into()
        }
        TextureFormat::Rgba16Float => data.f16x4(x, y).into(),
        // The target of a camera without high dynamic range.
        TextureFormat::Rgba8UnormSrgb => data.u8x4(x, y).map(f32::from).into(),
        // Only the depth of an exit ray is a float.
        TextureFormat::Rgba32Uint => vec![f32::from_bits(data.u32x4(x, y)[1])],
        format => panic!("{format:?} is not looked at"),
    }
}
