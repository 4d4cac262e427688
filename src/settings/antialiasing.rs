//! Antialiasing of the liquid itself.

use bevy::prelude::*;

use super::SettingRange;

/// How the liquid's own edges and details are antialiased.
///
/// The camera's antialiasing (MSAA, FXAA, SMAA, TAA) cannot restore what a single ray through the
/// middle of a pixel misses; this needs none of them, and works together with each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Antialiasing {
    /// A pixel shows what the ray through its middle meets.
    None,
    /// Pixels that the liquid covers in part are blended with the background.
    Edges,
    /// The same, and where the light of a pixel differs much from its neighbours', or they see other
    /// surfaces, it is averaged over them, and over more rays through it.
    Full {
        /// Rays through such a pixel besides the one through its middle. Range 0..=8, default 0.
        /// More: less noise where liquid lies behind liquid, and droplets of a few pixels nearer to
        /// the truth. Only those pixels are traced again; two rays add a fifth to a quarter to the
        /// time of a splash.
        #[reflect(@SettingRange::new(0.0, 8.0).unit("rays").initial(0.0))]
        rays: u32,
    },
}

impl Antialiasing {
    /// Edges, and averages over neighbours, without more rays.
    pub const FULL: Self = Self::Full { rays: 0 };

    /// Whether the covered part of each pixel is found.
    pub(crate) fn covers(self) -> bool {
        self != Self::None
    }
}

impl Default for Antialiasing {
    fn default() -> Self {
        Self::FULL
    }
}
