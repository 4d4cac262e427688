//! Smoke and fire: particles that rise and are reborn. Their positions depend on the time alone.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_fluid::prelude::*;

/// A column of rising puffs.
#[derive(Component, Clone, Copy)]
pub(crate) struct Plume {
    material: FluidMaterial,
    /// How many puffs rise at a time, and the particles in each.
    puffs: u32,
    particles: u32,
    /// Particle radius, m.
    radius: f32,
    /// How long a puff rises, s, and how high, m.
    life: f32,
    height: f32,
    /// Radius of the column at its foot and at its top, m.
    foot: f32,
    top: f32,
    /// Radius of a puff at its birth and at its end, m.
    puff: [f32; 2],
    /// How far the wind carries the column at its top, m.
    sway: f32,
    /// Height of a puff over its width.
    stretch: f32,
    /// Flames that rise side by side; 0: one column.
    tongues: u32,
}

impl Plume {
    pub(crate) const SMOKE: Self = Self {
        material: FluidMaterial {
            medium: thin(FluidMaterial::SMOKE.medium, 0.016),
            ..FluidMaterial::SMOKE
        },
        puffs: 80,
        particles: 20,
        radius: 0.08,
        life: 4.0,
        height: 1.4,
        foot: 0.03,
        top: 0.2,
        puff: [0.03, 0.19],
        sway: 0.12,
        stretch: 1.0,
        tongues: 0,
    };

    pub(crate) const FIRE: Self = Self {
        material: FluidMaterial {
            medium: thin(FluidMaterial::FIRE.medium, 0.0075),
            thickness: Thickness::Accumulated { softness: 3.0 },
            ..FluidMaterial::FIRE
        },
        puffs: 1000,
        particles: 4,
        radius: 0.062,
        life: 0.8,
        height: 1.25,
        foot: 0.2,
        top: 0.0,
        puff: [0.05, 0.02],
        sway: 0.1,
        stretch: 3.0,
        tongues: 5,
    };

    /// The fluid: balls of one class that overlap many times over.
    pub(crate) fn fluid(&self) -> impl Bundle + use<> {
        (
            FluidParticles::new(self.positions(0.0).collect(), self.radius),
            SurfaceKernel::PUFFS,
            self.material,
        )
    }

    fn positions(&self, seconds: f32) -> impl Iterator<Item = Vec3> + use<> {
        let plume = *self;
        (0..self.puffs).flat_map(move |puff| {
            // Evenly spread births; the golden ratio keeps neighbours in time apart in place.
            let born = puff as f32 / plume.puffs as f32;
            let lives = seconds / plume.life + born;
            let age = lives.fract();
            let seed = puff.wrapping_add(lives as u32 * plume.puffs);
            let center = plume.center(seed, age, seconds);
            let [small, large] = plume.puff;
            let size = small + (large - small) * age.sqrt();
            let spin = Quat::from_rotation_y(2.0 * age * (random(seed, 7) - 0.5) * TAU);
            (0..plume.particles).map(move |i| {
                let key = seed.wrapping_mul(64).wrapping_add(i);
                let offset = spin * in_ball(key) * size;
                center + vec3(offset.x, plume.stretch * offset.y, offset.z)
            })
        })
    }

    /// Where a puff is at an age from 0 to 1.
    fn center(&self, seed: u32, age: f32, seconds: f32) -> Vec3 {
        let tongue = (self.tongues > 0).then(|| seed.wrapping_mul(0x9E37_79B1) % self.tongues);
        let phase = tongue.map_or(0.0, |tongue| 2.4 * tongue as f32);
        // Some rise less far than others, so that the column thins out upwards.
        let rise =
            age * (0.45 + 0.55 * random(seed, 1)) * self.flicker(tongue, seconds + phase / 5.0);
        let out = (self.foot + (self.top - self.foot) * rise) * random(seed, 2).sqrt();
        let aside = Vec2::from_angle(TAU * random(seed, 3)) * out;
        let around = match tongue {
            None => aside,
            Some(_) => {
                // A flame is widest somewhat above its foot, and pointed.
                let wide = (0.55 + 2.25 * rise).min(1.0) * (1.0 - rise).max(0.0).powf(1.5);
                (0.45 * self.foot * Vec2::from_angle(phase) + 0.6 * aside) * wide
            }
        };
        // Waves that travel up the column move all its puffs alike.
        let wave = |speed: f32, shift: f32| (5.0 * rise - speed * seconds + shift + phase).sin();
        let sway = self.sway * rise * vec2(wave(1.7, 0.0) + 0.5 * wave(3.1, 1.0), wave(2.3, 2.0));
        let along = around + sway;
        vec3(along.x, 0.05 + self.height * rise, along.y)
    }

    /// Height of a flame at a time, as a fraction of its full height.
    fn flicker(&self, tongue: Option<u32>, seconds: f32) -> f32 {
        1.0 - tongue.map_or(0.0, |_| 0.25 * (5.0 * seconds).sin().powi(2))
    }
}

/// The medium with a `share` of its matter: many puffs overlap at every place.
const fn thin(medium: Medium, share: f32) -> Medium {
    let LinearRgba {
        red, green, blue, ..
    } = medium.emission;
    Medium {
        scattering_density: medium.scattering_density * share,
        absorption_density: medium.absorption_density * share,
        emission: LinearRgba::rgb(red * share, green * share, blue * share),
        ..medium
    }
}

/// Evenly distributed from 0 to 1.
fn random(seed: u32, stream: u32) -> f32 {
    let mut bits = seed.wrapping_mul(0x9E37_79B1) ^ stream.wrapping_mul(0x85EB_CA77);
    for _ in 0..3 {
        bits = (bits ^ bits >> 15).wrapping_mul(0x2C1B_3C6D);
    }
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// A point of the unit ball, denser towards its middle.
fn in_ball(key: u32) -> Vec3 {
    let height = 2.0 * random(key, 4) - 1.0;
    let around = Vec2::from_angle(TAU * random(key, 5)) * (1.0 - height * height).sqrt();
    vec3(around.x, height, around.y) * random(key, 6).sqrt()
}

/// Moves all plumes.
pub(crate) fn blow(mut plumes: Query<(&Plume, &mut FluidParticles)>, time: Res<Time>) {
    for (plume, mut fluid) in &mut plumes {
        fluid.positions.clear();
        fluid.positions.extend(plume.positions(time.elapsed_secs()));
    }
}
