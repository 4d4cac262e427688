//! Images of anything.

use glam::UVec2;
use rayon::prelude::*;

/// Rows of pixels from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<T> {
    size: UVec2,
    pixels: Vec<T>,
}

impl<T> Image<T> {
    /// Asks for every pixel's value, in parallel.
    pub fn from_fn(size: UVec2, value: impl Fn(UVec2) -> T + Sync) -> Self
    where
        T: Send,
    {
        let width = size.x.max(1) as usize;
        let pixels = (0..size.x as usize * size.y as usize)
            .into_par_iter()
            .with_min_len(width.min(64))
            .map(|i| value(UVec2::new((i % width) as u32, (i / width) as u32)))
            .collect();
        Self { size, pixels }
    }

    /// From rows one after another. `None` where their number does not fit the size.
    pub fn from_pixels(size: UVec2, pixels: Vec<T>) -> Option<Self> {
        (pixels.len() == size.x as usize * size.y as usize).then_some(Self { size, pixels })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// A pixel of the image.
    ///
    /// # Panics
    /// Outside of the image.
    pub fn get(&self, pixel: UVec2) -> &T {
        assert!(pixel.cmplt(self.size).all(), "{pixel} of {}", self.size);
        &self.pixels[(pixel.y * self.size.x + pixel.x) as usize]
    }

    /// The pixels next to the border go on beyond it.
    pub(crate) fn clamped(&self, x: i64, y: i64) -> &T {
        let last = self.size.as_i64vec2() - 1;
        let [x, y] = [x.clamp(0, last.x), y.clamp(0, last.y)];
        &self.pixels[(y * i64::from(self.size.x) + x) as usize]
    }

    /// Another image of the same size, pixel by pixel.
    pub fn map<U>(&self, to: impl Fn(&T) -> U) -> Image<U> {
        Image {
            size: self.size,
            pixels: self.pixels.iter().map(to).collect(),
        }
    }
}
