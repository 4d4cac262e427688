//! Every number that users set: it has a range, its default is valid, and what is not is clamped
//! under its own name.

use core::fmt::Debug;
use std::time::Duration;

use bevy::{prelude::*, reflect::PartialReflect};

use crate::{
    emitter::EmitterBounds,
    prelude::*,
    rain::{Exposure, RainShelter, RainStreakSettings},
    relocation::TeleportSettings,
    settings::{
        Bilateral, CurvatureFlow, NarrowRange, NormalAverage, PlaneFit, Search, Smoothing,
        for_each_number,
    },
    shape::RADIUS,
    solid::SolidShape,
};

/// A solid of every shape.
const SOLIDS: [SolidShape; 5] = [
    SolidShape::Ground,
    SolidShape::Sphere { radius: 1.0 },
    SolidShape::Cuboid {
        half_size: Vec3::ONE,
    },
    SolidShape::Capsule {
        radius: 1.0,
        half_length: 2.0,
    },
    SolidShape::Cylinder {
        radius: 1.0,
        half_height: 2.0,
    },
];

/// A number as every type can take it.
fn number(value: &dyn PartialReflect) -> Option<f64> {
    let float = value.try_downcast_ref::<f32>().map(|&it| it.into());
    let double = value.try_downcast_ref::<f64>().copied();
    let count = value.try_downcast_ref::<u32>().map(|&it| it.into());
    let size = value.try_downcast_ref::<usize>().map(|&it| it as f64);
    let time = value
        .try_downcast_ref::<Duration>()
        .map(Duration::as_secs_f64);
    float.or(double).or(count).or(size).or(time)
}

fn set(value: &mut dyn PartialReflect, to: f64) {
    if let Some(value) = value.try_downcast_mut::<f32>() {
        *value = to as f32;
    } else if let Some(value) = value.try_downcast_mut::<f64>() {
        *value = to;
    } else if let Some(value) = value.try_downcast_mut::<u32>() {
        *value = to as u32;
    } else if let Some(value) = value.try_downcast_mut::<usize>() {
        *value = to as usize;
    } else if let Some(value) = value.try_downcast_mut::<Duration>() {
        *value = Duration::try_from_secs_f64(to).unwrap_or(*value);
    }
}

/// Name, value and valid values of every number, as `f32` has them.
fn numbers<S: Settings>(settings: &S) -> Vec<(String, f64, [f64; 2])> {
    let mut all = Vec::new();
    for_each_number(&mut settings.clone(), &mut |part| {
        let Some(value) = number(part.value) else {
            return;
        };
        let name = part.path.to_string();
        let Some(range) = part.range else {
            panic!("{name} has no range");
        };
        let is_float = part.value.try_downcast_ref::<f32>().is_some();
        let valid = range
            .valid
            .map(|it| if is_float { f64::from(it as f32) } else { it });
        all.push((name, value, valid));
    });
    all
}

fn check<S: Settings + Debug>(sample: S) {
    assert_eq!(sample.validate(), Ok(()), "{sample:?}");
    assert_eq!(sample.clamped(), sample);
    for (index, (name, value, [min, max])) in numbers(&sample).into_iter().enumerate() {
        let is_valid = |value: f64| (min..=max).contains(&value);
        assert!(is_valid(value), "{name}");
        for to in [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1e6,
            -1e6,
            0.0,
            min - 0.1 * min.abs() - 1e-6,
            max + 0.1 * max.abs() + 1e-6,
        ] {
            let mut odd = sample.clone();
            let mut at = 0;
            for_each_number(&mut odd, &mut |part| {
                if number(part.value).is_some() {
                    if at == index {
                        set(part.value, to);
                    }
                    at += 1;
                }
            });
            // Integers have no such values.
            if is_valid(numbers(&odd)[index].1) {
                continue;
            }
            let error = odd.validate().unwrap_err();
            let rest = name.strip_prefix(&error.name);
            let is_named = rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
            assert!(is_named, "{to} for {name}: {error}");
            let clamped = odd.clamped();
            assert_eq!(clamped.validate(), Ok(()), "{to} for {name}: {clamped:?}");
            assert_eq!(clamped.clamped(), clamped);
            // But for what is dropped as a whole.
            if let Some((name, value, _)) = numbers(&clamped).get(index) {
                assert!(is_valid(*value), "{to} for {name} becomes {value}");
            }
        }
    }
}

#[test]
fn fluids_and_views() {
    for thickness in [Thickness::Layers, Thickness::SOFT] {
        check(FluidMaterial {
            thickness,
            ..FluidMaterial::default()
        });
    }
    check(Medium::default());
    check(SurfaceKernel::default());
    for smoothing in [
        Smoothing::None,
        Smoothing::PlaneFit(PlaneFit::default()),
        Smoothing::Bilateral(Bilateral::default()),
        Smoothing::NormalAverage(NormalAverage::default()),
        Smoothing::NarrowRange(NarrowRange::default()),
        Smoothing::CurvatureFlow(CurvatureFlow::default()),
    ] {
        for search in [Search::Secant, Search::BRACKETED] {
            check(ScreenSpaceFluid {
                smoothing,
                search,
                ..default()
            });
        }
    }
    for preset in [
        ScreenSpaceFluid::FAST,
        ScreenSpaceFluid::ACCURATE,
        ScreenSpaceFluid::THESIS,
        ScreenSpaceFluid::EARLIER,
    ] {
        check(preset);
    }
}

#[test]
fn emitters_and_colliders() {
    for bounds in [None, Some(EmitterBounds::default())] {
        check(ParticleEmitter {
            bounds,
            ..default()
        });
    }
    for shape in SOLIDS {
        check(ParticleCollider::from(shape));
    }
    check(TeleportSettings::default());
}

#[test]
fn rain() {
    check(Rain::default());
    check(RainShelter::default());
    for exposure in [Exposure::FrameTime, Exposure::Seconds(0.01)] {
        check(RainStreakSettings {
            exposure,
            ..default()
        });
    }
}

#[cfg(feature = "recordings")]
#[test]
fn recordings() {
    use crate::recording::{RecordingPlayer, RecordingWriter};

    for radius in [None, Some(0.1)] {
        check(RecordingPlayer {
            radius,
            ..default()
        });
    }
    check(RecordingWriter::default());
}

#[cfg(feature = "salva")]
#[test]
fn simulation() {
    use crate::salva::{SalvaBody, SalvaBoundary, SalvaFluid, SalvaSettings, SalvaShape};

    check(SalvaFluid::default());
    check(SalvaSettings::default());
    let half_size = Vec3::ONE;
    let others = [SalvaShape::Mesh, SalvaShape::Tank { half_size }];
    for shape in others.into_iter().chain(SOLIDS.map(SalvaShape::Solid)) {
        check(SalvaBoundary::new(shape));
        check(SalvaBody::new(shape, 500.0));
    }
}

/// Numbers of particles are checked by the shape stage, as nothing is drawn of a bad radius.
#[test]
fn a_radius_is_no_setting_to_clamp() {
    for (radius, is_valid) in [(0.02, true), (0.0, false), (-1.0, false), (f32::NAN, false)] {
        assert_eq!(RADIUS.contains(radius), is_valid);
    }
}
