//! How far a picture, or what it was made of, is from the truth.
//!
//! Masks pick the pixels that count, for example those of one of the [`Regions`]; `None` means
//! all of them. A value that is not a number is an error that names the metric: it never
//! disappears in a mean.

mod aliasing;
mod edges;
mod filter;
mod flip;
mod geometry;
mod pictures;
mod quantiles;
mod regions;
mod search;

use glam::UVec2;
use thiserror::Error;

use crate::Image;

pub use aliasing::{mean_difference, share_off, sharpness};
pub use edges::{Edges, Front};
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use geometry::{
    DepthError, depth_error, direction_error, furnace_error, normal_error, silhouette_iou,
};
pub use pictures::{decode_srgb, encode_srgb, mean, psnr, ssim};
pub use quantiles::Quantiles;
pub use regions::Regions;
pub use search::{Search, SearchReport, Status, search_report};

/// Why something cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MetricError {
    /// Two images do not fit.
    #[error("{metric}: one image has {a} pixels and the other {b}")]
    Size {
        /// What was to be measured.
        metric: &'static str,
        /// Size of the first.
        a: UVec2,
        /// Size of the second.
        b: UVec2,
    },
    /// A value is NaN or infinite, or a direction has no length.
    #[error("{metric}: value {index} is not finite")]
    NotFinite {
        /// What was to be measured.
        metric: &'static str,
        /// Its number among the values that count; for images, of all pixels row by row.
        index: usize,
    },
    /// No pixel counts.
    #[error("{metric}: nothing to measure")]
    Empty {
        /// What was to be measured.
        metric: &'static str,
    },
}

type Mask<'a> = Option<&'a Image<bool>>;

/// That images are of one size, and their mask too.
fn same_size<A, B>(
    metric: &'static str,
    a: &Image<A>,
    b: &Image<B>,
    mask: Mask,
) -> Result<(), MetricError> {
    let sizes = [b.size(), mask.map_or(a.size(), Image::size)];
    match sizes.into_iter().find(|&size| size != a.size()) {
        Some(b) => Err(MetricError::Size {
            metric,
            a: a.size(),
            b,
        }),
        None => Ok(()),
    }
}

/// Numbers of the pixels that count.
fn counted(size: UVec2, mask: Mask<'_>) -> impl Iterator<Item = usize> {
    let all = 0..size.x as usize * size.y as usize;
    all.filter(move |&i| mask.is_none_or(|mask| mask.pixels()[i]))
}
