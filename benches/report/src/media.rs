//! What is inside: the closed form against the equation it solves, and how thick a body is.

use std::{hint::black_box, time::Instant};

use bevy::math::{DVec3, Vec3};
use bevy_fluid::prelude::{FluidMaterial, Medium};
use fluid_reference::{
    Image,
    medium::{Medium as TrueMedium, march},
};

use crate::{
    ReportError,
    methods::Method,
    rig::Rig,
    scenes::Scene,
    table::{Subject, Table},
};

/// Media that a game uses, by name.
const MEDIA: [(&str, Medium); 6] = [
    ("water", FluidMaterial::WATER.medium),
    ("ink", FluidMaterial::INK.medium),
    ("milk", FluidMaterial::MILK.medium),
    ("honey", FluidMaterial::HONEY.medium),
    ("smoke", FluidMaterial::SMOKE.medium),
    ("fire", FluidMaterial::FIRE.medium),
];

/// Ways through them, m.
const LENGTHS: [f32; 6] = [0.001, 0.01, 0.1, 1.0, 3.0, 10.0];

/// A step of the march takes at most so much of the light.
const STEP: f64 = 0.01;

/// Light that falls on a medium evenly, and what is behind it.
const LIGHT: Vec3 = Vec3::new(0.9, 1.0, 1.1);
const BEHIND: Vec3 = Vec3::new(0.3, 0.5, 0.7);

/// The closed form in f32 against the differential equation marched in f64: the error relative
/// to the brightest channel, and how long either takes.
pub(crate) fn measure_closed_form(table: &mut Table, scene: &Scene) {
    for (name, medium) in &MEDIA {
        let subject = Subject {
            scene,
            method: "closed-form",
            parameters: name,
        };
        let rate = medium.extinction().as_dvec3();
        let exact = TrueMedium {
            source: medium.source(LIGHT).as_dvec3(),
            extinction: rate,
        };
        let marched = |length: f32| {
            let length = f64::from(length);
            let steps = (rate.max_element() * length / STEP).ceil().max(8.0) as usize;
            march(|_| exact, length, BEHIND.as_dvec3(), steps)
        };
        let closed =
            |length: f32| medium.reflected(length, LIGHT) + medium.transmitted(length) * BEHIND;
        let off = |length: f32| {
            let true_light = marched(length);
            let error: DVec3 = closed(length).as_dvec3() - true_light;
            error.abs().max_element() / true_light.max_element()
        };
        let worst = LENGTHS.map(off).into_iter().fold(0.0, f64::max);
        table.add(subject, "relative_error_max", "all", worst, "1");
        let ns = nanoseconds(1000, closed);
        table.add(subject, "time_closed_form", "all", ns, "ns");
        let ns = nanoseconds(10, marched);
        table.add(subject, "time_march", "all", ns, "ns");
    }
}

/// How long a call takes, over all lengths.
fn nanoseconds<T>(rounds: u32, call: impl Fn(f32) -> T) -> f64 {
    let start = Instant::now();
    for _ in 0..rounds {
        for length in LENGTHS {
            black_box(call(black_box(length)));
        }
    }
    start.elapsed().as_secs_f64() * 1e9 / f64::from(rounds) / LENGTHS.len() as f64
}

/// How thick the body is to light, against the exact way through it: `single` where a ray meets
/// one puff, `behind` where it meets two with a gap between them.
pub(crate) fn measure_thickness(
    table: &mut Table,
    scene: &Scene,
    methods: &[Method],
    rig: &mut Rig,
) -> Result<(), ReportError> {
    let Some(surface) = &scene.exact else {
        return Ok(());
    };
    let exact = Image::from_fn(scene.camera.size, |pixel| {
        let mut crossings = Vec::new();
        surface.crossings(&scene.camera.pixel_ray(pixel), &mut crossings);
        let signed = crossings.iter().map(|crossing| {
            if crossing.entering {
                -crossing.t
            } else {
                crossing.t
            }
        });
        (signed.sum::<f64>(), crossings.len() / 2)
    });
    for method in methods {
        let subject = Subject {
            scene,
            method: method.name,
            parameters: &method.parameters,
        };
        rig.show(method)?;
        let [_, transmission] = rig.light()?;
        let extinction = f64::from(method.material.medium.extinction().x);
        let pixels = exact.pixels().iter().zip(transmission.pixels());
        let errors: Vec<(f64, usize)> = pixels
            .filter(|((_, bodies), _)| *bodies > 0)
            .map(|((length, bodies), left)| {
                let got = left.map_or(0.0, |left| -left.x.ln() / extinction);
                ((got - length) / scene.radius, *bodies)
            })
            .collect();
        for (region, wanted) in [("all", None), ("single", Some(1)), ("behind", Some(2))] {
            let errors = errors
                .iter()
                .filter(|(_, bodies)| wanted.is_none_or(|wanted| wanted == *bodies))
                .map(|(error, _)| *error);
            let count = errors.clone().count();
            if count == 0 {
                continue;
            }
            let mean = errors.clone().sum::<f64>() / count as f64;
            let square = errors.map(|error| error * error).sum::<f64>() / count as f64;
            table.add(subject, "thickness_offset", region, mean, "r");
            table.add(subject, "thickness_rmse", region, square.sqrt(), "r");
        }
    }
    Ok(())
}
