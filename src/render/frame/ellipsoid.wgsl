// Ellipsoids on screen: placed in view space, bounded tightly, met by rays.
#define_import_path bevy_fluid::render::ellipsoid

#import bevy_fluid::render::frame::{frame, view}
#import bevy_fluid::render::functions::{
    Ray, device_from_view, ndc_from_pixel, ndc_in_textures, pixel_from_ndc, pixel_from_texture,
    view_ray,
}
#import bevy_fluid::render::types::{GpuFluid, INSIDE_FRONT, Splat}

@group(1) @binding(0) var<storage, read> splats: array<Splat>;
@group(1) @binding(1) var<uniform> fluid: GpuFluid;

// An ellipsoid for every pixel of its quad, in one of two forms.
//
// `form` 0, wholly in front of the near plane: a quadric about the projected centre. With X, Y in
// pixels and D in device depth from there, the homogeneous point of the unit sphere's space is
// X·x + Y·y + D·d + (0, 0, 0, 1); it is on the sphere where its form xyz² − w² is zero. A
// projective map takes quadrics to quadrics, and moving the origin to the centre keeps the
// digits.
// `form` 1, cut by the near plane: columns of the map from view space to the unit sphere's, and
// the centre in view space, each in the xyz of the same fields.
struct EllipsoidVertex {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) x: vec4<f32>,
    @location(1) @interpolate(flat) y: vec4<f32>,
    @location(2) @interpolate(flat) d: vec4<f32>,
    // Form 0: projected centre in pixels and device depth.
    @location(3) @interpolate(flat) center: vec3<f32>,
    @location(4) @interpolate(flat) form: u32,
    // Form 0, for the offset o from the projected centre in pixels: 1 − (distance / radius)² of a line
    // of sight from the centre is outline.x + outline.yz · o + bend.xyz · (o.x², o.x o.y, o.y²), and its
    // device depth half way through the ellipsoid chord.x + chord.yz · o from the centre's; chord.w is
    // half the depth that a line through the centre spends inside.
    @location(5) @interpolate(flat) outline: vec3<f32>,
    // w: by how much a ramp at the outline adds up to too large an area, see `place`.
    @location(6) @interpolate(flat) bend: vec4<f32>,
    @location(7) @interpolate(flat) chord: vec4<f32>,
#ifdef MOTION
    // How far the centre has moved in the world, and where it is from the eye.
    @location(8) @interpolate(flat) displacement: vec3<f32>,
    @location(9) @interpolate(flat) from_eye: vec3<f32>,
#endif
}

const PI: f32 = 3.14159265;

struct Intersection {
    hit: bool,
    // (front, −back) as the layers hold them.
    layers: vec2<f32>,
    // Towards the viewer, in view space, not normalised: read by the spray's normals alone.
    front_normal: vec3<f32>,
    back_normal: vec3<f32>,
}

fn axes_matrix(splat: Splat) -> mat3x3<f32> {
    let xx_xy = unpack2x16float(splat.axes.x);
    let xz_yy = unpack2x16float(splat.axes.y);
    let yz_zz = unpack2x16float(splat.axes.z);
    return mat3x3(
        vec3(xx_xy, xz_yy.x),
        vec3(xx_xy.y, xz_yy.y, yz_zz.x),
        vec3(xz_yy.x, yz_zz),
    );
}

fn inverse3(m: mat3x3<f32>) -> mat3x3<f32> {
    let r0 = cross(m[1], m[2]);
    let r1 = cross(m[2], m[0]);
    let r2 = cross(m[0], m[1]);
    return transpose(mat3x3(r0, r1, r2)) * (1.0 / dot(r2, m[2]));
}

fn linear(m: mat4x4<f32>) -> mat3x3<f32> {
    return mat3x3(m[0].xyz, m[1].xyz, m[2].xyz);
}

