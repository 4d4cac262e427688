// What a homogeneous, evenly lit medium leaves of light and adds to it: the twin of `medium/mod.rs`.
#define_import_path bevy_fluid::render::medium

// What is left of light after `path` metres: f_T, per channel.
fn transmitted(extinction: vec3<f32>, path: f32) -> vec3<f32> {
    // Finite, because 0 · ∞ is not a number.
    return exp(-extinction * clamp(path, 0.0, 1e30));
}

// The length of a path that sends as much as `path` does where `extinction` takes from it:
// (1 − exp(−x)) / B with x = B · path. As printed it is 0/0 without extinction and loses digits
// near it; below x = 0.5 the series path · Σ (−x)^k / (k + 1)! stands in.
fn seen_length(extinction: vec3<f32>, path: f32) -> vec3<f32> {
    let d = clamp(path, 0.0, 1e30);
    let x = extinction * d;
    var series = vec3(1.0);
    for (var k = 8.0; k >= 2.0; k -= 1.0) {
        series = 1.0 - x / k * series;
    }
    // Not a division by zero where the series is taken instead.
    let direct = (1.0 - exp(-x)) / max(extinction, vec3(1e-37));
    return select(d * series, direct, x >= vec3(0.5));
}

// What `path` metres add, where each sends `source` to the eye: f_R, per channel.
fn reflected(source: vec3<f32>, extinction: vec3<f32>, path: f32) -> vec3<f32> {
    return source * seen_length(extinction, path);
}
