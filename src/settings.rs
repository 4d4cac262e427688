//! How a camera draws fluids.

use bevy::{camera::Hdr, core_pipeline::prepass::DepthPrepass, prelude::*};

use crate::range::SettingRange;

/// Makes a camera draw particle fluids.
///
/// The presets are points on the measured front of speed against error (bench `speed_error`): the
/// default stands at its knee, [`ScreenSpaceFluid::FAST`] and [`ScreenSpaceFluid::ACCURATE`] to
/// either side. Their docs give times relative to the default, at 320×240 on a software driver, and
/// FLIP against a traced picture of a ball and of a half-filled box.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(DepthPrepass, Hdr)]
pub struct ScreenSpaceFluid {
    /// How the bumps of single particles are removed from the bulk. Default:
    /// [`PlaneFit::DEFAULT`].
    pub smoothing: Smoothing,
    /// How many interfaces a ray may cross. Default: four. More: liquid behind liquid, and total
    /// reflection inside, look right; each costs a search.
    pub refractions: Refractions,
    /// How the next interface is found. Default: [`Search::BRACKETED`].
    pub search: Search,
    /// How much light an interface reflects. Default: exact.
    pub fresnel: Fresnel,
    /// How far behind the liquid an opaque surface still counts as wetted, so that a ray goes
    /// straight on to it and no layer of air is seen between. Unit: particle radii, range 0..=8,
    /// default 1: what simulations leave between particles and walls. Higher: thin gaps of air
    /// vanish. 0: liquid and solids never touch.
    #[reflect(@SettingRange::new(0.0, 8.0).unit("radii"))]
    pub contact: f32,
}

impl ScreenSpaceFluid {
    /// One refraction over separably smoothed depth. Time 0.48 (box) to 0.71 (ball) of the
    /// default's; FLIP 0.60 and 0.42 against its 0.53 and 0.24.
    pub const FAST: Self = Self {
        refractions: Refractions::One,
        ..Self::DEFAULT
    };

    /// As near to the truth as the method gets: searched in eight steps first.
    /// Time 1.06 of the default's; FLIP 0.53 (box) and 0.23 (ball).
    pub const ACCURATE: Self = Self {
        search: Search::Bracketed { coarse_samples: 8 },
        ..Self::DEFAULT
    };

    /// The default: FLIP 0.53 (box) and 0.24 (ball), normals off by 1.0° in the median.
    pub const DEFAULT: Self = Self {
        smoothing: Smoothing::PlaneFit(PlaneFit::DEFAULT),
        refractions: Refractions::Four,
        search: Search::BRACKETED,
        fresnel: Fresnel::Exact,
        contact: 1.0,
    };

    /// The method of Imai's thesis (2016): total least squares 9×9 × 3, secant search, Schlick.
    /// Beside it belongs [`SurfaceKernel::THESIS`](crate::SurfaceKernel::THESIS). Time 2.0 (box) and
    /// 2.1 (ball) of the default's; FLIP 0.56 and 0.43.
    pub const THESIS: Self = Self {
        smoothing: Smoothing::PlaneFit(PlaneFit::THESIS),
        refractions: Refractions::Four,
        search: Search::Secant,
        fresnel: Fresnel::Schlick,
        contact: 0.0,
    };

    /// The thesis's earlier method: bilateral 7×7 × 22, two refractions, secant, Schlick. Beside
    /// it belongs [`SurfaceKernel::EARLIER`](crate::SurfaceKernel::EARLIER): spheres of one class.
    /// Time 3.4 (box) and 4.6 (ball) of the default's; FLIP 0.55 and 0.39.
    pub const EARLIER: Self = Self {
        smoothing: Smoothing::Bilateral(Bilateral::THESIS),
        refractions: Refractions::Two,
        search: Search::Secant,
        fresnel: Fresnel::Schlick,
        contact: 0.0,
    };
}

impl Default for ScreenSpaceFluid {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// How many interfaces between liquid and air a ray may cross (or be totally reflected at).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Refractions {
    /// Nothing is bent: reflection and absorption along the straight line only.
    Zero,
    /// Only the first surface bends; absorption as along the straight ray.
    One,
    /// Into one body and out of it.
    Two,
    /// Into one body, out of it, into the other class (spray behind bulk, bulk behind spray) and
    /// out of that.
    #[default]
    Four,
}

impl Refractions {
    /// The number of interfaces.
    pub const fn count(self) -> u32 {
        match self {
            Self::Zero => 0,
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }
}

/// How the next interface along a ray is found in a depth layer (METHOD: section 5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Search {
    /// The thesis's secant (3.12), halving the distance while a sample is invalid.
    Secant,
    /// An expanding bracket, then Anderson–Björck steps; at most eight evaluations.
    Bracketed {
        /// Evenly spaced samples taken first, to find the first of several crossings.
        /// Range 0..=32, default 0. More: fewer wrong crossings at steps in depth.
        #[reflect(@SettingRange::new(0.0, 32.0).unit("samples").start(0.0))]
        coarse_samples: u32,
    },
}

