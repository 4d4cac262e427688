// What a fluid shader knows of the screen, and the bindings that all passes of a surface share.
//
// Pixels are counted from the upper left of the view. A surface's textures hold the part of the
// view that it may cover, with a margin that is never drawn to.
#define_import_path bevy_fluid::render::frame

#import bevy_fluid::render::types::GpuSurface
#import bevy_render::view::View

struct FluidFrame {
    // Of the view.
    view_size: vec2<f32>,
    // The view's upper left pixel in the camera's target.
    view_origin: vec2<f32>,
    // Of the surface's textures.
    size: vec2<i32>,
    // Their upper left texel's pixel in the view.
    origin: vec2<i32>,
    // The view's upper left pixel in the scene's depth, and how that was sampled.
    scene_origin: vec2<i32>,
    multisampled: u32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> frame: FluidFrame;
@group(0) @binding(2) var<uniform> surface: GpuSurface;
// The opaque scene's depth. Multisampled: (nearest, farthest) of a pixel's samples.
@group(0) @binding(3) var scene_depth: texture_2d<f32>;
// For each tile, whether it holds (bulk, any liquid).
@group(0) @binding(4) var tiles: texture_2d<f32>;
