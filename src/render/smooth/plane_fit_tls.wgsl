// Planes fitted to points in view space by total least squares: thesis 4.3.

#import bevy_fluid::render::functions::{
    device_from_view, encode_normal, normal_from_slope, view_from_device, view_ray,
}
#import bevy_fluid::render::frame::frame
#import bevy_fluid::render::slopes::one_sided_slope
#import bevy_fluid::render::smooth::window::{
    Window, accept, edge_weight, slant, tap_at, widen, window_at,
}

// Sums of squares in f32 are off by 1e-7: below this their eigenvectors are off by a thousandth.
const SPREAD: f32 = 1e-4;

struct Output {
    @location(0) layers: vec4<f32>,
#ifdef NORMALS
    @location(1) normals: vec4<f32>,
#endif
}

// Weighted sums of points and of their products, about the centre pixel's point.
struct Moments {
    count: f32,
    weight: f32,
    mean: vec3<f32>,
    // xx, yy, zz and xy, yz, zx.
    squares: vec3<f32>,
    products: vec3<f32>,
}

fn add(m: ptr<function, Moments>, point: vec3<f32>, weight: f32) {
    (*m).count += f32(weight > 0.0);
    (*m).weight += weight;
    (*m).mean += weight * point;
    (*m).squares += weight * point * point;
    (*m).products += weight * point * point.yzx;
}

// One Jacobi rotation in the plane of axes p and q; `app`, `aqq`, `apq` of the matrix, `arp` and
// `arq` its products with the third axis.
fn rotate(
    app: ptr<function, f32>, aqq: ptr<function, f32>, apq: ptr<function, f32>,
    arp: ptr<function, f32>, arq: ptr<function, f32>,
    vp: ptr<function, vec3<f32>>, vq: ptr<function, vec3<f32>>,
) {
    if abs(*apq) < 1e-20 {
        return;
    }
    let theta = (*aqq - *app) / (2.0 * *apq);
    let t = select(-1.0, 1.0, theta >= 0.0) / (abs(theta) + sqrt(theta * theta + 1.0));
    let c = inverseSqrt(t * t + 1.0);
    let s = t * c;
    *app -= t * *apq;
    *aqq += t * *apq;
    *apq = 0.0;
    let p = c * *arp - s * *arq;
    *arq = s * *arp + c * *arq;
    *arp = p;
    let v = c * *vp - s * *vq;
    *vq = s * *vp + c * *vq;
    *vp = v;
}

struct Smallest {
    // Unit length.
    eigenvector: vec3<f32>,
    // The middle eigenvalue over the largest: near 0 for points on a line, which lies in every
    // plane about it.
    spread: f32,
}

// Of the eigenvalues of a symmetric matrix: four cyclic Jacobi sweeps.
fn smallest(diagonal: vec3<f32>, products: vec3<f32>) -> Smallest {
    let size = max(max(diagonal.x, max(diagonal.y, diagonal.z)), 1e-30);
    var xx = diagonal.x / size;
    var yy = diagonal.y / size;
    var zz = diagonal.z / size;
    var xy = products.x / size;
    var yz = products.y / size;
    var zx = products.z / size;
    var vx = vec3(1.0, 0.0, 0.0);
    var vy = vec3(0.0, 1.0, 0.0);
    var vz = vec3(0.0, 0.0, 1.0);
    for (var sweep = 0; sweep < 4; sweep += 1) {
        rotate(&xx, &yy, &xy, &zx, &yz, &vx, &vy);
        rotate(&yy, &zz, &yz, &xy, &zx, &vy, &vz);
        rotate(&zz, &xx, &zx, &yz, &xy, &vz, &vx);
    }
    let largest = max(xx, max(yy, zz));
    if zz <= xx && zz <= yy {
        return Smallest(vz, min(xx, yy) / largest);
    }
    return Smallest(select(vy, vx, xx <= yy), min(max(xx, yy), zz) / largest);
}

struct Plane {
    good: bool,
    // Device depth where the pixel's ray meets it.
    depth: f32,
    // Towards the viewer; of a good plane.
    normal: vec3<f32>,
}

fn fit(window: Window, m: Moments, origin: vec3<f32>) -> Plane {
    let ray = view_ray(window.ndc);
    var out: Plane;
    let total = max(m.weight, 1e-20);
    let mean = m.mean / total;
    let diagonal = m.squares / total - mean * mean;
    let products = m.products / total - mean * mean.yzx;
    let least = smallest(diagonal, products);
    let n = least.eigenvector;
    let facing = dot(n, ray.direction);
    // A plane along the ray has no depth there, and below the spread f32 cannot distinguish a plane
    // from a line.
    out.good = m.count >= 3.0 && least.spread > SPREAD && abs(facing) > 1e-4;
    out.normal = select(n, -n, facing > 0.0);
    let t = dot(n, mean) / select(1.0, facing, out.good);
    out.depth = device_from_view(origin + t * ray.direction).z;
    return out;
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Output {
    var window = window_at(position);
    var out: Output;
    out.layers = vec4(window.center.xy, 0.0, 0.0);
    if !any(window.valid) {
        return out;
    }
    widen(&window, slant(window, vec2(1, 0)) + slant(window, vec2(0, 1)));
    let front_origin = view_from_device(window.ndc, window.center.x);
    let back_origin = view_from_device(window.ndc, -window.center.y);
    let ndc_per_pixel = vec2(2.0, -2.0) / frame.view_size * f32(window.spacing);
    var front: Moments;
    var back: Moments;
    for (var j = -#{HALF_TAPS}; j <= #{HALF_TAPS}; j += 1) {
        for (var i = -#{HALF_TAPS}; i <= #{HALF_TAPS}; i += 1) {
            let tap = tap_at(window, vec2(i, j), edge_weight(window, i) * edge_weight(window, j));
            let ndc = window.ndc + vec2(f32(i), f32(j)) * ndc_per_pixel;
            if tap.weight.x > 0.0 {
                add(&front, view_from_device(ndc, tap.value.x) - front_origin, tap.weight.x);
            }
            if tap.weight.y > 0.0 {
                add(&back, view_from_device(ndc, -tap.value.y) - back_origin, tap.weight.y);
            }
        }
    }
    let front_plane = fit(window, front, front_origin);
    let back_plane = fit(window, back, back_origin);
    let layers = accept(
        window,
        vec2(front_plane.depth, -back_plane.depth),
        vec2(front_plane.good, back_plane.good),
    );
    out.layers = vec4(layers, 0.0, 0.0);
#ifdef NORMALS
    // Without a good plane, the slopes come from neighbouring pixels.
    let x = one_sided_slope(window.pixel, window.center.xy, vec2(1, 0));
    let y = one_sided_slope(window.pixel, window.center.xy, vec2(0, 1));
    let front_slope = normal_from_slope(window.ndc, window.center.x, vec2(x.x, y.x));
    let back_slope = normal_from_slope(window.ndc, -window.center.y, -vec2(x.y, y.y));
    out.normals = vec4(
        encode_normal(select(front_slope, front_plane.normal, front_plane.good)),
        encode_normal(select(back_slope, back_plane.normal, back_plane.good)),
    );
#endif
    return out;
}
