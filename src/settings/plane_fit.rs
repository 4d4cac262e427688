//! Smoothing by plane fits: this crate's and the thesis's.

use bevy::prelude::*;

use super::{SettingRange, Window};

/// Smoothing by a local plane (thesis 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct PlaneFit {
    /// Form of the fit. Default: separable.
    pub form: PlaneFitForm,
    /// Taps to each side of the centre; the window is `2n + 1` wide. Range 1..=8, default 4. More:
    /// smoother between taps, at a linear (separable) or quadratic cost.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("taps"))]
    pub half_taps: u32,
    /// How often the fit is repeated. Range 1..=8, default 2. More: smoother.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("times"))]
    pub iterations: u32,
    /// How large the window is. Default 1.7 radii. Larger: smoother, less detail. Where the surface is
    /// flat, the last of several separable fits with two or more taps takes the slope from a window twice
    /// as large.
    pub window: Window,
    /// Depth difference at which a tap has the weight exp(-1). Unit: particle radii, range 0.5..=4,
    /// default 2. Higher: smoother, but surfaces at different depths begin to blend. With a window in
    /// radii, it is at least as far as the surface's own slope goes over half the window, so that
    /// surfaces seen at a grazing angle are smoothed as well.
    #[reflect(@SettingRange::new(0.5, 4.0).unit("radii"))]
    pub range: f32,
    /// Largest distance by which the fit may move a pixel; beyond it, the old depth is kept. Unit:
    /// particle radii, range 0.1.., default 2. It widens as the range does.
    #[reflect(@SettingRange::new(0.1, 8.0).unit("radii").open())]
    pub bound: f32,
}

impl PlaneFit {
    /// Rows, then columns, in device depth.
    pub const DEFAULT: Self = Self {
        form: PlaneFitForm::Separable,
        half_taps: 4,
        iterations: 2,
        window: Window::Radii(1.7),
        range: 2.0,
        bound: 2.0,
    };

    /// As published: total least squares over 9×9 pixels, three times.
    pub const THESIS: Self = Self {
        form: PlaneFitForm::TotalLeastSquares,
        half_taps: 4,
        iterations: 3,
        window: Window::Pixels,
        ..Self::DEFAULT
    };
}

impl Default for PlaneFit {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What a plane fit minimises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum PlaneFitForm {
    /// Distances to the plane in view space; the normal is an eigenvector (thesis 4.3).
    TotalLeastSquares,
    /// Device depth, which is affine over the pixels of a plane for every projection: a linear
    /// regression over the whole window.
    DeviceDepth,
    /// Device depth, first along rows, then along columns.
    #[default]
    Separable,
}
