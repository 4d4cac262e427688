//! Zipped files, of any format.

use std::{
    borrow::Cow,
    io::{Read, Write},
};

use flate2::{Compression, read::MultiGzDecoder, write::GzEncoder};

use super::found::Fault;

/// The most bytes after unzipping: a few kilobytes can be zipped gigabytes of nothing.
const MAX_BYTES: u64 = 1 << 30;

/// The content of a file, which is unzipped if it begins as zipped files do.
pub(super) fn unzipped(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Fault> {
    if !bytes.starts_with(b"\x1f\x8b\x08") {
        return Ok(bytes.into());
    }
    let mut unzipped = Vec::new();
    MultiGzDecoder::new(bytes)
        .take(MAX_BYTES + 1)
        .read_to_end(&mut unzipped)
        .map_err(|error| Fault::Damaged(format!("it cannot be unzipped: {error}")))?;
    if unzipped.len() as u64 > MAX_BYTES {
        let most = MAX_BYTES;
        return Err(Fault::Unsupported(format!(
            "it unzips to more than {most} bytes"
        )));
    }
    Ok(unzipped.into())
}

pub(super) fn zipped(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut zip = GzEncoder::new(Vec::new(), Compression::fast());
    zip.write_all(bytes)?;
    zip.finish()
}
