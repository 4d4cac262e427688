//! Houdini's classic `.bgeo`.

use super::{
    content,
    found::{Fault, Found},
    number::Number,
    role::{IDS, Role},
    scan::Scan,
};
use crate::source::recording::frame::ParticleFrame;

const MAGIC: &[u8] = b"BgeoV";
const VERSION: i32 = 5;
/// Position and weight. Unit: words of four bytes.
const POINT: usize = 4;
/// Types of attributes.
const FLOAT: i32 = 0;
const INTEGER: i32 = 1;
const INDEX: i32 = 4;
const VECTOR: i32 = 5;

/// An attribute and where it lies within a point. Unit: words of four bytes.
struct Place {
    name: String,
    number: Number,
    size: usize,
    offset: usize,
}

/// Memory and time are linear in the actual bytes, whatever the header claims.
pub(super) fn read(bytes: &[u8]) -> Result<Found, Fault> {
    if !bytes.starts_with(MAGIC) && !MAGIC.starts_with(bytes) {
        let what = content::described(bytes);
        return Err(Fault::Unsupported(format!("no classic .bgeo: {what}")));
    }
    let mut scan = Scan::new(bytes);
    take(&mut scan, MAGIC.len())?;
    let version = int(&mut scan)?;
    if version != VERSION {
        let reason = format!("its version is {version}, not {VERSION}");
        return Err(Fault::Unsupported(reason));
    }
    let claimed = int(&mut scan)?;
    let _primitives_and_groups = take(&mut scan, 12)?;
    let attributes = int(&mut scan)?;
    let _other_attributes = take(&mut scan, 12)?;

    let mut found = Found::default();
    let mut places = Vec::new();
    let mut words = POINT;
    for _ in 0..attributes {
        let place = attribute(&mut scan, words, &mut found)?;
        words = words.saturating_add(place.size);
        places.push(place);
    }
    let stride = words.saturating_mul(4);
    let there = scan.rest().len() / stride;
    let points = usize::try_from(claimed)
        .ok()
        .and_then(|count| scan.take(count.checked_mul(stride)?))
        .ok_or_else(|| Fault::Damaged(format!("it claims {claimed} points and holds {there}")))?;

    let numbers = |number: Number, offset: usize, size: usize| -> Vec<f64> {
        points
            .chunks_exact(stride)
            .flat_map(|point| point[4 * offset..][..4 * size].as_chunks::<4>().0)
            .map(|word| number.big_endian(word))
            .collect()
    };
    found.set_positions(&numbers(Number::F32, 0, 3));
    for place in places {
        let numbers = || Ok(numbers(place.number, place.offset, place.size));
        found.attribute(&place.name, place.size, numbers);
    }
    Ok(found)
}

/// The definition of an attribute, which lies at `offset` within each point.
fn attribute(scan: &mut Scan, offset: usize, found: &mut Found) -> Result<Place, Fault> {
    let length = short(scan)?;
    let mut name = String::from_utf8_lossy(take(scan, length)?).into_owned();
    let size = short(scan)?;
    let number = match int(scan)? {
        FLOAT | VECTOR => {
            let _defaults = take(scan, 4 * size)?;
            Number::F32
        }
        INTEGER => {
            let _defaults = take(scan, 4 * size)?;
            // The same bits as written: ids above 2³¹ come as negative numbers.
            match Role::of(&name) {
                Some(Role::Id) => Number::U32,
                _ => Number::I32,
            }
        }
        INDEX => {
            for _ in 0..int(scan)? {
                let length = short(scan)?;
                take(scan, length)?;
            }
            found.leave_out(&name, "it holds strings");
            // Its words are indices, whatever it is called.
            name.clear();
            Number::I32
        }
        kind => {
            let reason = format!(
                "its attribute `{}` is of the unknown kind {kind}",
                name.escape_debug()
            );
            return Err(Fault::Unsupported(reason));
        }
    };
    Ok(Place {
        name,
        number,
        size,
        offset,
    })
}

fn take<'a>(scan: &mut Scan<'a>, count: usize) -> Result<&'a [u8], Fault> {
    scan.take(count)
        .ok_or_else(|| Fault::Damaged("it is cut short".into()))
}

fn int(scan: &mut Scan) -> Result<i32, Fault> {
    let bytes = take(scan, 4)?;
    Ok(Number::I32.big_endian(bytes) as i32)
}

fn short(scan: &mut Scan) -> Result<usize, Fault> {
    let bytes = take(scan, 2)?;
    Ok(Number::U16.big_endian(bytes) as usize)
}

pub(super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) -> Result<(), String> {
    let count = i32::try_from(frame.positions.len()).map_err(|error| error.to_string())?;
    let attributes: Vec<(&str, u16, i32)> = [
        (!frame.ids.is_empty()).then_some((IDS[0], 1, INTEGER)),
        (!frame.velocities.is_empty()).then_some(("v", 3, VECTOR)),
        frame.radius.is_some().then_some(("pscale", 1, FLOAT)),
    ]
    .into_iter()
    .flatten()
    .collect();

    bytes.extend(MAGIC);
    let header = [VERSION, count, 0, 0, 0, attributes.len() as i32, 0, 0, 0];
    bytes.extend(header.into_iter().flat_map(i32::to_be_bytes));
    for (name, size, kind) in attributes {
        bytes.extend((name.len() as u16).to_be_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend(size.to_be_bytes());
        bytes.extend(kind.to_be_bytes());
        let defaults = vec![0; 4 * usize::from(size)];
        bytes.extend(defaults);
    }
    for (index, position) in frame.positions.iter().enumerate() {
        let floats = position.extend(1.0).to_array();
        bytes.extend(floats.into_iter().flat_map(f32::to_be_bytes));
        let id = frame.ids.get(index).map(|id| id.to_be_bytes());
        bytes.extend(id.into_iter().flatten());
        let velocity = frame.velocities.get(index).map(bevy::math::Vec3::to_array);
        bytes.extend(velocity.into_iter().flatten().flat_map(f32::to_be_bytes));
        bytes.extend(frame.radius.into_iter().flat_map(f32::to_be_bytes));
    }
    // The end of the file; no attribute is of the detail.
    bytes.extend([0x00, 0xff]);
    Ok(())
}