impl Search {
    /// The default: bracketed, without coarse samples.
    pub const BRACKETED: Self = Self::Bracketed { coarse_samples: 0 };
}

impl Default for Search {
    fn default() -> Self {
        Self::BRACKETED
    }
}

/// How much of the light an interface reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Fresnel {
    /// The dielectric equations for unpolarised light.
    #[default]
    Exact,
    /// Schlick's approximation; inside with the angle outside. Up to 0.06 off for water.
    Schlick,
}

/// How the bulk's depth layers are smoothed. Spray never is.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Smoothing {
    /// Not at all.
    None,
    /// A plane is fitted to the window around each pixel (thesis 4.3).
    PlaneFit(PlaneFit),
    /// A bilateral filter of view depth (thesis 3.2, the earlier method).
    Bilateral(Bilateral),
    /// Normals are averaged, depth is left alone (Takahashi & Doi).
    NormalAverage(NormalAverage),
    /// The narrow-range filter (Truong & Yuksel 2018).
    NarrowRange(NarrowRange),
    /// Curvature flow (van der Laan, Green & Sainz 2009).
    CurvatureFlow(CurvatureFlow),
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
    /// So many particle radii as they appear on screen, whatever the distance: taps spread out
    /// for near particles and fall away for far ones. Range 0.05..=4.
    Radii(#[reflect(@SettingRange::new(0.05, 4.0).unit("radii").logarithmic())] f32),
    /// As many pixels as there are taps, as the papers have it.
    Pixels,
}

/// Smoothing by a local plane (thesis 4.3; METHOD 4.1 and 4.2).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct PlaneFit {
    /// Which fit. Default: separable.
    pub form: PlaneFitForm,
    /// Taps to each side of the centre; the window is `2n + 1` wide. Range 1..=8, default 5.
    /// More: smoother between taps, at a linear (separable) or quadratic price.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("taps"))]
    pub half_taps: u32,
    /// How often the fit is repeated. Range 1..=8, default 1. More: smoother.
    #[reflect(@SettingRange::new(1.0, 8.0).unit("times"))]
    pub iterations: u32,
    /// How large the window is. Default 1.7 radii. Larger: smoother, less detail.
    pub window: Window,
    /// Depth difference at which a tap counts exp(-1). Unit: particle radii, range 0.5..=4,
    /// default 2. Higher: smoother, but steps in depth begin to leak into each other.
    #[reflect(@SettingRange::new(0.5, 4.0).unit("radii"))]
    pub range: f32,
    /// How far the fit may move a pixel before the old depth is kept. Unit: particle radii,
    /// range 0.1.., default 2.
    #[reflect(@SettingRange::new(0.1, 8.0).unit("radii").open())]
    pub bound: f32,
}

impl PlaneFit {
    /// Rows, then columns, in device depth.
    pub const DEFAULT: Self = Self {
        form: PlaneFitForm::Separable,
        half_taps: 5,
        iterations: 1,
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
    /// The same, first along rows, then along columns.
    #[default]
    Separable,
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
    /// The published taps over a window that follows the particles on screen.
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
    /// δ, the depth difference that belongs to the surface. Unit: particle radii, range 1..=20,
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
    /// steps ring beyond 0.5.
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

/// Shows an intermediate result of a camera with [`ScreenSpaceFluid`] in place of the liquid.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
#[reflect(Component, Clone, PartialEq)]
pub enum FluidDebugView {
    /// Depth of the bulk's front layer, near is bright.
    BulkFront,
    /// Depth of the bulk's back layer.
    BulkBack,
    /// Depth of the spray's front layer.
    SprayFront,
    /// Depth of the spray's back layer.
    SprayBack,
    /// The first interface's normal in view space, −1..=1 shown as 0..=1.
    Normals,
    /// How many interfaces each ray met: 0 black, 1 blue, 2 green, 3 yellow, 4 red.
    Interfaces,
    /// How the searches ended: green all hit, blue no further interface, yellow the ray left the
    /// layer or the screen, red nothing to search in, violet total reflection, orange the
    /// evaluations ran out, grey an opaque surface was met.
    Status,
    /// Bulk blue, spray orange.
    Classes,
    /// The straight way through the liquid at each pixel: black 0, white as far as the body's box
    /// is deep, and where nothing is seen through it.
    Thickness,
    /// Where each ray goes in the end: its direction in view space, −1..=1 shown as 0..=1, half as
    /// bright where it ends at an opaque surface or goes straight on.
    ExitRay,
    /// How many splats are drawn at each pixel: violet 1, red 4, orange 16, white 64 and more.
    /// It takes a pass of its own.
    Overdraw,
}

impl FluidDebugView {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::BulkFront,
        Self::BulkBack,
        Self::SprayFront,
        Self::SprayBack,
        Self::Normals,
        Self::Interfaces,
        Self::Status,
        Self::Classes,
        Self::Thickness,
        Self::ExitRay,
        Self::Overdraw,
    ];
}
