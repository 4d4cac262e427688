//! The methods beside each other, each with its parameters.

use std::collections::HashSet;

use bevy::color::Color;
use bevy_fluid::{
    prelude::{FluidMaterial, Medium, ScreenSpaceFluid, SurfaceKernel, Thickness},
    settings::{
        Antialiasing, Bilateral, CurvatureFlow, Fresnel, NarrowRange, NormalAverage, PlaneFit,
        PlaneFitForm, Refractions, Search, Smoothing, Window,
    },
};

/// Settings by name.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    pub(crate) name: &'static str,
    pub(crate) parameters: String,
    pub(crate) settings: ScreenSpaceFluid,
    pub(crate) kernel: SurfaceKernel,
    pub(crate) material: FluidMaterial,
}

impl Method {
    fn new(name: &'static str, parameters: impl Into<String>, settings: ScreenSpaceFluid) -> Self {
        Self {
            name,
            parameters: parameters.into(),
            settings,
            kernel: SurfaceKernel::DEFAULT,
            material: FluidMaterial::WATER,
        }
    }

    fn smoothing(name: &'static str, parameters: String, smoothing: Smoothing) -> Self {
        let settings = ScreenSpaceFluid {
            smoothing,
            ..ScreenSpaceFluid::DEFAULT
        };
        Self::new(name, parameters, settings)
    }

    /// As lines of the table and legends tell them apart.
    pub(crate) fn label(&self) -> String {
        format!("{} {}", self.name, self.parameters)
    }

    pub(crate) fn is_among(&self, methods: &[Self]) -> bool {
        methods.iter().any(|method| method.label() == self.label())
    }
}

pub(crate) const SEPARABLE: &str = "plane-fit-separable";
pub(crate) const DEVICE_DEPTH: &str = "plane-fit-2d";
pub(crate) const TLS: &str = "plane-fit-tls";
pub(crate) const BILATERAL: &str = "bilateral";
pub(crate) const NORMAL_AVERAGE: &str = "normal-average";
pub(crate) const NARROW_RANGE: &str = "narrow-range";
pub(crate) const CURVATURE_FLOW: &str = "curvature-flow";
pub(crate) const NONE: &str = "none";
pub(crate) const DEFAULT: &str = "default";
pub(crate) const THESIS: &str = "thesis";
pub(crate) const EARLIER: &str = "thesis-earlier";
pub(crate) const THICKNESS: &str = "thickness";

/// The frames that are presets.
pub(crate) const PRESETS: [&str; 5] = [DEFAULT, "fast", "accurate", THESIS, EARLIER];

/// Those whose antialiasing is measured in motion too.
pub(crate) const IN_MOTION: [&str; 3] = [DEFAULT, "fast", THESIS];

/// What the default's other ways to antialias are called.
const ANTIALIASING: &str = "antialiasing";

/// Whether a method of this name is a way to smooth, and not a whole frame.
pub(crate) fn smooths(name: &str) -> bool {
    [
        NONE,
        SEPARABLE,
        DEVICE_DEPTH,
        TLS,
        BILATERAL,
        NORMAL_AVERAGE,
        NARROW_RANGE,
        CURVATURE_FLOW,
    ]
    .contains(&name)
}

/// The default, as a whole frame.
pub(crate) fn default() -> Method {
    Method::new(DEFAULT, "", ScreenSpaceFluid::DEFAULT)
}

/// The default's way to smooth.
pub(crate) fn default_smoothing() -> Method {
    let default = PlaneFit::DEFAULT;
    fit(
        default.form,
        default.half_taps,
        default.iterations,
        default.window,
    )
}

/// What methods are called.
pub(crate) fn names() -> Vec<&'static str> {
    let mut known = HashSet::new();
    let mut names: Vec<_> = smoothings(false)
        .iter()
        .chain(&frames(false))
        .chain(&searches(false))
        .chain(&thicknesses())
        .map(|method| method.name)
        .collect();
    names.retain(|name| known.insert(*name));
    names
}

fn fit(form: PlaneFitForm, half_taps: u32, iterations: u32, window: Window) -> Method {
    let name = match form {
        PlaneFitForm::TotalLeastSquares => TLS,
        PlaneFitForm::DeviceDepth => DEVICE_DEPTH,
        PlaneFitForm::Separable => SEPARABLE,
    };
    let fit = PlaneFit {
        form,
        half_taps,
        iterations,
        window,
        ..PlaneFit::DEFAULT
    };
    let parameters = format!("{} x{iterations} {}", taps(half_taps), extent(window));
    Method::smoothing(name, parameters, Smoothing::PlaneFit(fit))
}

