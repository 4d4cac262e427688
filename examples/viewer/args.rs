//! The command line.

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_fluid::{
    prelude::ScreenSpaceFluid,
    settings::{
        Bilateral, FluidDebugView, Fresnel, PlaneFit, PlaneFitForm, Refractions, Search, Smoothing,
    },
};
use clap::{
    Parser, ValueEnum,
    builder::{PossibleValuesParser, TypedValueParser},
};

/// Draws the particles of a file as a liquid.
#[derive(Parser, Debug)]
#[command(name = "viewer")]
pub(crate) struct Args {
    /// Particles: .vtk, .bgeo, .ply or .xyz (binary f32 triples or text)
    pub(crate) file: PathBuf,
    /// Particle radius in the file's units
    #[arg(long, value_parser = positive, allow_hyphen_values = true)]
    pub(crate) radius: f32,
    /// Width and height in pixels
    #[arg(long, default_value = "640x480", value_parser = size)]
    pub(crate) size: UVec2,
    /// Position of the camera; chosen from the particles' bounds if not given
    #[arg(long, value_parser = vector, allow_hyphen_values = true)]
    pub(crate) eye: Option<Vec3>,
    /// Point that the camera looks at
    #[arg(long, value_parser = vector, allow_hyphen_values = true)]
    pub(crate) look_at: Option<Vec3>,
    /// Vertical field of view in degrees
    #[arg(long, default_value = "40", value_parser = angle, allow_hyphen_values = true)]
    pub(crate) fov: f32,
    /// Parallel projection
    #[arg(long)]
    pub(crate) orthographic: bool,
    /// How the bulk is smoothed
    #[arg(long, value_enum, default_value_t = SmoothingArg::PlaneFitSeparable)]
    pub(crate) smoothing: SmoothingArg,
    /// Number of interfaces that are refracted
    #[arg(long, default_value = "4", value_parser = PossibleValuesParser::new(["0", "1", "2", "4"]))]
    refractions: String,
    /// How the next interface is found
    #[arg(long, value_enum, default_value_t = SearchArg::Bracketed)]
    search: SearchArg,
    /// How the Fresnel reflectance of an interface is computed
    #[arg(long, value_enum, default_value_t = FresnelArg::Exact)]
    fresnel: FresnelArg,
    /// Spheres instead of anisotropic kernels
    #[arg(long)]
    pub(crate) isotropic: bool,
    /// Show an intermediate result instead of the liquid
    #[arg(long, value_parser = debug_view())]
    pub(crate) debug_view: Option<FluidDebugView>,
    /// Frames to render; statistics are medians over them
    #[arg(long, default_value = "3", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) frames: u32,
    /// Pictures in one, the camera turned a tenth of a degree from each to the next: what sparkles
    /// in motion differs between them
    #[arg(long, default_value = "1", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) orbit: u32,
    /// Write a picture (PNG) instead of opening a window
    #[arg(long, value_parser = png)]
    pub(crate) out: Option<PathBuf>,
    /// Write counts and times (JSON)
    #[arg(long)]
    pub(crate) stats: Option<PathBuf>,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
pub(crate) enum SmoothingArg {
    None,
    PlaneFitTls,
    PlaneFit,
    PlaneFitSeparable,
    Bilateral,
    NormalAverage,
    NarrowRange,
    CurvatureFlow,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum SearchArg {
    Secant,
    Bracketed,
}

#[derive(ValueEnum, Clone, Copy, Debug)]
enum FresnelArg {
    Exact,
    Schlick,
}

impl Args {
    pub(crate) fn settings(&self) -> ScreenSpaceFluid {
        let plane = |form| {
            Smoothing::PlaneFit(PlaneFit {
                form,
                ..PlaneFit::DEFAULT
            })
        };
        ScreenSpaceFluid {
            smoothing: match self.smoothing {
                SmoothingArg::None => Smoothing::None,
                SmoothingArg::PlaneFitTls => plane(PlaneFitForm::TotalLeastSquares),
                SmoothingArg::PlaneFit => plane(PlaneFitForm::DeviceDepth),
                SmoothingArg::PlaneFitSeparable => plane(PlaneFitForm::Separable),
                SmoothingArg::Bilateral => Smoothing::Bilateral(Bilateral::DEFAULT),
                SmoothingArg::NormalAverage => Smoothing::NormalAverage(default()),
                SmoothingArg::NarrowRange => Smoothing::NarrowRange(default()),
                SmoothingArg::CurvatureFlow => Smoothing::CurvatureFlow(default()),
            },
            refractions: match self.refractions.as_str() {
                "0" => Refractions::Zero,
                "1" => Refractions::One,
                "2" => Refractions::Two,
                _ => Refractions::Four,
            },
            search: match self.search {
                SearchArg::Secant => Search::Secant,
                SearchArg::Bracketed => Search::BRACKETED,
            },
            fresnel: match self.fresnel {
                FresnelArg::Exact => Fresnel::Exact,
                FresnelArg::Schlick => Fresnel::Schlick,
            },
            ..default()
        }
    }
}

/// Every view of the crate, by its name in kebab case.
fn debug_view() -> impl TypedValueParser<Value = FluidDebugView> {
    let views = FluidDebugView::ALL.map(|view| (kebab(&format!("{view:?}")), view));
    PossibleValuesParser::new(views.each_ref().map(|(name, _)| name.clone())).try_map(
        move |chosen| {
            let (_, view) = views
                .iter()
                .find(|(name, _)| *name == chosen)
                .ok_or("no such view")?;
            Ok::<_, &str>(*view)
        },
    )
}

fn kebab(camel: &str) -> String {
    let mut kebab = String::new();
    for letter in camel.chars() {
        if letter.is_uppercase() && !kebab.is_empty() {
            kebab.push('-');
        }
        kebab.extend(letter.to_lowercase());
    }
    kebab
}

fn png(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("png") => Ok(path),
        _ => Err("must end in .png".into()),
    }
}

fn positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a positive number".into()),
    }
}

fn angle(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value > 0.0 && value < 180.0 => Ok(value),
        _ => Err("must be between 0 and 180 degrees".into()),
    }
}

fn size(text: &str) -> Result<UVec2, String> {
    text.split_once('x')
        .and_then(|(w, h)| Some(uvec2(w.parse().ok()?, h.parse().ok()?)))
        .filter(|size| size.min_element() > 0 && size.max_element() <= 8192)
        .ok_or_else(|| "must be WIDTHxHEIGHT, each from 1 to 8192".into())
}

fn vector(text: &str) -> Result<Vec3, String> {
    let parts: Vec<f32> = text
        .split(',')
        .map(str::parse)
        .collect::<Result<_, _>>()
        .map_err(|_| "must be x,y,z")?;
    match parts[..] {
        [x, y, z] if vec3(x, y, z).is_finite() => Ok(vec3(x, y, z)),
        _ => Err("must be x,y,z".into()),
    }
}
