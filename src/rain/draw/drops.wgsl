// Individually drawn drops, as antialiased streaks: near the eye, where drops can be distinguished,
// or everywhere, as the reference for billboards.

#import bevy_fluid::rain::draw::births::diameter_of_birth
#import bevy_fluid::rain::draw::common::{
    PI, clip_from_relative, in_fog, is_sheltered, lamplight, over, metres_per_pixel, pcg, rain, ray_to,
    scene_view_depth, surroundings, uniform_of, view,
}
#import bevy_fluid::rain::draw::types::{LARGEST, SPEED_STEP, Voxel}

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

// Margin around a streak, in pixels: half a pixel for its soft edge; with multisampling, also the
// distance of samples from the pixel's centre, whose opacity is used for all of them.
#ifdef MULTISAMPLED
const EDGE: f32 = 1.2;
#else
const EDGE: f32 = 0.5;
#endif

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
    let slot = pcg(cell.hash ^ pcg((index / 4u) ^ pcg(rain.seed)));
    let volume = cell.size * cell.size * cell.size;
    // The first slots hold the drops that are added first as rain grows denser.
    let birth = (f32(index / 4u) + uniform_of(pcg(slot ^ 0x85157AF5u))) / volume;
    let random = vec3(
        uniform_of(slot), uniform_of(pcg(slot ^ 0x3C6EF372u)), uniform_of(pcg(slot ^ 0xDAA66D2Bu)),
    );
    let diameter = min(diameter_of_birth(birth, random), LARGEST);
    let falls = speed(diameter);
    let start = uniform_of(pcg(slot ^ 0x68E31DA4u));
    // Every cell on the drop's path holds a copy of it; this selects the one now in this cell.
    // A metre is a whole number of cells: at any height rows are exact.
    let row = cell.tile * i32(round(1.0 / cell.size)) + i32(round(cell.fraction / cell.size));
    let fallen = falls * rain.seconds / cell.size;
    let left = start - fract(fallen);
    let height = fract(left);
    let copy = pcg(slot ^ pcg(u32(row + i32(floor(fallen)) - i32(floor(left)))));
    // The last drop is present with the probability that gives the mean number.
    if f32(index / 4u) + uniform_of(pcg(copy ^ 0x1B56C4E9u)) >= rain.drops * volume {
        return nothing();
    }
    // Columns of cells lean as drops of mean speed fall. A faster or slower drop drifts through its
    // column, entering on one side as it leaves on the other.
    let drift = rain.drift * (1.0 - falls / rain.mean_speed) / cell.size;
    let sideways = fract(vec2(uniform_of(copy), uniform_of(pcg(copy ^ 0xB5297A4Du))) + drift) - 0.5;
    let head = cell.center + (vec3(sideways.x, 0.0, sideways.y)
        + rain.axis / rain.axis.y * (height - 0.5)) * cell.size;
    let way = vec3(-rain.wind.x, falls, -rain.wind.y) * rain.exposure;
    let tail = head + way;
    let middle = head + 0.5 * way;

    let a = clip_from_relative(head);
    let b = clip_from_relative(tail);
    let view_depth = dot(middle, rain.forward);
    // Distances as for billboards: across the fall, and along the ray.
    let off = middle - dot(middle, rain.axis) * rain.axis;
    let along_view = dot(rain.forward, rain.axis);
    let is_perspective = rain.perspective == 1u;
    let far = select(view_depth, length(middle), is_perspective);
    let across = select(view_depth * sqrt(max(1.0 - along_view * along_view, 0.0)), length(off), is_perspective);
    let is_far = far > rain.drops_reach || across > rain.drops_end;
    // Nearer than the near plane, or behind.
    if a.z > a.w || b.z > b.w || a.w <= 0.0 || b.w <= 0.0 || is_far || is_sheltered(middle, cell.shelters) {
        return nothing();
    }
    let screen = 0.5 * view.main_pass_viewport.zw;
    let from_pixel = a.xy / a.w * screen;
    let to_pixel = b.xy / b.w * screen;
    let drop = 1e-3 * diameter / metres_per_pixel(view_depth);
    let width = max(drop, 1.0);
    var along = to_pixel - from_pixel;
    let pixels = length(along);
    along = select(vec2(0.0, 1.0), along / pixels, pixels > 1e-4);
    let size = vec2(width, max(pixels, width));

    var out: Varying;
    out.half_size = 0.5 * size;
    // The drop's cross section, spread over the covered pixels. Off the middle of the view, rays
    // meet the screen at an angle, and the drop covers more of it.
    let slant = select(1.0, length(middle) / view_depth, rain.perspective == 1u);
    out.opacity = 0.25 * PI * drop * drop * slant / (size.x * size.y);
    out.view_depth = view_depth;
    let corner = vec2(f32(index & 1u), f32((index >> 1u) & 1u)) * 2.0 - 1.0;
    out.place = corner * (out.half_size + EDGE);
    let pixel = 0.5 * (from_pixel + to_pixel)
        + vec2(along.y, -along.x) * out.place.x + along * out.place.y;
    let depth = 0.5 * (a.z / a.w + b.z / b.w);
    out.clip = vec4(pixel / screen, depth, 1.0);
    let ray = ray_to(middle);
    out.color = in_fog(surroundings(ray) + lamplight(middle, ray, cell.lamps), middle, ray);
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
