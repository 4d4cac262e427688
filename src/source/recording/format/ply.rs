//! PLY, by `ply-rs`, after a check of the header's claims.

use bevy::prelude::*;
use ply_rs::{
    parser::Parser,
    ply::{Property, PropertyAccess},
};

use super::{IDS, RADII, ids, mean_radius};
use crate::source::recording::ParticleFrame;

/// Longer headers are invalid.
const MAX_HEADER: usize = 1 << 16;

/// The requested properties of an element; the reader sets them by name.
struct Vertex {
    position: Vec3,
    velocity: Vec3,
    id: f64,
    radius: f32,
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self {
            position: Vec3::ZERO,
            velocity: Vec3::ZERO,
            id: -1.0,
            radius: f32::NAN,
        }
    }

    fn set_property(&mut self, name: String, property: Property) {
        let Some(number) = number(&property) else {
            return;
        };
        match name.as_str() {
            "x" => self.position.x = number as f32,
            "y" => self.position.y = number as f32,
            "z" => self.position.z = number as f32,
            "vx" => self.velocity.x = number as f32,
            "vy" => self.velocity.y = number as f32,
            "vz" => self.velocity.z = number as f32,
            name if IDS.contains(&name) => self.id = number,
            name if RADII.contains(&name) => self.radius = number as f32,
            _ => {}
        }
    }
}

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(value) => value.into(),
        Property::UChar(value) => value.into(),
        Property::Short(value) => value.into(),
        Property::UShort(value) => value.into(),
        Property::Int(value) => value.into(),
        Property::UInt(value) => value.into(),
        Property::Float(value) => value.into(),
        Property::Double(value) => value,
        _ => return None,
    })
}

pub(super) fn read(bytes: &[u8]) -> Result<ParticleFrame, String> {
    check_header(bytes)?;
    let ply = Parser::<Vertex>::new()
        .read_ply(&mut &*bytes)
        .map_err(|error| error.to_string())?;
    let vertex = ply.header.elements.get("vertex");
    let vertex = vertex.ok_or("it has no element `vertex`")?;
    let has = |name: &str| vertex.properties.contains_key(name);
    if let Some(missing) = ["x", "y", "z"].into_iter().find(|name| !has(name)) {
        return Err(format!("its vertices have no `{missing}`"));
    }
    let vertices = ply.payload.get("vertex").map_or(&[][..], Vec::as_slice);
    let mut frame = ParticleFrame {
        positions: vertices.iter().map(|vertex| vertex.position).collect(),
        radius: mean_radius(vertices.iter().map(|vertex| vertex.radius)),
        ..default()
    };
    if IDS.into_iter().any(has) {
        frame.ids = ids(vertices.iter().map(|vertex| vertex.id));
    }
    if ["vx", "vy", "vz"].into_iter().all(has) {
        frame.velocities = vertices.iter().map(|vertex| vertex.velocity).collect();
    }
    Ok(frame)
}

/// Refuses headers that claim more elements than there are bytes, or elements without properties,
/// of which any number fits into any file: the reader trusts both.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let header = &bytes[..bytes.len().min(MAX_HEADER)];
    let mut of_nothing = None;
    for line in header.split(|&byte| byte == b'\n') {
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_whitespace();
        match words.next() {
            Some("property") => of_nothing = None,
            Some(word @ ("element" | "end_header")) => {
                if let Some(element) = of_nothing.take() {
                    return Err(format!("its element `{element}` has no properties"));
                }
                if word == "end_header" {
                    return Ok(());
                }
                let element = words.next().unwrap_or_default().to_owned();
                let count = words.next().unwrap_or_default();
                let Ok(count) = count.parse::<u64>() else {
                    return Err(format!("its number of `{element}` is `{count}`"));
                };
                if count > bytes.len() as u64 {
                    let there = bytes.len();
                    return Err(format!("it claims {count} of `{element}` in {there} bytes"));
                }
                of_nothing = Some(element);
            }
            _ => {}
        }
    }
    Err("its header does not end".into())
}

pub(super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) -> Result<(), String> {
    let mut header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n",
        frame.positions.len()
    );
    let mut property = |kind: &str, names: &[&str]| {
        for name in names {
            header += &format!("property {kind} {name}\n");
        }
    };
    property("float", &["x", "y", "z"]);
    if !frame.ids.is_empty() {
        property("uint", &IDS[..1]);
    }
    if !frame.velocities.is_empty() {
        property("float", &["vx", "vy", "vz"]);
    }
    if frame.radius.is_some() {
        property("float", &RADII[..1]);
    }
    bytes.extend((header + "end_header\n").into_bytes());
    for (index, position) in frame.positions.iter().enumerate() {
        bytes.extend(position.to_array().into_iter().flat_map(f32::to_le_bytes));
        bytes.extend(
            frame
                .ids
                .get(index)
                .into_iter()
                .flat_map(|id| id.to_le_bytes()),
        );
        let velocity = frame.velocities.get(index).map(Vec3::to_array);
        bytes.extend(velocity.into_iter().flatten().flat_map(f32::to_le_bytes));
        bytes.extend(frame.radius.into_iter().flat_map(f32::to_le_bytes));
    }
    Ok(())
}
