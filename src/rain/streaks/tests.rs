use super::*;
use crate::rain::drops::extinction;

const INPUT: StreakInput = StreakInput {
    exposure: 1.0 / 60.0,
    law: DragLaw::GunnKinzer,
    seed: 1,
};

fn baked(input: &StreakInput) -> Streaks {
    bake(input, &AtomicU32::new(0))
}

const LAYER_BYTES: usize = {
    let (mut bytes, mut level) = (0, 0);
    while level < MIP_LEVELS {
        let (width, height) = mip_size(level);
        bytes += width * height * DENSITIES;
        level += 1;
    }
    bytes
};

/// A mip level of a layer.
fn level(streaks: &Streaks, variant: usize, level: u32) -> &[u8] {
    let start = LAYER_BYTES * variant
        + (0..level)
            .map(|l| mip_size(l).0 * mip_size(l).1 * DENSITIES)
            .sum::<usize>();
    let (width, height) = mip_size(level);
    &streaks.texels[start..start + width * height * DENSITIES]
}

/// Mean opacity of a density in a mip level, over all variants.
fn mean(streaks: &Streaks, mip: u32, density: usize) -> f64 {
    let sum: u64 = (0..VARIANTS)
        .flat_map(|variant| level(streaks, variant, mip).chunks(DENSITIES))
        .map(|texel| u64::from(texel[density]))
        .sum();
    let (width, height) = mip_size(mip);
    sum as f64 / 255.0 * f64::from(streaks.scale) / (width * height * VARIANTS) as f64
}

#[test]
fn the_mean_opacity_is_the_cross_section_of_the_drops_at_every_size_and_exposure() {
    for exposure in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0] {
        let streaks = baked(&StreakInput { exposure, ..INPUT });
        for (density, wanted) in streaks.extinction.into_iter().enumerate() {
            for mip in 0..5 {
                let mean = mean(&streaks, mip, density);
                // Half a step of the last texel of each layer may be left over.
                let (width, height) = mip_size(mip);
                let step = f64::from(streaks.scale) / 255.0;
                let slack = 0.001 * wanted + 0.5 * step / (width * height) as f64;
                assert!(
                    (mean - wanted).abs() <= slack,
                    "density {density}, mip {mip}: {mean}, {wanted}"
                );
            }
        }
    }
}

/// Over many seeds, the drops have the extinction and the mean number of Marshall and Palmer's.
#[test]
fn drops_are_as_many_as_the_integral_says() {
    let seeds = 40;
    let (mut counts, mut cross) = ([0.0; DENSITIES], [0.0; DENSITIES]);
    for seed in 0..seeds {
        for streak in sample_streaks(&StreakInput { seed, ..INPUT })
            .iter()
            .flatten()
        {
            for density in streak.density..DENSITIES {
                counts[density] += 1.0 / (VARIANTS as f64 * seeds as f64);
                cross[density] += PI * streak.radius.powi(2) / (VARIANTS as f64 * seeds as f64);
            }
        }
    }
    for (density, rate) in BAKED_RATES.into_iter().enumerate() {
        let wanted = count(rate, SMALLEST, f64::INFINITY);
        assert!(
            (counts[density] / wanted - 1.0).abs() < 0.01,
            "{rate}: {counts:?}"
        );
        let ratio = cross[density] / extinction(rate);
        assert!((ratio - 1.0).abs() < 0.02, "{rate}: {ratio}");
    }
}

/// The paper's fixed count repeats; independent drops vary by the square root of their number.
#[test]
fn variants_differ_in_number_as_chance_has_it() {
    let mean = count(BAKED_RATES[1], 1.0, LARGEST);
    let (mut sum, mut squares, mut n) = (0.0, 0.0, 0.0);
    for seed in 0..200 {
        for streaks in sample_streaks(&StreakInput { seed, ..INPUT }) {
            let count = streaks
                .iter()
                .filter(|s| s.density <= 1 && s.radius > 0.5e-3 && !s.crosses_a_border())
                .count() as f64;
            (sum, squares, n) = (sum + count, squares + count * count, n + 1.0);
        }
    }
    let (average, variance) = (sum / n, squares / n - (sum / n) * (sum / n));
    assert!(
        average < mean && average > 0.85 * mean,
        "{average} of {mean}"
    );
    let ratio = variance / average;
    assert!((0.6..1.2).contains(&ratio), "{ratio}");
}

