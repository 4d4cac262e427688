//! Debug views that show an amount show the right one.

use crate::common::{BULK, Lens, RAW, SPRAY, View, fluid, look, pixels, pour, read, show, surface};
use bevy::{prelude::*, render::render_resource::TextureFormat};
use bevy_fluid::{prelude::*, render::Layers, settings::FluidDebugView};
use fluid_stage::capture;

/// A sphere of radius 1 m fills it but for a margin. The middle pixel sees its centre.
const PARALLEL: View = View::new(
    33,
    Lens::Orthographic {
        height: 2.2,
        near: 0.1,
        far: 20.0,
    },
);
const MIDDLE: UVec2 = UVec2::splat(16);
const CENTER: Vec3 = vec3(0.0, 0.0, -3.0);

/// The colour at a pixel, linear.
fn colors(app: &mut App) -> impl Fn(UVec2) -> Vec3 + use<> {
    let picture = capture(app).unwrap();
    move |pixel| {
        let [r, g, b, _] = picture.get_pixel(pixel.x, pixel.y).0;
        Color::srgb_u8(r, g, b).to_linear().to_vec3()
    }
}

/// Black, violet, red, orange, white.
fn heat(amount: f32) -> Vec3 {
    let stops = [
        Vec3::ZERO,
        vec3(0.18, 0.02, 0.35),
        vec3(0.7, 0.03, 0.12),
        vec3(0.95, 0.45, 0.02),
        Vec3::ONE,
    ];
    let t = 4.0 * amount.clamp(0.0, 1.0);
    let i = (t as usize).min(3);
    stops[i].lerp(stops[i + 1], t - i as f32)
}

#[track_caller]
fn assert_color(seen: Vec3, wanted: Vec3) {
    let error = (seen - wanted).abs().max_element();
    assert!(error < 0.012, "{seen}, not {wanted}");
}

#[test]
fn overdraw_counts_the_splats_of_both_classes() {
    let mut app = show(&PARALLEL, RAW, |_| {});
    look(&mut app, FluidDebugView::Overdraw);
    for kernel in [BULK, SPRAY] {
        for count in [1, 4, 16, 64] {
            pour(&mut app, fluid(&vec![CENTER; count], 1.0, kernel));
            let data = read(&app, Layers::overdraw);
            assert_eq!(data.format, TextureFormat::R32Float);
            let counts: &[f32] = bytemuck::cast_slice(&data.bytes);
            for pixel in pixels(PARALLEL.size) {
                let from_middle = (pixel.as_vec2() - MIDDLE.as_vec2()).length() * 2.2 / 33.0;
                let found = counts[(33 * pixel.y + pixel.x) as usize];
                // Pixels about the rim are left to rounding.
                if (from_middle - 1.0).abs() > 1e-3 {
                    let wanted = if from_middle < 1.0 { count as f32 } else { 0.0 };
                    assert_eq!(found, wanted, "{pixel}");
                }
            }
            let color = colors(&mut app)(MIDDLE);
            assert_color(color, heat(0.25 + (count as f32).log2() / 8.0));
        }
    }
    look(&mut app, FluidDebugView::Normals);
    assert!(surface(&app).1.overdraw().is_none(), "no one looks");
}

#[test]
fn thickness_is_the_chord_over_the_depth_of_the_box() {
    let mut app = show(&PARALLEL, RAW, |_| {});
    look(&mut app, FluidDebugView::Thickness);
    for kernel in [BULK, SPRAY] {
        pour(&mut app, fluid(&[CENTER], 1.0, kernel));
        let color = colors(&mut app);
        for pixel in pixels(PARALLEL.size) {
            let from_middle = (pixel.as_vec2() - MIDDLE.as_vec2()).length() * 2.2 / 33.0;
            if from_middle < 0.99 {
                assert_color(color(pixel), heat((1.0 - from_middle * from_middle).sqrt()));
            } else if from_middle > 1.01 {
                assert_eq!(color(pixel), Vec3::ZERO);
            }
        }
    }
    let particles = FluidParticles::new(vec![CENTER], 1.0);
    pour(&mut app, (particles, BULK, FluidMaterial::MILK));
    assert_color(colors(&mut app)(MIDDLE), Vec3::ONE);
}

#[test]
fn exit_rays_go_where_light_goes() {
    let mut app = show(&PARALLEL, ScreenSpaceFluid::DEFAULT, |_| {});
    look(&mut app, FluidDebugView::ExitRay);
    pour(&mut app, fluid(&[CENTER], 1.0, SPRAY));
    let color = colors(&mut app);
    // Through the middle of a ball light passes straight on, to what is far away; beside it the
    // ball is a lens.
    for offset in [0, 3, 6, -6] {
        let pixel = MIDDLE.as_ivec2() + IVec2::X * offset;
        let sine = offset as f32 * 2.2 / 33.0;
        let turn = 2.0 * (sine.asin() - (sine / 1.333).asin());
        let wanted = vec3(0.5 - 0.5 * turn.sin(), 0.5, 0.5 - 0.5 * turn.cos());
        assert_color(color(pixel.as_uvec2()), wanted);
    }
    // What bends nothing looks straight through.
    let smoke = FluidMaterial {
        refractive_index: 1.0,
        ..FluidMaterial::WATER
    };
    pour(
        &mut app,
        (FluidParticles::new(vec![CENTER], 1.0), BULK, smoke),
    );
    assert_color(colors(&mut app)(MIDDLE), vec3(0.25, 0.25, 0.0));
}
