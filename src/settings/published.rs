//! Published filters and presets, for comparison: feature `published`.

use bevy::prelude::*;

use super::{
    Antialiasing, Fresnel, PlaneFit, Refractions, ScreenSpaceFluid, Search, SettingRange,
    Smoothing, Window,
};

impl ScreenSpaceFluid {
    /// The method of Imai's thesis (2016): total least squares 9×9 × 3, secant search, Schlick. Use
    /// it with [`SurfaceKernel::THESIS`](crate::shape::SurfaceKernel::THESIS). Time 1.6 of the
    /// default's; FLIP 0.55 (box) and 0.44 (ball).
    pub const THESIS: Self = Self {
        smoothing: Smoothing::PlaneFit(PlaneFit::THESIS),
        refractions: Refractions::Four,
        search: Search::Secant,
        fresnel: Fresnel::Schlick,
        contact: 0.0,
        antialiasing: Antialiasing::None,
    };

    /// The thesis's earlier method: bilateral 7×7 × 22, two refractions, secant, Schlick. Use it
    /// with [`SurfaceKernel::EARLIER`](crate::shape::SurfaceKernel::EARLIER): spheres of one class. Time
    /// 2.7 (box) and 3.4 (ball) of the default's; FLIP 0.55 and 0.39.
    pub const EARLIER: Self = Self {
        smoothing: Smoothing::Bilateral(Bilateral::THESIS),
        refractions: Refractions::Two,
        search: Search::Secant,
        fresnel: Fresnel::Schlick,
        contact: 0.0,
        antialiasing: Antialiasing::None,
    };
}

/// Bilateral smoothing (thesis 3.2, equation 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct Bilateral {
    /// Taps to each side of the centre. Range 1..=8, default 3.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("taps"))]
    pub half_taps: u32,
    /// How often the filter is repeated. Range 1..=64, default 22.
    #[reflect(@SettingRange::new(1.0, 64.0).unit("times"))]
    pub iterations: u32,
    /// How large the window is. Default 0.5 radii.
    pub window: Window,
    /// σ₂ in particle radii. Range 0.5..=4, default 2√2.
    #[reflect(@SettingRange::new(0.5, 4.0).unit("radii"))]
    pub range: f32,
}

impl Bilateral {
    /// The published taps over a window that scales with the particles on screen.
    pub const DEFAULT: Self = Self {
        half_taps: 3,
        iterations: 22,
        window: Window::Radii(0.5),
        range: 2.0 * core::f32::consts::SQRT_2,
    };

    /// As published: 7×7 pixels, 22 times.
    pub const THESIS: Self = Self {
        window: Window::Pixels,
        ..Self::DEFAULT
    };
}

impl Default for Bilateral {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The mean of the splats' normals over a window (Takahashi & Doi).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct NormalAverage {
    /// Taps to each side of the centre. Range 1..=8, default 4.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("taps"))]
    pub half_taps: u32,
    /// How large the window is. Default 0.65 radii.
    pub window: Window,
}

impl Default for NormalAverage {
    fn default() -> Self {
        Self {
            half_taps: 4,
            window: Window::Radii(0.65),
        }
    }
}

/// The narrow-range filter, along rows and columns in turn (Truong & Yuksel 2018).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct NarrowRange {
    /// Taps to each side of the centre. Range 1..=8, default 6.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("taps"))]
    pub half_taps: u32,
    /// How often rows and columns are filtered. Range 1..=8, default 3.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("times"))]
    pub iterations: u32,
    /// How large the window is. Default 1.5 radii.
    pub window: Window,
    /// δ, the largest depth difference within the surface. Unit: particle radii, range 1..=20,
    /// default 10 as published.
    #[reflect(@SettingRange::new(1.0, 20.0).unit("radii"))]
    pub range: f32,
}

impl Default for NarrowRange {
    fn default() -> Self {
        Self {
            half_taps: 6,
            iterations: 3,
            window: Window::Radii(1.5),
            range: 10.0,
        }
    }
}

/// Explicit steps of mean curvature flow (van der Laan, Green & Sainz 2009).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct CurvatureFlow {
    /// Number of steps. Range 1..=200, default 60.
    #[reflect(@SettingRange::new(1.0, 200.0).unit("steps"))]
    pub iterations: u32,
    /// Time step. Unit: pixels squared, range 0.01..=0.5, default 0.4. Larger: smoother; explicit
    /// steps oscillate beyond 0.5.
    #[reflect(@SettingRange::new(0.01, 0.5).unit("px²"))]
    pub step: f32,
    /// Depth differences beyond this are edges. Unit: particle radii, range 0.5..=8, default 3.
    #[reflect(@SettingRange::new(0.5, 8.0).unit("radii"))]
    pub range: f32,
}

impl Default for CurvatureFlow {
    fn default() -> Self {
        Self {
            iterations: 60,
            step: 0.4,
            range: 3.0,
        }
    }
}
