//! Pictures of what is off.

use std::path::Path;

use bevy::math::{DVec3, IVec2, UVec2, ivec2, uvec2};
use fluid_reference::{Image, metrics::Edges};
use image::{Rgb, RgbImage, imageops};

use crate::{ReportError, methods::Method, scenes::Scene};

/// What is shown of an edge, pixels.
const CROP: UVec2 = uvec2(64, 48);
/// How much larger.
const ENLARGED: u32 = 4;

/// Writes a picture, its truth, a map of the error and crops of all three.
pub(super) fn write(
    scene: &Scene,
    method: &Method,
    (picture, truth): (&Image<DVec3>, &Image<DVec3>),
    edges: &Edges,
    folder: &Path,
) -> Result<(), ReportError> {
    let stem = stem(scene, method);
    let three = [drawn(picture), drawn(truth), map(picture, truth)];
    for (image, what) in three.iter().zip(["picture", "truth", "map"]) {
        save(image, &folder.join(format!("{stem}_{what}.png")))?;
    }
    let corners = [&edges.outer, &edges.inner, &edges.inside].map(|mask| fullest(mask, truth));
    let crop = CROP.min(truth.size());
    let tile = crop * ENLARGED;
    let mut sheet = RgbImage::new(3 * tile.x + 8, 3 * tile.y + 8);
    for (row, corner) in corners.into_iter().enumerate() {
        for (column, image) in three.iter().enumerate() {
            let part = imageops::crop_imm(image, corner.x, corner.y, crop.x, crop.y).to_image();
            let large = imageops::resize(&part, tile.x, tile.y, imageops::FilterType::Nearest);
            let [x, y] = [column as u32 * (tile.x + 4), row as u32 * (tile.y + 4)];
            imageops::replace(&mut sheet, &large, i64::from(x), i64::from(y));
        }
    }
    save(&sheet, &folder.join(format!("{stem}_crops.png")))
}

/// What names of files begin with.
pub(super) fn stem(scene: &Scene, method: &Method) -> String {
    let parameters = method.parameters.replace([' ', '.', ','], "-");
    format!("{}_{}{parameters}", scene.name, method.name)
}

fn drawn(picture: &Image<DVec3>) -> RgbImage {
    let size = picture.size();
    RgbImage::from_fn(size.x, size.y, |x, y| {
        let color = *picture.get(uvec2(x, y)) * 255.0;
        Rgb(color.to_array().map(|c| c.round() as u8))
    })
}

/// Grey for no error; lighter where the picture is too light, darker where it is too dark. An error
/// of 0.25 is white or black.
fn map(picture: &Image<DVec3>, truth: &Image<DVec3>) -> RgbImage {
    let size = picture.size();
    RgbImage::from_fn(size.x, size.y, |x, y| {
        let error = *picture.get(uvec2(x, y)) - *truth.get(uvec2(x, y));
        let color = DVec3::splat(0.5) + 2.0 * error;
        Rgb((color * 255.0).to_array().map(|c| c.round() as u8))
    })
}

/// The corner of the crop in which most counts of a mask: where the truth has most contrast. It
/// depends on the truth alone, so that pictures of other methods show the same.
fn fullest(mask: &Image<bool>, truth: &Image<DVec3>) -> UVec2 {
    let size = truth.size();
    let contrast = Image::from_fn(size, |pixel| {
        let next = (pixel + 1).min(size - 1);
        let change = *truth.get(next) - *truth.get(pixel);
        if *mask.get(pixel) {
            change.length()
        } else {
            0.0
        }
    });
    let room = (size.as_ivec2() - CROP.as_ivec2()).max(IVec2::ZERO);
    let weight = |corner: IVec2| -> f64 {
        let end = (corner.as_uvec2() + CROP).min(size);
        let rows = corner.y as u32..end.y;
        rows.flat_map(|y| (corner.x as u32..end.x).map(move |x| uvec2(x, y)))
            .map(|pixel| *contrast.get(pixel))
            .sum()
    };
    let corners = (0..=room.y)
        .step_by(12)
        .flat_map(|y| (0..=room.x).step_by(16).map(move |x| ivec2(x, y)));
    let weighed = corners.map(|corner| (corner, weight(corner)));
    let best = weighed.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(UVec2::ZERO, |(corner, _)| corner.as_uvec2())
}

fn save(image: &RgbImage, path: &Path) -> Result<(), ReportError> {
    image.save(path).map_err(|error| ReportError::Plot {
        path: path.into(),
        reason: error.to_string(),
    })
}