// Range of a/w over the part of the ellipsoid with w >= near; a and w are rows of the map from
// the unit sphere to clip space. Tangents that touch it in front of `near` bound it, and so does
// the slice at `near`. Empty: (1, −1).
fn bound(a: vec4<f32>, w: vec4<f32>, near: f32) -> vec2<f32> {
    var range = vec2(1e30, -1e30);
    let ww = dot(w.xyz, w.xyz) - w.w * w.w;
    let aw = dot(a.xyz, w.xyz) - a.w * w.w;
    let aa = dot(a.xyz, a.xyz) - a.w * a.w;
    let disc = aw * aw - ww * aa;
    if disc >= 0.0 && ww != 0.0 {
        let root = sqrt(disc);
        for (var i = 0; i < 2; i += 1) {
            let k = (aw + select(root, -root, i == 0)) / ww;
            let tangent = a - k * w;
            let touch = -tangent.xyz * tangent.w / max(dot(tangent.xyz, tangent.xyz), 1e-30);
            if dot(w, vec4(touch, 1.0)) >= near {
                range = vec2(min(range.x, k), max(range.y, k));
            }
        }
    }
    let slope = length(w.xyz);
    if slope > 0.0 {
        let height = (near - w.w) / slope;
        if abs(height) <= 1.0 {
            let axis = w.xyz / slope;
            let along = dot(a.xyz, axis);
            let across = length(a.xyz - along * axis) * sqrt(1.0 - height * height);
            let middle = a.w + height * along;
            range = vec2(
                min(range.x, (middle - across) / near),
                max(range.y, (middle + across) / near),
            );
        }
    }
    return range;
}

// One corner of the quad that bounds a splat on screen. Invisible splats collapse to a point.
fn place(splat_index: u32, corner: u32) -> EllipsoidVertex {
    let splat = splats[splat_index];
    let view_linear = linear(view.view_from_world);
    let local_linear = linear(fluid.world_from_local);
    // Relative to the eye before rotating, so that a scene far from the origin keeps its digits.
    let from_eye = local_linear * splat.center + (fluid.world_from_local[3].xyz - view.world_position);
    let center = view_linear * from_eye;
    let shape = view_linear * local_linear * axes_matrix(splat);
    let axes = shape * splat.scale;

    // Rows of the map from the unit sphere's space to clip space.
    let rows = transpose(view.clip_from_view);
    let x = vec4(rows[0].xyz * axes, dot(rows[0], vec4(center, 1.0)));
    let y = vec4(rows[1].xyz * axes, dot(rows[1], vec4(center, 1.0)));
    let z = vec4(rows[2].xyz * axes, dot(rows[2], vec4(center, 1.0)));
    let w = vec4(rows[3].xyz * axes, dot(rows[3], vec4(center, 1.0)));
    // The least w on the near plane, which is at one of the screen's corners: an oblique plane
    // comes nearer to the eye's on one side than on the other.
    let to_w = transpose(view.view_from_clip)[3];
    let near = 1.0 / (to_w.z + to_w.w + abs(to_w.x) + abs(to_w.y));
    let bound_x = bound(x, w, near * 0.999);
    let bound_y = bound(y, w, near * 0.999);

    var out: EllipsoidVertex;
    let seen = bound_x.x <= bound_x.y && bound_y.x <= bound_y.y;
    // Slightly wider than the exact bound: rounding must not cut off a covered pixel centre. A
    // splat smaller than a pixel still covers the pixel that holds it.
    let pixel = 2.0 / frame.view_size;
    let size = vec2(bound_x.y - bound_x.x, bound_y.y - bound_y.x);
#ifdef COVERAGE
    // Every pixel of which it covers a part.
    let slack = 0.52 * pixel;
#else
    let slack = select(vec2(0.02), vec2(0.52), size < pixel) * pixel;
#endif
    let low = max(vec2(bound_x.x, bound_y.x) - slack, vec2(-1.5));
    let high = min(vec2(bound_x.y, bound_y.y) + slack, vec2(1.5));
    let corner_ndc = select(low, high, vec2((corner & 1u) == 1u, (corner & 2u) == 2u));
    out.position = select(vec4(2.0, 2.0, 0.5, 1.0), vec4(ndc_in_textures(pixel_from_ndc(corner_ndc)), 0.5, 1.0), seen);

#ifdef VIEW_SPACE
    let in_view_space = true;
#else ifdef NONE_CUT
    let in_view_space = false;
#else
    // Some of it has z > w: nearer than the near plane.
    let in_view_space = z.w - w.w + length(z.xyz - w.xyz) >= 0.0;
#endif
    if in_view_space {
        let inverse = inverse3(shape) * (1.0 / splat.scale);
        out.form = 1u;
        out.x = vec4(inverse[0], 0.0);
        out.y = vec4(inverse[1], 0.0);
        out.d = vec4(inverse[2], 0.0);
        out.center = center;
#ifdef VIEW_SPACE
        // The volume that the particle fills at rest, (2r)³, over that of its splat.
        let spacing = 2.0 * fluid.radius / splat.scale;
        let volume = 4.18879 * abs(determinant(axes_matrix(splat)));
        out.x.w = spacing * spacing * spacing / max(volume, 1e-20);
#endif
    } else {
        let device = vec3(x.w, y.w, z.w) / w.w;
        // Device coordinates about the centre, to first order: rows of the map from the sphere.
        let about = transpose(mat3x3(
            x.xyz - device.x * w.xyz, y.xyz - device.y * w.xyz, z.xyz - device.z * w.xyz,
        )) * (1.0 / w.w);
        let sphere = inverse3(about);
        let ndc_per_pixel = vec2(2.0, -2.0) / frame.view_size;
        let perspective = -w.xyz / w.w;
        let dx = sphere[0] * ndc_per_pixel.x;
        let dy = sphere[1] * ndc_per_pixel.y;
        out.form = 0u;
        out.x = vec4(dx, dot(perspective, dx));
        out.y = vec4(dy, dot(perspective, dy));
        out.d = vec4(sphere[2], dot(perspective, sphere[2]));
        out.center = vec3(pixel_from_ndc(device.xy), device.z);
        // The form at the point of a line of sight that is nearest to the centre.
        let middle = vec4(0.0, 0.0, 0.0, 1.0);
        let dd = form(out.d, out.d);
        let along = vec3(form(middle, out.d), form(out.x, out.d), form(out.y, out.d));
        let ratio = along / dd;
        out.chord = vec4(-ratio, inverseSqrt(dd));
        out.outline = -vec3(
            form(middle, middle) - along.x * ratio.x,
            2.0 * (form(middle, out.x) - along.x * ratio.y),
            2.0 * (form(middle, out.y) - along.x * ratio.z),
        );
        let bend = -vec3(
            form(out.x, out.x) - along.y * ratio.y,
            2.0 * (form(out.x, out.y) - along.y * ratio.z),
            form(out.y, out.y) - along.z * ratio.z,
        );
        // Quarters of a pixel are half a pixel wide. Of circles smaller than that, with radius R, a
        // ramp adds up to more than their area, to π(R² + 1/48) in all.
        let area = PI * inverseSqrt(max(bend.x * bend.z - 0.25 * bend.y * bend.y, 1e-12));
        out.bend = vec4(bend, min(1.083 * area / (area + PI / 48.0), 1.0));
    }
    return out;
}

