//! Houdini's classic `.bgeo`, plain or zipped: our own reader, whose memory is bounded by the
//! file's size, and splashsurf's writer.

use std::io::Read;

use bevy::prelude::*;
use flate2::read::GzDecoder;
use splashsurf_lib::io::bgeo_format::{
    AttribDefinition, AttributeStorage, BgeoAttributeType, BgeoFile, BgeoHeader, write_bgeo_file,
};

use super::{IDS, RADII, VELOCITIES, floats, ids, mean_radius};
use crate::source::recording::ParticleFrame;

/// The most bytes after unzipping: a few kilobytes can be zipped gigabytes of nothing.
const MAX_BYTES: u64 = 1 << 30;
/// Position and weight.
const POINT: usize = 16;
const INTEGER: i32 = 1;

/// Memory and time are linear in the actual bytes, whatever the header claims.
pub(super) fn read(bytes: &[u8]) -> Result<ParticleFrame, String> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return parse(Bytes(bytes));
    }
    let mut unzipped = Vec::new();
    GzDecoder::new(bytes)
        .take(MAX_BYTES + 1)
        .read_to_end(&mut unzipped)
        .map_err(|error| error.to_string())?;
    if unzipped.len() as u64 > MAX_BYTES {
        return Err(format!("it unfolds to more than {MAX_BYTES} bytes"));
    }
    parse(Bytes(&unzipped))
}

/// Where an attribute lies within a point.
struct Place {
    name: String,
    is_integer: bool,
    size: usize,
    offset: usize,
}

fn parse(mut bytes: Bytes) -> Result<ParticleFrame, String> {
    if bytes.take(5)? != b"BgeoV" {
        return Err("not a classic .bgeo file".into());
    }
    let version = bytes.int()?;
    if version != 5 {
        return Err(format!("its version is {version}, not 5"));
    }
    let points = bytes.int()?;
    let _primitives_and_groups: [i32; 3] = [bytes.int()?, bytes.int()?, bytes.int()?];
    let attributes = bytes.int()?;
    let _other_attributes: [i32; 3] = [bytes.int()?, bytes.int()?, bytes.int()?];
    if attributes < 0 {
        return Err(format!("it has {attributes} attributes"));
    }

    let mut places = Vec::new();
    let mut stride = POINT;
    for _ in 0..attributes {
        let length = bytes.short()?;
        let name = String::from_utf8_lossy(bytes.take(length)?).into_owned();
        let size = bytes.short()?;
        let kind = bytes.int()?;
        // Numbers and vectors.
        if ![0, INTEGER, 5].contains(&kind) {
            return Err(format!("an attribute is of the unknown kind {kind}"));
        }
        bytes.take(4 * size)?;
        places.push(Place {
            name,
            is_integer: kind == INTEGER,
            size,
            offset: stride,
        });
        stride += 4 * size;
    }

    let all = usize::try_from(points)
        .ok()
        .and_then(|count| count.checked_mul(stride))
        .filter(|&all| all <= bytes.0.len())
        .ok_or_else(|| {
            let there = bytes.0.len() / stride;
            format!("it claims {points} points and holds {there}")
        })?;
    Ok(frame(&bytes.0[..all], stride, &places))
}

fn frame(points: &[u8], stride: usize, places: &[Place]) -> ParticleFrame {
    let points = || points.chunks_exact(stride);
    let word = |at: &[u8]| [at[0], at[1], at[2], at[3]];
    let float = |at: &[u8]| f32::from_be_bytes(word(at));
    let vector = |at: &[u8]| vec3(float(at), float(&at[4..]), float(&at[8..]));
    let find = |names: &[&str], size, is_integer| {
        let fits = |place: &&Place| {
            let is_named = names.contains(&place.name.as_str());
            is_named && place.size == size && place.is_integer == is_integer
        };
        places.iter().find(fits).map(|place| place.offset)
    };
    ParticleFrame {
        positions: points().map(vector).collect(),
        ids: find(&IDS, 1, true).map_or_else(Vec::new, |offset| {
            // The same bits as written: ids above 2³¹ come as negative numbers.
            let id = |at: &[u8]| f64::from(u32::from_be_bytes(word(&at[offset..])));
            ids(points().map(id))
        }),
        velocities: find(&VELOCITIES, 3, false).map_or_else(Vec::new, |offset| {
            points().map(|at| vector(&at[offset..])).collect()
        }),
        radius: find(&RADII, 1, false)
            .and_then(|offset| mean_radius(points().map(|at| float(&at[offset..])))),
    }
}

/// The bytes left to read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (taken, left) = self.0.split_at_checked(count).ok_or("it is cut short")?;
        self.0 = left;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let taken = self.take(N)?;
        taken.try_into().map_err(|_| "it is cut short".into())
    }

    fn int(&mut self) -> Result<i32, String> {
        Ok(i32::from_be_bytes(self.array()?))
    }

    fn short(&mut self) -> Result<usize, String> {
        Ok(u16::from_be_bytes(self.array()?).into())
    }
}

pub(super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) -> Result<(), String> {
    let count = frame.positions.len();
    let mut definitions = Vec::new();
    let mut data = Vec::new();
    let mut attribute = |name: &str, size: usize, kind, storage| {
        definitions.push(AttribDefinition {
            name: name.into(),
            size,
            attr_type: kind,
            default_values: vec![0; size],
        });
        data.push((name.to_owned(), storage));
    };
    if !frame.ids.is_empty() {
        let numbers = frame.ids.iter().map(|&id| id.cast_signed()).collect();
        let numbers = AttributeStorage::Int(numbers);
        attribute("id", 1, BgeoAttributeType::Int, numbers);
    }
    if !frame.velocities.is_empty() {
        let vectors = AttributeStorage::Vector(3, floats(&frame.velocities));
        attribute("v", 3, BgeoAttributeType::Vector, vectors);
    }
    if let Some(radius) = frame.radius {
        let radii = AttributeStorage::Float(vec![radius; count]);
        attribute("pscale", 1, BgeoAttributeType::Float, radii);
    }
    let file = BgeoFile {
        header: BgeoHeader {
            magic_bytes: *b"Bgeo",
            version_char: b'V',
            version: 5,
            num_points: i32::try_from(count).map_err(|error| error.to_string())?,
            num_prims: 0,
            num_point_groups: 0,
            num_prim_groups: 0,
            num_point_attrib: definitions.len() as i32,
            num_vertex_attrib: 0,
            num_prim_attrib: 0,
            num_attrib: 0,
        },
        positions: AttributeStorage::Vector(3, floats(&frame.positions)),
        weights: AttributeStorage::Float(vec![1.0; count]),
        attribute_definitions: definitions,
        attribute_data: data,
    };
    write_bgeo_file(&file, bytes, false).map_err(|error| error.to_string())
}
