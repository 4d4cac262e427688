//! How a camera draws fluids, and the one check of all settings.

mod antialiasing;
mod check;
mod checked;
mod debug_view;
mod plane_fit;
#[cfg(feature = "published")]
mod published;
mod range;
mod tracing;

use bevy::{camera::Hdr, core_pipeline::prepass::DepthPrepass, prelude::*};

#[cfg(all(test, feature = "published"))]
pub(crate) use self::check::for_each_number;
#[doc(hidden)]
pub use self::checked::Checked;
pub(crate) use self::checked::check;
#[cfg(feature = "published")]
pub use self::published::{Bilateral, CurvatureFlow, NarrowRange, NormalAverage};
pub use self::{
    antialiasing::Antialiasing,
    check::{SettingError, Settings},
    debug_view::FluidDebugView,
    plane_fit::{PlaneFit, PlaneFitForm},
    range::SettingRange,
    tracing::{Fresnel, Refractions, Search},
};

/// Makes a camera draw particle fluids.
///
/// The presets are points on the measured Pareto front of speed against error (bench
/// `speed_error`): the default is at its knee, [`ScreenSpaceFluid::FAST`] and
/// [`ScreenSpaceFluid::ACCURATE`] on either side. Their docs give times relative to the default, at
/// 320×240 on a software driver, and the FLIP error against ray-traced pictures of a ball and of a
/// half-filled box.
///
/// With a [`MotionVectorPrepass`](bevy::core_pipeline::prepass::MotionVectorPrepass), which temporal
/// antialiasing and motion blur require, the camera has motion vectors of the liquid too.
///
/// Values out of range are logged once and clamped.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(DepthPrepass, Hdr, Checked<Self>)]
pub struct ScreenSpaceFluid {
    /// How the bumps of single particles are removed from the bulk. Default:
    /// [`PlaneFit::DEFAULT`].
    pub smoothing: Smoothing,
    /// Maximum number of interfaces that a ray crosses. Default: four. More: liquid behind liquid
    /// and total internal reflection look right; each interface costs a search.
    pub refractions: Refractions,
    /// How the next interface is found. Default: [`Search::BRACKETED`].
    pub search: Search,
    /// How the Fresnel reflectance of an interface is computed. Default: exact.
    pub fresnel: Fresnel,
    /// Largest gap between the liquid and an opaque surface behind it at which the surface counts
    /// as wetted: rays go straight on to it, without a visible layer of air. Unit: particle radii,
    /// range 0..=8, default 1, the gap that simulations leave between particles and walls. Higher:
    /// thin gaps of air vanish. 0: liquid and solids never touch.
    #[reflect(@SettingRange::new(0.0, 8.0).unit("radii"))]
    pub contact: f32,
    /// How the liquid's own edges and details are antialiased. Default: [`Antialiasing::FULL`].
    pub antialiasing: Antialiasing,
}

impl ScreenSpaceFluid {
    /// One refraction over separably smoothed depth. Time 0.6 (box) to 0.8 (ball) of the
    /// default's; FLIP 0.61 and 0.43 against its 0.52 and 0.24.
    pub const FAST: Self = Self {
        refractions: Refractions::One,
        antialiasing: Antialiasing::Edges,
        ..Self::DEFAULT
    };

    /// The most accurate settings of the method: the search starts with eight coarse samples, and four
    /// more rays go through pixels whose neighbours differ. Time 1.7 to 1.9 of the default's; FLIP 0.52 (box)
    /// and 0.24 (ball).
    pub const ACCURATE: Self = Self {
        search: Search::Bracketed { coarse_samples: 8 },
        antialiasing: Antialiasing::Full { rays: 4 },
        ..Self::DEFAULT
    };

    /// The default: FLIP 0.52 (box) and 0.24 (ball), median error of normals 0.3° (slab) to
    /// 1.6° (rippled pool).
    pub const DEFAULT: Self = Self {
        smoothing: Smoothing::PlaneFit(PlaneFit::DEFAULT),
        refractions: Refractions::Four,
        search: Search::BRACKETED,
        fresnel: Fresnel::Exact,
        contact: 1.0,
        antialiasing: Antialiasing::FULL,
    };
}

impl Settings for ScreenSpaceFluid {}

impl Default for ScreenSpaceFluid {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How the bulk's depth layers are smoothed; spray is never smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Smoothing {
    /// No smoothing.
    None,
    /// A plane is fitted to the window around each pixel (thesis 4.3).
    PlaneFit(PlaneFit),
    /// A bilateral filter of view depth (thesis 3.2, the earlier method).
    #[cfg(feature = "published")]
    Bilateral(Bilateral),
    /// Normals are averaged, depth is unchanged (Takahashi & Doi).
    #[cfg(feature = "published")]
    NormalAverage(NormalAverage),
    /// The narrow-range filter (Truong & Yuksel 2018).
    #[cfg(feature = "published")]
    NarrowRange(NarrowRange),
    /// Curvature flow (van der Laan, Green & Sainz 2009).
    #[cfg(feature = "published")]
    CurvatureFlow(CurvatureFlow),
}

impl Smoothing {
    /// Whether normals come with it.
    pub(crate) fn yields_normals(&self) -> bool {
        match self {
            Self::PlaneFit(_) => true,
            #[cfg(feature = "published")]
            Self::NormalAverage(_) => true,
            _ => false,
        }
    }

    /// The number of passes that read layers and write others.
    pub(crate) fn layer_passes(&self) -> u32 {
        match self {
            Self::None => 0,
            // What is between rows and columns is kept elsewhere.
            Self::PlaneFit(fit) if fit.form == PlaneFitForm::Separable => 0,
            Self::PlaneFit(fit) => fit.iterations,
            #[cfg(feature = "published")]
            Self::NormalAverage(_) => 0,
            #[cfg(feature = "published")]
            Self::Bilateral(filter) => filter.iterations,
            #[cfg(feature = "published")]
            Self::NarrowRange(filter) => 2 * filter.iterations,
            #[cfg(feature = "published")]
            Self::CurvatureFlow(flow) => flow.iterations,
        }
    }
}

impl Default for Smoothing {
    fn default() -> Self {
        Self::PlaneFit(PlaneFit::DEFAULT)
    }
}

/// The half width of a smoothing window.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Clone, PartialEq)]
pub enum Window {
    /// A number of particle radii as they appear on screen, at any distance: taps are spread out
    /// for near particles and dropped for far ones, down to three pixels to each side (plane fits: four
    /// over the square root of their number), which smooth what is smaller than pixels. Range 0.05..=4.
    Radii(#[reflect(@SettingRange::new(0.05, 4.0).unit("radii").logarithmic())] f32),
    /// One pixel per tap, as in the papers.
    Pixels,
}