#[test]
fn any_two_variants_may_stand_beside_or_on_another() {
    let streaks = baked(&StreakInput {
        exposure: 1.0 / 30.0,
        ..INPUT
    });
    let layers: Vec<&[u8]> = (0..VARIANTS).map(|v| level(&streaks, v, 0)).collect();
    // The texels of one row or column.
    let line = |layer: &[u8], start: usize, step: usize| -> Vec<i32> {
        let texels = (start..WIDTH * HEIGHT).step_by(step).take(WIDTH);
        texels
            .flat_map(|texel| &layer[texel * DENSITIES..][..DENSITIES])
            .map(|&opacity| i32::from(opacity))
            .collect()
    };
    let of_all = |start, step| layers.iter().map(move |layer| line(layer, start, step));
    let differing = |a: &[i32], b: &[i32]| {
        let pairs = a.iter().zip(b);
        pairs.filter(|(a, b)| (*a - *b).abs() > 20).count()
    };
    let top: Vec<_> = of_all(0, 1).collect();
    let strong = |line: &[i32]| line.iter().filter(|&&t| t > 20).count();
    assert!(strong(&top[0]) > 0, "no streak crosses the border");
    // Streaks across the border of one variant continue in every other. Streaks that end at the
    // border may add to one row alone: a few texels.
    for above in of_all(WIDTH * (HEIGHT - 1), 1) {
        for below in &top {
            let ends = differing(&above, below);
            assert!(10 * ends <= 3 * strong(below) + 40, "{ends}");
        }
    }
    // Columns at the sides are the same in all of them, whatever is at the other side.
    for column in [0, WIDTH - 1] {
        let first = line(layers[0], column, WIDTH);
        assert!(strong(&first) > 0, "no streak crosses the border");
        for other in of_all(column, WIDTH) {
            assert_eq!(differing(&first, &other), 0);
        }
    }
}

/// A streak at a corner continues at the other three.
#[test]
fn streaks_wrap_on_all_sides() {
    let streak = Streak {
        x: 0.0,
        y: 0.98,
        length: 0.1,
        radius: 3e-3,
        density: 0,
    };
    let layer = draw(&[streak]);
    let moved = draw(&[Streak {
        x: 0.5,
        y: 0.48,
        ..streak
    }]);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let from = ((y + HEIGHT / 2) % HEIGHT) * WIDTH + (x + WIDTH / 2) % WIDTH;
            let (a, b) = (layer[y * WIDTH + x][0], moved[from][0]);
            assert!((a - b).abs() < 1e-6, "({x}, {y}): {a}, {b}");
        }
    }
}

#[test]
fn streaks_are_as_long_as_the_exposure() {
    let length = |exposure: f32| {
        let radius = 0.5e-3;
        let length = DragLaw::GunnKinzer.speed(1.0) * f64::from(exposure);
        let layer = draw(&[Streak {
            x: 0.5,
            y: 0.2,
            length,
            radius,
            density: 0,
        }]);
        let rows = layer
            .chunks(WIDTH)
            .filter(|row| row.iter().any(|t| t[0] > 0.0));
        rows.count() as f64 / HEIGHT as f64
    };
    for exposure in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0] {
        let expected = 4.03 * f64::from(exposure);
        assert!((length(exposure) - expected).abs() < 2.0 / HEIGHT as f64);
    }
}

#[test]
fn the_same_seed_gives_the_same_texels() {
    let (a, b) = (baked(&INPUT), baked(&INPUT));
    assert_eq!((a.scale, a.extinction), (b.scale, b.extinction));
    assert!(a.texels == b.texels);
    assert!(baked(&StreakInput { seed: 2, ..INPUT }).texels != a.texels);
}

#[test]
fn denser_rain_holds_the_drops_of_thinner_rain() {
    for texel in level(&baked(&INPUT), 0, 0).chunks(DENSITIES) {
        // The rounding carries a step.
        assert!(
            texel
                .windows(2)
                .all(|pair| i32::from(pair[1]) >= i32::from(pair[0]) - 1)
        );
    }
}

#[test]
fn exposures_without_sense_are_clamped() {
    for exposure in [0.0, -1.0, 1e9, f32::NAN] {
        let streaks = baked(&StreakInput { exposure, ..INPUT });
        assert!(streaks.scale.is_finite() && streaks.scale > 0.0);
        assert_eq!(streaks.texels.len(), VARIANTS * LAYER_BYTES);
    }
}
