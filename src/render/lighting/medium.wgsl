// Transmission, in-scattering and emission of a homogeneous, evenly lit medium: the twin of
// `medium/mod.rs`.
#define_import_path bevy_fluid::render::medium

// Fraction of light transmitted over `path` metres: f_T, per channel.
fn transmitted(extinction: vec3<f32>, path: f32) -> vec3<f32> {
    // Finite, because 0 · ∞ is NaN.
    return exp(-extinction * clamp(path, 0.0, 1e30));
}

// The length of a path without extinction that adds as much light as `path` does with it:
// (1 − exp(−x)) / B with x = B · path. As printed, the formula is 0/0 without extinction and loses
// digits near it; below x = 0.5 the series path · Σ (−x)^k / (k + 1)! is used instead.
fn seen_length(extinction: vec3<f32>, path: f32) -> vec3<f32> {
    let d = clamp(path, 0.0, 1e30);
    let x = extinction * d;
    var series = vec3(1.0);
    for (var k = 8.0; k >= 2.0; k -= 1.0) {
        series = 1.0 - x / k * series;
    }
    // Avoids a division by zero where the series is used instead.
    let direct = (1.0 - exp(-x)) / max(extinction, vec3(1e-37));
    return select(d * series, direct, x >= vec3(0.5));
}

// In-scattered light and emission over `path` metres, where each adds `source`: f_R, per channel.
fn reflected(source: vec3<f32>, extinction: vec3<f32>, path: f32) -> vec3<f32> {
    return source * seen_length(extinction, path);
}
