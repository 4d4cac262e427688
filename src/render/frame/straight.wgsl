// The straight path of a pixel's ray through the liquid.
#define_import_path bevy_fluid::render::straight

#import bevy_fluid::render::functions::{
    has_back, has_front, nearest_scene_depth, view_from_device,
}

// (front, back) of one class at a pixel in device depth, cut short by opaque things.
fn straight_span(layers: vec2<f32>, pixel: vec2<i32>) -> vec2<f32> {
    if !has_front(layers) || !has_back(layers) {
        return vec2(0.0);
    }
    return vec2(layers.x, min(max(-layers.y, nearest_scene_depth(pixel)), layers.x));
}

fn span_length(span: vec2<f32>, ndc: vec2<f32>) -> f32 {
    if span.x <= 0.0 {
        return 0.0;
    }
    return distance(view_from_device(ndc, span.y), view_from_device(ndc, span.x));
}

// From front to back of both classes in m; where bulk and spray overlap it counts once.
fn layered_length(
    bulk_layers: vec2<f32>,
    spray_layers: vec2<f32>,
    pixel: vec2<i32>,
    ndc: vec2<f32>,
) -> f32 {
    let bulk = straight_span(bulk_layers, pixel);
    let spray = straight_span(spray_layers, pixel);
    let both = vec2(min(bulk.x, spray.x), max(bulk.y, spray.y));
    var length = span_length(bulk, ndc) + span_length(spray, ndc);
    if both.x > both.y {
        length -= span_length(both, ndc);
    }
    return length;
}
