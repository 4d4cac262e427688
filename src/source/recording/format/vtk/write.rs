//! Writes legacy `.vtk`: binary, a grid of vertices.

use bevy::prelude::*;

use super::super::role::{IDS, RADII, VELOCITIES};
use crate::source::recording::frame::ParticleFrame;

pub(in super::super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) -> Result<(), String> {
    /// The type of cells that are points.
    const VERTEX: i32 = 1;
    let count = i32::try_from(frame.positions.len()).map_err(|error| error.to_string())?;
    let mut section = |header: String, numbers: &mut dyn Iterator<Item = [u8; 4]>| {
        bytes.extend(header.into_bytes());
        bytes.extend(numbers.flatten());
        bytes.push(b'\n');
    };
    section(
        format!(
            "# vtk DataFile Version 4.2\nparticles\nBINARY\nDATASET UNSTRUCTURED_GRID\n\
             POINTS {count} float\n"
        ),
        &mut floats(&frame.positions),
    );
    section(
        format!("CELLS {count} {}\n", 2 * i64::from(count)),
        &mut (0..count).flat_map(|index| [1, index].map(i32::to_be_bytes)),
    );
    section(
        format!("CELL_TYPES {count}\n"),
        &mut (0..count).map(|_| VERTEX.to_be_bytes()),
    );
    section(format!("POINT_DATA {count}"), &mut std::iter::empty());
    if !frame.ids.is_empty() {
        section(
            format!("SCALARS {} unsigned_int 1\nLOOKUP_TABLE default\n", IDS[0]),
            &mut frame.ids.iter().map(|id| id.to_be_bytes()),
        );
    }
    if !frame.velocities.is_empty() {
        section(
            format!("VECTORS {} float\n", VELOCITIES[0]),
            &mut floats(&frame.velocities),
        );
    }
    if let Some(radius) = frame.radius {
        section(
            format!("SCALARS {} float 1\nLOOKUP_TABLE default\n", RADII[0]),
            &mut (0..count).map(|_| radius.to_be_bytes()),
        );
    }
    Ok(())
}

fn floats(vectors: &[Vec3]) -> impl Iterator<Item = [u8; 4]> {
    vectors
        .iter()
        .flat_map(|vector| vector.to_array().map(f32::to_be_bytes))
}
