// Every drop by itself, as an antialiased streak: the method that billboards stand in for.

#import bevy_fluid::rain::draw::common::{
    PI, clip_from_relative, is_sheltered, lamplight, over, pixels_per_metre, rain, ray_to,
    scene_view_depth, surroundings, view,
}
#import bevy_fluid::rain::draw::types::{SPEED_STEP, Voxel}

struct Varying {
    @builtin(position) clip: vec4<f32>,
    // From the streak's middle, in pixels: across and along.
    @location(0) place: vec2<f32>,
    // Half of the streak's width and length in pixels.
    @location(1) @interpolate(flat) half_size: vec2<f32>,
    @location(2) @interpolate(flat) color: vec3<f32>,
    @location(3) @interpolate(flat) opacity: f32,
    @location(4) @interpolate(flat) view_depth: f32,
}

// PCG (Jarzynski and Olano 2020).
fn hash(seed: u32) -> u32 {
    let state = seed * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn uniform_of(bits: u32) -> f32 {
    return f32(bits >> 8u) / 16777216.0;
}

// Twin of `sample_diameter` in `drops.rs`. Unit: mm.
fn sample_diameter(random: f32) -> f32 {
    let low = exp(-rain.slope * rain.smallest);
    let high = exp(-rain.slope * rain.largest);
    return clamp(-log(low + (high - low) * random) / rain.slope, rain.smallest, rain.largest);
}

// m/s.
fn speed(diameter: f32) -> f32 {
    let at = diameter / SPEED_STEP;
    let i = min(u32(at), 62u);
    let low = rain.speeds[i / 4u][i % 4u];
    let high = rain.speeds[(i + 1u) / 4u][(i + 1u) % 4u];
    return mix(low, high, at - f32(i));
}

fn nothing() -> Varying {
    var out: Varying;
    out.clip = vec4(2.0, 2.0, 2.0, 1.0);
    return out;
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, cell: Voxel) -> Varying {
    let slot = hash(cell.hash ^ hash(index / 4u));
    let diameter = sample_diameter(uniform_of(slot));
    let falls = speed(diameter);
    let start = uniform_of(hash(slot ^ 0x68E31DA4u));
    // A copy of the drop stands in every metre of its way; which one is in this cell by now?
    let fallen = falls * rain.seconds;
    let left = start - fract(fallen);
    let height = fract(left);
    let copy = hash(slot ^ hash(u32(cell.tile + i32(floor(fallen)) - i32(floor(left)))));
    let sideways = vec2(uniform_of(copy), uniform_of(hash(copy ^ 0xB5297A4Du)));
    var head = cell.center + vec3(sideways.x, height, sideways.y) - 0.5;
    // Wind: sideways as it falls, about the eye's height.
    head -= vec3(rain.wind.x, 0.0, rain.wind.y) / falls * head.y;
    let way = vec3(-rain.wind.x, falls, -rain.wind.y) * rain.exposure;
    let tail = head + way;
    let middle = head + 0.5 * way;

    let a = clip_from_relative(head);
    let b = clip_from_relative(tail);
    let view_depth = dot(middle, rain.forward);
    let is_far = select(view_depth, length(middle), rain.perspective == 1u) > rain.distance;
    // Nearer than the near plane, or behind.
    if a.z > a.w || b.z > b.w || a.w <= 0.0 || b.w <= 0.0 || is_far || is_sheltered(middle) {
        return nothing();
    }
    let screen = 0.5 * view.main_pass_viewport.zw;
    let from_pixel = a.xy / a.w * screen;
    let to_pixel = b.xy / b.w * screen;
    let scale = pixels_per_metre(view_depth);
    let drop = 1e-3 * diameter * scale;
    let width = max(drop, 1.0);
    var along = to_pixel - from_pixel;
    let pixels = length(along);
    along = select(vec2(0.0, 1.0), along / pixels, pixels > 1e-4);
    let size = vec2(width, max(pixels, width));

    var out: Varying;
    out.half_size = 0.5 * size;
    // Its cross section, spread over what it covers. Off the middle of the view, the screen is met
    // at an angle, and it covers more of it.
    let slant = select(1.0, length(middle) / view_depth, rain.perspective == 1u);
    out.opacity = 0.25 * PI * drop * drop * slant / (size.x * size.y);
    out.view_depth = view_depth;
    let corner = vec2(f32(index & 1u), f32((index >> 1u) & 1u)) * 2.0 - 1.0;
    // Half a pixel more on each side, for the soft edge.
    out.place = corner * (out.half_size + 0.5);
    let pixel = 0.5 * (from_pixel + to_pixel)
        + vec2(along.y, -along.x) * out.place.x + along * out.place.y;
    let depth = 0.5 * (a.z / a.w + b.z / b.w);
    out.clip = vec4(pixel / screen, depth, 1.0);
    let ray = ray_to(middle);
    out.color = surroundings(ray) + lamplight(middle, ray, cell.lamps);
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let covered = saturate(in.half_size + 0.5 - abs(in.place));
    if scene_view_depth(in.clip.xy) < in.view_depth {
        discard;
    }
    return over(in.color, min(in.opacity * covered.x * covered.y, 1.0));
}
