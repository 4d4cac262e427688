//! Antialiasing: how far a picture is from the mean over its pixels, at rest and in motion.
//!
//! The truth about a drawn picture is the mean of many of the same size, each seen through other
//! places of its pixels ([`truth`]). All that is measured in pixels, windows and radii, stays as it
//! is, so that nothing but antialiasing differs: what is measured is the method against itself.

mod maps;
mod motion;
mod truth;

use bevy::math::DVec2;
use fluid_reference::metrics::{Edges, MetricError, mean_difference, psnr, share_off, sharpness};

use crate::{
    Options, ReportError,
    methods::{self, Method},
    rig::Rig,
    scenes::{self, Scene},
    surfaces::metric,
    table::Subject,
};
use motion::{Motion, Path};
use truth::{Supersampled, supersample, unfiltered};

/// Difference of some channel (sRGB, 0 to 1) from which on a pixel is off.
const OFF: f64 = 0.2;
/// Difference in view depth that makes an inner edge, in particle radii.
const STEP: f64 = 2.0;

/// A method's picture against its own truth.
pub(crate) struct Aliasing {
    /// Values by region: `outer`, `inner`, `inside`, `beside`, `all` (all but the last but one).
    pub(crate) regions: Vec<(&'static str, Errors)>,
    /// Gradient energy inside the liquid over the truth's; `None` where nothing is inside.
    pub(crate) sharpness: Option<f64>,
    /// By how the camera moves; none if it is to stay still.
    pub(crate) motions: Vec<(Path, Motion)>,
}

/// In sRGB values of 0 to 1.
pub(crate) struct Errors {
    pub(crate) rmse: f64,
    pub(crate) mean: f64,
    /// Share of pixels of which some channel is off by more than [`OFF`].
    pub(crate) off: f64,
}

/// Prints a line for each scene and method, and writes their pictures.
///
/// # Errors
/// No adapter, a picture that cannot be drawn or written, a value that is not a number.
pub fn run(options: &Options) -> Result<(), ReportError> {
    let names = if options.scene.is_empty() {
        scenes::WITH_EDGES.to_vec()
    } else {
        scenes::asked(options)
    };
    let methods: Vec<Method> = if options.method.is_empty() {
        vec![methods::default()]
    } else {
        let mut all = methods::frames(false);
        all.extend(methods::smoothings(false));
        all.retain(|method| options.wants_method(method.name));
        all
    };
    println!("{}", heading());
    for scene in names
        .into_iter()
        .filter_map(|name| scenes::make(options, name))
    {
        let scene = scene?;
        let mut rig = Rig::new(&scene)?;
        for method in &methods {
            let aliasing = measure(&scene, method, &mut rig, options)?;
            println!("{}", line(&scene, method, &aliasing));
        }
    }
    Ok(())
}

/// Measures a method on a scene and writes its pictures.
pub(crate) fn measure(
    scene: &Scene,
    method: &Method,
    rig: &mut Rig,
    options: &Options,
) -> Result<Aliasing, ReportError> {
    let wrong = |source| {
        let (method, parameters) = (method.name, method.parameters.as_str());
        metric(
            Subject {
                scene,
                method,
                parameters,
            },
            source,
        )
    };
    rig.show(&unfiltered(method))?;
    let truth = supersample(rig, &scene.camera, options.jitters)?;
    rig.aim(&scene.camera, DVec2::ZERO);
    rig.frame();
    let fronts = rig.fronts()?;
    let edges = Edges::new(&truth.coverage, &fronts, STEP * scene.radius);
    let paths = if options.still { &[][..] } else { &Path::ALL };
    let distance = motion::distance(scene, &fronts);
    let moving: Vec<_> = paths
        .iter()
        .map(|&path| {
            let jitters = options.jitters.min(motion::JITTERS);
            let cameras = path.cameras(&scene.camera, distance);
            let truths = supersampled(rig, &cameras, jitters)?;
            Ok((path, cameras, truths))
        })
        .collect::<Result<_, ReportError>>()?;

    rig.aim(&scene.camera, DVec2::ZERO);
    rig.show(method)?;
    let picture = rig.picture()?;
    maps::write(
        scene,
        method,
        (&picture, &truth.image),
        &edges,
        &options.out,
    )?;
    let motions = moving
        .into_iter()
        .map(|(path, cameras, truths)| {
            let motion = motion::measure(rig, &cameras, &truths, wrong)?;
            Ok((path, motion))
        })
        .collect::<Result<_, ReportError>>()?;
    rig.aim(&scene.camera, DVec2::ZERO);

    let all = edges.liquid();
    let mut regions = Vec::new();
    for (region, mask) in [
        ("outer", &edges.outer),
        ("inner", &edges.inner),
        ("inside", &edges.inside),
        ("beside", &edges.beside),
        ("all", &all),
    ] {
        if mask.pixels().contains(&true) {
            let errors = errors(&picture, &truth, mask).map_err(wrong)?;
            regions.push((region, errors));
        }
    }
    Ok(Aliasing {
        regions,
        sharpness: sharpness(&picture, &truth.image, Some(&edges.inside)).ok(),
        motions,
    })
}

fn supersampled(
    rig: &mut Rig,
    cameras: &[fluid_reference::Camera],
    jitters: u32,
) -> Result<Vec<Supersampled>, ReportError> {
    let of = |camera| supersample(rig, camera, jitters);
    cameras.iter().map(of).collect()
}

fn errors(
    picture: &truth::Picture,
    truth: &Supersampled,
    mask: &fluid_reference::Image<bool>,
) -> Result<Errors, MetricError> {
    let (truth, mask) = (&truth.image, Some(mask));
    Ok(Errors {
        rmse: 10_f64.powf(-psnr(picture, truth, mask)? / 20.0),
        mean: mean_difference(picture, truth, mask)?,
        off: share_off(picture, truth, OFF, mask)?,
    })
}

/// What the columns of [`line`] are.
fn heading() -> String {
    "scene, method | size | RMSE outer, inner, inside, beside | mean of 255 outer, inner, inside \
     | off by 0.2, all and inside | sharpness | 0.1 px: frames' difference over the truth's, \
     pops, flips | 0.1°: the same"
        .into()
}

fn line(scene: &Scene, method: &Method, of: &Aliasing) -> String {
    let cell = |region: &str, value: fn(&Errors) -> f64| {
        let errors = of.regions.iter().find(|(name, _)| *name == region);
        errors.map_or_else(|| "–".into(), |(_, errors)| format!("{:.4}", value(errors)))
    };
    let cells = |regions: &[&str], value| {
        let cells = regions.iter().map(|region| cell(region, value));
        cells.collect::<Vec<_>>().join(" ")
    };
    let mut cells = vec![
        format!("{}, {}", scene.name, method.label())
            .trim_end()
            .into(),
        format!("{}x{}", scene.camera.size.x, scene.camera.size.y),
        cells(&["outer", "inner", "inside", "beside"], |e| e.rmse),
        cells(&["outer", "inner", "inside"], |e| 255.0 * e.mean),
        cells(&["all", "inside"], |e| e.off),
        of.sharpness
            .map_or_else(|| "–".into(), |s| format!("{s:.3}")),
    ];
    let motions = of.motions.iter().map(|(_, motion)| {
        let Motion { ratio, pops, flips } = motion;
        format!("{ratio:.3} {pops:.4} {flips:.4}")
    });
    cells.extend(motions);
    cells.join(" | ")
}
