//! Words on boards: letters drawn on the CPU.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use bevy::{
    asset::RenderAssetUsages,
    light::NotShadowCaster,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use fluid_stage::scenery::Scenery;

/// Height of a line in texels and in metres.
const LINE: (f32, f32) = (48.0, 0.115);

/// A word in front of a shelf, centred at `at`.
pub(crate) fn label(scenery: &mut Scenery, text: &str, at: Vec3) {
    let image = draw(text);
    let size = image.size().as_vec2() * LINE.1 / LINE.0;
    let texture = scenery.images.add(image);
    let mesh = scenery.meshes.add(Rectangle::from_size(size));
    let material = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.03, 0.03, 0.04),
        base_color_texture: Some(texture),
        unlit: true,
        alpha_mode: AlphaMode::Blend,
        ..default()
    });
    scenery.commands.spawn((
        Name::new(text.to_string()),
        Mesh3d(mesh),
        MeshMaterial3d(material),
        Transform::from_translation(at),
        NotShadowCaster,
    ));
}

/// White letters on a transparent background; the material colours them.
fn draw(text: &str) -> Image {
    let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT)
        .expect("a font that comes with its crate");
    let scaled = font.as_scaled(PxScale::from(LINE.0));
    let mut glyphs: Vec<Glyph> = Vec::new();
    let mut x = 0.0;
    for letter in text.chars() {
        let id = font.glyph_id(letter);
        if let Some(last) = glyphs.last() {
            x += scaled.kern(last.id, id);
        }
        glyphs.push(id.with_scale_and_position(LINE.0, point(x, scaled.ascent())));
        x += scaled.h_advance(id);
    }
    let (width, height) = (x.ceil() as u32 + 2, scaled.height().ceil() as u32);
    let mut data = vec![0; (4 * width * height) as usize];
    for outline in glyphs
        .into_iter()
        .filter_map(|glyph| font.outline_glyph(glyph))
    {
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, coverage| {
            let (x, y) = (corner.x as i32 + dx as i32, corner.y as i32 + dy as i32);
            if (0..width as i32).contains(&x) && (0..height as i32).contains(&y) {
                let alpha = &mut data[4 * (y as usize * width as usize + x as usize) + 3];
                *alpha = (*alpha).max((255.0 * coverage) as u8);
            }
        });
    }
    for texel in data.chunks_exact_mut(4) {
        texel[..3].fill(255);
    }
    Image::new(
        Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        data,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    )
}
