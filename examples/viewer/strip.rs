//! Several pictures in one.

use bevy::prelude::*;
use fluid_stage::{StageError, capture, scenery::turn_cameras, step};
use image::{RgbaImage, imageops};

/// Pictures beside one another.
const COLUMNS: u32 = 4;
/// By how much the camera turns from one to the next, degrees: slow enough for the eye to follow,
/// and for what sparkles to do so while all else hardly moves.
const TURN: f32 = 0.1;

/// `count` pictures of a slow orbit, row by row; one is the stage's picture itself.
pub(crate) fn capture_orbit(app: &mut App, count: u32) -> Result<RgbaImage, StageError> {
    let first = capture(app)?;
    let (width, height) = first.dimensions();
    let columns = count.clamp(1, COLUMNS);
    let mut sheet = RgbaImage::new(columns * width, count.div_ceil(COLUMNS).max(1) * height);
    imageops::replace(&mut sheet, &first, 0, 0);
    for i in 1..count {
        turn_cameras(app.world_mut(), TURN.to_radians());
        step(app, 1);
        let [x, y] = [i % COLUMNS * width, i / COLUMNS * height];
        imageops::replace(&mut sheet, &capture(app)?, x.into(), y.into());
    }
    Ok(sheet)
}
