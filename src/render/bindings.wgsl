#define_import_path bevy_fluid::render::bindings

#import bevy_fluid::render::types::GpuBody
#import bevy_render::view::View

// Bindings shared by every pass of a body in a view.
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> body: GpuBody;
// The opaque scene's depth: (nearest, farthest) of a pixel's samples.
@group(0) @binding(2) var scene_depth: texture_2d<f32>;
