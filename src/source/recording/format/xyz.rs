//! Little-endian `f32` triples.

use bevy::prelude::*;

use crate::source::recording::ParticleFrame;

pub(super) fn read(bytes: &[u8]) -> Result<ParticleFrame, String> {
    let (triples, []) = bytes.as_chunks::<12>() else {
        let count = bytes.len();
        return Err(format!(
            "it is not a list of binary f32 triples: its {count} bytes are no multiple of 12"
        ));
    };
    let float = |at: &[u8]| f32::from_le_bytes([at[0], at[1], at[2], at[3]]);
    let positions = triples
        .iter()
        .map(|at| vec3(float(at), float(&at[4..]), float(&at[8..])));
    Ok(ParticleFrame {
        positions: positions.collect(),
        ..default()
    })
}

pub(super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) {
    let numbers = frame.positions.iter().flat_map(Vec3::to_array);
    bytes.extend(numbers.flat_map(f32::to_le_bytes));
}