fn intersect(in: EllipsoidVertex) -> Intersection {
#ifdef NONE_CUT
    return intersect_quadric(in);
#else
    if in.form == 0u {
        return intersect_quadric(in);
    }
    return intersect_near(in);
#endif
}

// The unit sphere's quadratic form.
fn form(a: vec4<f32>, b: vec4<f32>) -> f32 {
    return dot(a.xyz, b.xyz) - a.w * b.w;
}

// The normal of the surface through a point `a` of the sphere's space: its polar plane.
fn polar_normal(in: EllipsoidVertex, a: vec4<f32>, ndc: vec2<f32>, depth: f32) -> vec3<f32> {
    let pixels_per_ndc = frame.view_size * vec2(0.5, -0.5);
    let gradient = vec3(vec2(form(a, in.x), form(a, in.y)) * pixels_per_ndc, form(a, in.d));
    let plane = vec4(gradient, -dot(gradient, vec3(ndc, depth)));
    return (plane * view.clip_from_view).xyz;
}

// 1 − (distance / radius)² from the centre: negative where a line of sight misses.
fn within_outline(in: EllipsoidVertex, o: vec2<f32>) -> f32 {
    return in.outline.x + o.x * (in.outline.y + in.bend.x * o.x + in.bend.y * o.y)
        + o.y * (in.outline.z + in.bend.z * o.y);
}

