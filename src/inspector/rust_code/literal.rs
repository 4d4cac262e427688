//! Values that are written as one literal.

use bevy::{prelude::*, reflect::PartialReflect};
use core::time::Duration;

/// Numbers, words, colours and vectors.
pub(super) fn literal(value: &dyn PartialReflect) -> Option<String> {
    macro_rules! numbers {
        ($($type:ty),+) => {
            $(if let Some(number) = value.try_downcast_ref::<$type>() {
                return Some(format!("{number:?}"));
            })+
        };
    }
    numbers!(bool, u8, u16, u32, u64, usize, i8, i16, i32, i64, isize);
    if let Some(number) = value.try_downcast_ref::<f32>() {
        return Some(float(*number));
    }
    if let Some(number) = value.try_downcast_ref::<f64>() {
        return Some(if number.is_finite() {
            format!("{number:?}")
        } else {
            format!("f64::from({})", float(*number as f32))
        });
    }
    if let Some(text) = value.try_downcast_ref::<String>() {
        return Some(format!("String::from({text:?})"));
    }
    if let Some(time) = value.try_downcast_ref::<Duration>() {
        return Some(format!(
            "core::time::Duration::from_secs_f64({:?})",
            time.as_secs_f64()
        ));
    }
    if let Some(color) = value.try_downcast_ref::<LinearRgba>() {
        let [r, g, b, a] = color.to_f32_array();
        return Some(if a == 1.0 {
            format!("LinearRgba::rgb({})", floats(&[r, g, b]))
        } else {
            format!("LinearRgba::new({})", floats(&[r, g, b, a]))
        });
    }
    let vector = |name: &str, of: &[f32]| Some(format!("{name}({})", floats(of)));
    if let Some(v) = value.try_downcast_ref::<Vec2>() {
        return vector("vec2", &v.to_array());
    }
    if let Some(v) = value.try_downcast_ref::<Vec3>() {
        return vector("vec3", &v.to_array());
    }
    if let Some(v) = value.try_downcast_ref::<Vec4>() {
        return vector("vec4", &v.to_array());
    }
    if let Some(rotation) = value.try_downcast_ref::<Quat>() {
        return vector("Quat::from_xyzw", &rotation.to_array());
    }
    None
}

fn float(number: f32) -> String {
    match number {
        _ if number.is_nan() => "f32::NAN".into(),
        f32::INFINITY => "f32::INFINITY".into(),
        f32::NEG_INFINITY => "f32::NEG_INFINITY".into(),
        _ => format!("{number:?}"),
    }
}

fn floats(numbers: &[f32]) -> String {
    let numbers: Vec<_> = numbers.iter().map(|number| float(*number)).collect();
    numbers.join(", ")
}
