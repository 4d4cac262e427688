//! Houdini's classic `.bgeo`, plain or zipped: the positions of its points.

use std::io::Read;

use anyhow::{Context, bail, ensure};
use bevy::prelude::*;
use flate2::read::GzDecoder;

/// What a file may unfold to: a few kilobytes can be zipped gigabytes of nothing.
const MAX_BYTES: u64 = 1 << 30;
/// Position and weight.
const POINT: usize = 16;

/// Reads the positions. Memory and time are linear in the bytes that are there, whatever the header
/// says of them.
pub(crate) fn read(bytes: &[u8]) -> anyhow::Result<Vec<Vec3>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return parse(Bytes(bytes));
    }
    let mut unzipped = Vec::new();
    GzDecoder::new(bytes)
        .take(MAX_BYTES + 1)
        .read_to_end(&mut unzipped)?;
    ensure!(
        unzipped.len() as u64 <= MAX_BYTES,
        "it unfolds to more than {MAX_BYTES} bytes"
    );
    parse(Bytes(&unzipped))
}

fn parse(mut bytes: Bytes) -> anyhow::Result<Vec<Vec3>> {
    ensure!(bytes.take(5)? == b"BgeoV", "it is no classic .bgeo");
    let version = bytes.int()?;
    ensure!(version == 5, "its version is {version}, not 5");
    let points = bytes.int()?;
    let _primitives_and_groups: [i32; 3] = [bytes.int()?, bytes.int()?, bytes.int()?];
    let attributes = bytes.int()?;
    let _other_attributes: [i32; 3] = [bytes.int()?, bytes.int()?, bytes.int()?];
    ensure!(attributes >= 0, "it has {attributes} attributes");

    let mut stride = POINT;
    for _ in 0..attributes {
        let name = bytes.short()?;
        bytes.take(name)?;
        let size = bytes.short()?;
        match bytes.int()? {
            // Numbers and vectors.
            0 | 1 | 5 => bytes.take(4 * size)?,
            kind => bail!("an attribute is of the unknown kind {kind}"),
        };
        stride += 4 * size;
    }

    let count = usize::try_from(points).ok();
    let all = count
        .and_then(|count| count.checked_mul(stride))
        .filter(|&all| all <= bytes.0.len())
        .with_context(|| {
            let there = bytes.0.len() / stride;
            format!("it claims {points} points and holds {there}")
        })?;
    let float = |at: &[u8]| f32::from_be_bytes([at[0], at[1], at[2], at[3]]);
    let points = bytes.0[..all].chunks_exact(stride);
    Ok(points
        .map(|at| vec3(float(at), float(&at[4..]), float(&at[8..])))
        .collect())
}

/// What is left to read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> anyhow::Result<&'a [u8]> {
        let (taken, left) = self.0.split_at_checked(count).context("it is cut short")?;
        self.0 = left;
        Ok(taken)
    }

    fn int(&mut self) -> anyhow::Result<i32> {
        Ok(i32::from_be_bytes(self.take(4)?.try_into()?))
    }

    fn short(&mut self) -> anyhow::Result<usize> {
        Ok(u16::from_be_bytes(self.take(2)?.try_into()?).into())
    }
}
