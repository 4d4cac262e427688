// The drops present at each rain rate: see `births.rs`.
#define_import_path bevy_fluid::rain::draw::births

// Drops per m³ and mm of diameter.
const INTERCEPT: f32 = 8000.0;
// mm.
const SMALLEST: f32 = 0.1;

fn slope_of_count(drops: f32) -> f32 {
    let wanted = INTERCEPT * SMALLEST / max(drops, 1e-3);
    let log_of = log(1.0 + wanted);
    let guess = log_of * (1.0 - log(1.0 + log_of) / (2.0 + log_of));
    let growth = exp(guess);
    return (guess - (guess * growth - wanted) / (growth * (guess + 1.0))) / SMALLEST;
}

fn diameter_of_birth(drops: f32, random: vec3<f32>) -> f32 {
    let slope = slope_of_count(drops);
    let longer = -log(max(random.xy, vec2(1e-9))) / slope;
    let single = slope * SMALLEST / (1.0 + slope * SMALLEST);
    return SMALLEST + longer.x + select(longer.y, 0.0, random.z < single);
}