// Both depths from one quadratic.
fn intersect_quadric(in: EllipsoidVertex) -> Intersection {
    var out: Intersection;
    let pixel = pixel_from_texture(in.position);
    var offset = pixel - in.center.xy;
    var within = within_outline(in, offset);
    if within < 0.0 && all(floor(pixel) == floor(in.center.xy)) {
        // Too small for this pixel's centre: the splat is intersected at its own centre, or moving
        // droplets would flicker as they pass the centres of pixels.
        offset = vec2(0.0);
        within = in.outline.x;
    }
    let middle = in.chord.x + dot(in.chord.yz, offset);
    let half_chord = sqrt(max(within, 0.0)) * in.chord.w;
    let front = in.center.z + (middle + half_chord);
    let back = in.center.z + (middle - half_chord);
    // Not beyond an orthographic far plane, and a number at all.
    out.hit = within >= 0.0 && front > 0.0;
    // A front is kept a step below INSIDE_FRONT, which has a meaning of its own.
    out.layers = vec2(min(front, 0.9999999), -clamp(back, 1e-30, 1.0));
    let ndc = ndc_from_pixel(pixel);
    let flat = vec4(0.0, 0.0, 0.0, 1.0) + offset.x * in.x + offset.y * in.y;
    out.front_normal = polar_normal(in, flat + (middle + half_chord) * in.d, ndc, front);
    // Outward is away from the viewer there.
    out.back_normal = -polar_normal(in, flat + (middle - half_chord) * in.d, ndc, back);
    return out;
}

// How much of the pixel's quarters an ellipsoid of form 0 covers, by the distance of their middles
// from its outline.
fn coverage_of(in: EllipsoidVertex) -> vec4<f32> {
    let o = pixel_from_texture(in.position) - in.center.xy;
    let slope = in.outline.yz + 2.0 * in.bend.xz * o + in.bend.yy * o.yx;
    // A quarter of a pixel from there: left and right, above and below.
    let across = vec4(-0.25, 0.25, -0.25, 0.25);
    let down = vec4(-0.25, -0.25, 0.25, 0.25);
    let within = within_outline(in, o) + across * slope.x + down * slope.y
        + (0.0625 * (in.bend.x + in.bend.z) + in.bend.y * across * down);
    let slope_x = slope.x + 2.0 * in.bend.x * across + in.bend.y * down;
    let slope_y = slope.y + 2.0 * in.bend.z * down + in.bend.y * across;
    // Of a circle of radius R, `from_center` is the distance from its centre over R and the slope is
    // twice that over R.
    let from_center = sqrt(max(1.0 - within, vec4(1e-6)));
    let steepness = inverseSqrt(max(slope_x * slope_x + slope_y * slope_y, vec4(1e-12)));
    let distance = 2.0 * from_center * (1.0 - from_center) * steepness;
    return in.bend.w * clamp(0.5 + 2.0 * distance, vec4(0.0), vec4(1.0));
}

// Where a ray passes an ellipsoid, in metres from the ray's start.
struct Chord {
    ray: Ray,
    middle: f32,
    half_length: f32,
    // 1 − q² at the middle, for the distance q from the centre in the unit sphere's space; below
    // 0 the ray misses.
    disc: f32,
}

// In view space (form 1): Haines' form about the point of the ray that is closest to the centre.
fn chord_of(in: EllipsoidVertex) -> Chord {
    let inverse = mat3x3(in.x.xyz, in.y.xyz, in.d.xyz);
    let ray = view_ray(ndc_from_pixel(pixel_from_texture(in.position)));
    let closest = dot(in.center - ray.origin, ray.direction);
    let o = inverse * (ray.origin + closest * ray.direction - in.center);
    let d = inverse * ray.direction;
    let a = dot(d, d);
    let b = -dot(o, d);
    let nearest = o + (b / a) * d;
    let disc = 1.0 - dot(nearest, nearest);
    return Chord(ray, closest + b / a, sqrt(max(disc, 0.0) / a), disc);
}

// Both depths in view space, for rays that may start inside.
fn intersect_near(in: EllipsoidVertex) -> Intersection {
    var out: Intersection;
    let inverse = mat3x3(in.x.xyz, in.y.xyz, in.d.xyz);
    let chord = chord_of(in);
    let ray = chord.ray;
    let t_front = chord.middle - chord.half_length;
    let t_back = chord.middle + chord.half_length;
    // Not behind the near plane altogether, and a number at all.
    out.hit = chord.disc >= 0.0 && t_back > 0.0;

    let back = ray.origin + t_back * ray.direction;
    out.layers.y = -clamp(device_from_view(back).z, 1e-30, 1.0);
    out.back_normal = -(transpose(inverse) * (inverse * (back - in.center)));
    let front = ray.origin + t_front * ray.direction;
    out.layers.x = select(INSIDE_FRONT, min(device_from_view(front).z, 0.9999999), t_front > 0.0);
    out.front_normal = transpose(inverse) * (inverse * (front - in.center));
    return out;
}
