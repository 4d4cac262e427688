//! Writes PLY: binary, little-endian.

use bevy::prelude::*;

use super::super::role::{IDS, RADII};
use crate::source::recording::frame::ParticleFrame;

pub(in super::super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) {
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
}