fn bilateral(half_taps: u32, iterations: u32, window: Window) -> Method {
    let filter = Bilateral {
        half_taps,
        iterations,
        window,
        ..Bilateral::DEFAULT
    };
    let parameters = format!("{} x{iterations} {}", taps(half_taps), extent(window));
    Method::smoothing(BILATERAL, parameters, Smoothing::Bilateral(filter))
}

fn taps(half: u32) -> String {
    let whole = 2 * half + 1;
    format!("{whole}x{whole}")
}

fn extent(window: Window) -> String {
    match window {
        Window::Radii(radii) => format!("{radii}r"),
        Window::Pixels => "px".into(),
    }
}

/// Ways to smooth, all else as in the default.
pub(crate) fn smoothings(quick: bool) -> Vec<Method> {
    use PlaneFitForm::{DeviceDepth, Separable, TotalLeastSquares};
    let mut methods = vec![
        Method::smoothing(NONE, String::new(), Smoothing::None),
        default_smoothing(),
        fit(TotalLeastSquares, 4, 3, Window::Pixels),
        bilateral(3, 22, Window::Pixels),
        narrow_range(3, 1.5),
        Method::smoothing(
            NORMAL_AVERAGE,
            "9x9 0.65r".into(),
            Smoothing::NormalAverage(NormalAverage::default()),
        ),
    ];
    if quick {
        return methods;
    }
    for (half_taps, iterations, radii) in SEPARABLE_GRID {
        methods.push(fit(Separable, half_taps, iterations, Window::Radii(radii)));
    }
    for (half_taps, iterations, radii) in [(4, 1, 1.7), (2, 2, 1.3), (4, 2, 0.65), (4, 3, 1.0)] {
        methods.push(fit(
            DeviceDepth,
            half_taps,
            iterations,
            Window::Radii(radii),
        ));
        methods.push(fit(
            TotalLeastSquares,
            half_taps,
            iterations,
            Window::Radii(radii),
        ));
    }
    for (iterations, radii) in [(5, 1.0), (11, 0.5), (22, 0.5)] {
        methods.push(bilateral(3, iterations, Window::Radii(radii)));
    }
    for (iterations, radii) in [(1, 1.5), (1, 3.0), (3, 3.0)] {
        methods.push(narrow_range(iterations, radii));
    }
    for iterations in [20, 60, 150] {
        let flow = CurvatureFlow {
            iterations,
            ..CurvatureFlow::default()
        };
        let parameters = format!("x{iterations}");
        let smoothing = Smoothing::CurvatureFlow(flow);
        methods.push(Method::smoothing(CURVATURE_FLOW, parameters, smoothing));
    }
    for (half_taps, radii) in [(4, 1.3), (8, 2.0)] {
        let average = NormalAverage {
            half_taps,
            window: Window::Radii(radii),
        };
        let parameters = format!("{} {radii}r", taps(half_taps));
        let smoothing = Smoothing::NormalAverage(average);
        methods.push(Method::smoothing(NORMAL_AVERAGE, parameters, smoothing));
    }
    drop_twins(&mut methods);
    methods
}

/// Keeps the first of methods of equal name and parameters.
pub(crate) fn drop_twins(methods: &mut Vec<Method>) {
    let mut labels = HashSet::new();
    methods.retain(|method| labels.insert(method.label()));
}

/// Half taps, iterations, half window in radii.
const SEPARABLE_GRID: [(u32, u32, f32); 14] = [
    (2, 1, 1.3),
    (3, 1, 1.3),
    (4, 1, 1.3),
    (4, 1, 1.7),
    (4, 1, 2.3),
    (6, 1, 2.0),
    (2, 2, 0.65),
    (2, 2, 1.3),
    (3, 2, 1.0),
    (4, 2, 0.65),
    (4, 2, 1.0),
    (3, 3, 0.65),
    (4, 3, 1.0),
    (4, 4, 0.65),
];

fn narrow_range(iterations: u32, radii: f32) -> Method {
    let filter = NarrowRange {
        iterations,
        window: Window::Radii(radii),
        ..NarrowRange::default()
    };
    let parameters = format!("13 x{iterations} {radii}r");
    Method::smoothing(NARROW_RANGE, parameters, Smoothing::NarrowRange(filter))
}

