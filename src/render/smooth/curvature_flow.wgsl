// One step of curvature flow: van der Laan, Green & Sainz, "Screen Space Fluid Rendering with
// Curvature Flow", 2009. Depth moves along the view by its mean curvature.

#import bevy_fluid::render::frame::{frame, view}
#import bevy_fluid::render::functions::device_depth
#import bevy_fluid::render::smooth::window::{
    Window, accept, raw_tap_at, smoothing, valid_layers, view_depths, window_at,
}

// View depths beside the centre; across a step or a silhouette the surface goes on level.
fn depth_at(window: Window, offset: vec2<i32>) -> vec2<f32> {
    let value = raw_tap_at(window, offset);
    let z = view_depths(window.map, value.xy);
    let same = valid_layers(value.xy) & abs(z - window.depth) <= vec2(smoothing.range);
    return select(window.depth, z, same);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let window = window_at(position);
    if !any(window.valid) {
        return window.center;
    }
    let z = window.depth;
    let left = depth_at(window, vec2(-1, 0));
    let right = depth_at(window, vec2(1, 0));
    let up = depth_at(window, vec2(0, -1));
    let down = depth_at(window, vec2(0, 1));
    let diagonal = depth_at(window, vec2(1, 1)) + depth_at(window, vec2(-1, -1))
        - depth_at(window, vec2(1, -1)) - depth_at(window, vec2(-1, 1));
    // Derivatives by the pixel.
    let zx = 0.5 * (right - left);
    let zy = 0.5 * (down - up);
    let zxx = right - 2.0 * z + left;
    let zyy = down - 2.0 * z + up;
    let zxy = 0.25 * diagonal;
    // C_x, C_y of the paper: the extent of a pixel at depth 1; `abs`, because a mirrored view has
    // negative focal lengths.
    let focal = abs(vec2(view.clip_from_view[0][0], view.clip_from_view[1][1]));
    let c = 2.0 / (frame.view_size * focal);
    let cx2 = c.x * c.x;
    let cy2 = c.y * c.y;
    // A pixel grows with depth in perspective only.
    let grows = select(1.0, 0.0, view.clip_from_view[3][3] == 1.0);
    let s = mix(vec2(1.0), z, grows);
    let d = cy2 * zx * zx + cx2 * zy * zy + cx2 * cy2 * s * s;
    let dx = 2.0 * (cy2 * zx * zxx + cx2 * zy * zxy + cx2 * cy2 * s * zx * grows);
    let dy = 2.0 * (cy2 * zx * zxy + cx2 * zy * zyy + cx2 * cy2 * s * zy * grows);
    let ex = 0.5 * zx * dx - zxx * d;
    let ey = 0.5 * zy * dy - zyy * d;
    let h = (c.y * ex + c.x * ey) / (2.0 * max(d, vec2(1e-30)) * sqrt(max(d, vec2(1e-30))));
    // The paper's curvature is taken by the pixel: per metre it is h over the pixel's footprint,
    // and the steps are in units of that footprint squared, where an explicit flow is stable.
    let moved = z - smoothing.flow_step * h * 0.5 * (c.x + c.y) * s;
    let fitted = vec2(device_depth(window.map, moved.x), -device_depth(window.map, moved.y));
    return vec4(accept(window, fitted, vec2(true)), 0.0, 0.0);
}