/// Whole frames: the presets, and what each of the default's choices does.
pub(crate) fn frames(quick: bool) -> Vec<Method> {
    let default = ScreenSpaceFluid::DEFAULT;
    let with = |refractions| ScreenSpaceFluid {
        refractions,
        ..default
    };
    let antialiased = |parameters: &str, antialiasing| {
        let settings = ScreenSpaceFluid {
            antialiasing,
            ..default
        };
        Method::new(ANTIALIASING, parameters, settings)
    };
    let mut methods = vec![
        self::default(),
        Method::new("fast", "", ScreenSpaceFluid::FAST),
        Method::new("accurate", "", ScreenSpaceFluid::ACCURATE),
        Method {
            kernel: SurfaceKernel::THESIS,
            ..Method::new(THESIS, "", ScreenSpaceFluid::THESIS)
        },
        Method {
            kernel: SurfaceKernel::EARLIER,
            ..Method::new(EARLIER, "", ScreenSpaceFluid::EARLIER)
        },
        antialiased("none", Antialiasing::None),
        antialiased("edges", Antialiasing::Edges),
        antialiased("2 rays", Antialiasing::Full { rays: 2 }),
        antialiased("4 rays", Antialiasing::Full { rays: 4 }),
        Method::new("refractions", "0", with(Refractions::Zero)),
        Method::new("refractions", "1", with(Refractions::One)),
        Method::new("refractions", "2", with(Refractions::Two)),
    ];
    if !quick {
        methods.extend(searches(quick).into_iter().map(|method| Method {
            settings: ScreenSpaceFluid {
                refractions: Refractions::Four,
                ..method.settings
            },
            ..method
        }));
        let schlick = ScreenSpaceFluid {
            fresnel: Fresnel::Schlick,
            ..default
        };
        methods.push(Method::new("fresnel", "schlick", schlick));
    }
    methods
}

/// The frames that differ in how they antialias.
pub(crate) fn antialiased() -> Vec<Method> {
    let mut methods = frames(true);
    methods.retain(|method| method.name == ANTIALIASING || PRESETS.contains(&method.name));
    methods
}

/// Ways to search, through two interfaces: what is found is the first search's doing.
pub(crate) fn searches(quick: bool) -> Vec<Method> {
    let mut ways = vec![("secant", String::new(), Search::Secant)];
    let samples: &[u32] = if quick { &[0] } else { &[0, 4, 8, 16] };
    for &coarse_samples in samples {
        ways.push((
            "bracketed",
            format!("{coarse_samples} coarse"),
            Search::Bracketed { coarse_samples },
        ));
    }
    let method = |(name, parameters, search)| {
        let settings = ScreenSpaceFluid {
            search,
            refractions: Refractions::Two,
            ..ScreenSpaceFluid::DEFAULT
        };
        Method::new(name, parameters, settings)
    };
    ways.into_iter().map(method).collect()
}

/// Ways to find how thick an even, unbending fog is that halves light every metre.
pub(crate) fn thicknesses() -> Vec<Method> {
    let way = |parameters: &str, thickness| Method {
        material: FluidMaterial {
            refractive_index: 1.0,
            medium: Medium::absorbing(Color::linear_rgb(0.5, 0.5, 0.5), 1.0),
            thickness,
            ..FluidMaterial::CLEAR_WATER
        },
        ..Method::new(THICKNESS, parameters, ScreenSpaceFluid::DEFAULT)
    };
    let mut ways = vec![way("layers", Thickness::Layers)];
    ways.extend([0.0, 1.0, 2.0].map(|softness| {
        let thickness = Thickness::Accumulated { softness };
        way(&format!("summed, softness {softness}"), thickness)
    }));
    ways
}

/// The parameters of the thesis's tables 5.3 and 5.4: sizes by iterations.
pub(crate) fn table(bilaterally: bool) -> Vec<Method> {
    let (halves, iterations): ([u32; 4], [u32; 4]) = if bilaterally {
        ([2, 3, 4, 5], [11, 22, 33, 44])
    } else {
        ([3, 4, 5, 6], [1, 2, 3, 4])
    };
    let way = |half, iterations| {
        if bilaterally {
            bilateral(half, iterations, Window::Pixels)
        } else {
            fit(
                PlaneFitForm::TotalLeastSquares,
                half,
                iterations,
                Window::Pixels,
            )
        }
    };
    halves
        .into_iter()
        .flat_map(|half| iterations.map(|iterations| way(half, iterations)))
        .collect()
}
