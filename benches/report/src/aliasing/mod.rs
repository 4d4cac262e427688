//! Antialiasing: how far a picture is from the mean over its pixels, at rest and in motion.
//!
//! The truth about a drawn picture is the mean of many of the same size, each seen through other
//! places of its pixels. All that is measured in pixels, windows and radii, stays as it is, so that
//! nothing but antialiasing differs: what is measured is the method against itself.

mod lines;
mod maps;
mod motion;
#[cfg(test)]
mod tests;
mod truth;

use bevy::math::{DVec2, DVec3};
use fluid_reference::{
    Image,
    metrics::{Edges, MetricError, mean_difference, psnr, share_off, sharpness},
};

use crate::{
    Options, ReportError,
    methods::{self, Method},
    rig::Rig,
    scenes::{self, Scene},
    surfaces::metric,
    table::{Subject, Table},
};
use motion::{Motion, Path};
use truth::{kept_or_drawn, unfiltered};

/// Difference of some channel (sRGB, 0 to 1) from which on a pixel is off.
const OFF: f64 = 0.2;
/// Difference in view depth that makes an inner edge, in particle radii.
const STEP: f64 = 2.0;

/// A method's picture against its own truth.
pub(crate) struct Aliasing {
    /// sRGB-encoded.
    pub(crate) picture: Image<DVec3>,
    truth: Image<DVec3>,
    /// The parts of the picture.
    pub(crate) edges: Edges,
    /// Errors of each part, and of what is `beside` the liquid: of those that have pixels.
    errors: Vec<(&'static str, Errors)>,
    /// Gradient energy inside the liquid over the truth's; `None` where nothing is inside.
    sharpness: Option<f64>,
    /// By how the camera moves; none if it stays still.
    motions: Vec<(Path, Motion)>,
}

/// In sRGB values of 0 to 1.
struct Errors {
    rmse: f64,
    mean: f64,
    /// Share of pixels of which some channel is off by more than [`OFF`].
    off: f64,
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
    println!("{}", lines::HEADING);
    for name in names {
        let Some(scene) = scenes::make(options, name).transpose()? else {
            continue;
        };
        let mut rig = Rig::new(&scene)?;
        for method in &methods {
            let aliasing = measure(&scene, method, &mut rig, options, !options.still)?;
            aliasing.draw(&scene, method, &options.out)?;
            println!("{}", lines::line(&scene, method, &aliasing));
        }
    }
    Ok(())
}

/// Measures a method on a scene; in motion too, where most are drawn, if
/// that is wanted.
pub(crate) fn measure(
    scene: &Scene,
    method: &Method,
    rig: &mut Rig,
    options: &Options,
    in_motion: bool,
) -> Result<Aliasing, ReportError> {
    let subject = Subject {
        scene,
        method: method.name,
        parameters: &method.parameters,
    };
    let wrong = |source| metric(subject, source);

    let plain = unfiltered(method);
    rig.show(&plain)?;
    let keep = |what: &str| {
        let size = scene.camera.size;
        let name = format!(
            "{}_{}x{}_{what}.png",
            maps::stem(scene, &plain),
            size.x,
            size.y
        );
        options.truths.as_ref().map(|folder| folder.join(name))
    };
    let jitters = options.jitters();
    let kept = keep(&format!("{jitters}"));
    let truth = kept_or_drawn(rig, &scene.camera, jitters, kept.as_deref())?;
    rig.aim(&scene.camera, DVec2::ZERO);
    rig.frame();
    let fronts = rig.fronts()?;
    let edges = Edges::new(&truth.coverage, &fronts, STEP * scene.radius);
    let paths = if in_motion { &Path::ALL[..] } else { &[] };
    let distance = motion::distance(&scene.camera, &fronts);
    let walks = paths
        .iter()
        .map(|path| path.walk(rig, &scene.camera, distance, options, keep))
        .collect::<Result<Vec<_>, _>>()?;

    rig.aim(&scene.camera, DVec2::ZERO);
    rig.show(method)?;
    let picture = rig.picture()?;
    let motions = walks
        .iter()
        .map(|walk| Ok((walk.path, motion::measure(rig, walk, wrong)?)))
        .collect::<Result<_, ReportError>>()?;
    rig.aim(&scene.camera, DVec2::ZERO);
    rig.frame();

    let errors = edges
        .named()
        .iter()
        .map(|(name, mask)| (*name, mask))
        .chain([("beside", &edges.beside)])
        .filter(|(_, mask)| mask.pixels().contains(&true))
        .map(|(name, mask)| Ok((name, errors(&picture, &truth.image, mask)?)))
        .collect::<Result<_, _>>()
        .map_err(wrong)?;
    Ok(Aliasing {
        errors,
        sharpness: sharpness(&picture, &truth.image, Some(&edges.inside)).ok(),
        motions,
        edges,
        truth: truth.image,
        picture,
    })
}

fn errors(
    picture: &Image<DVec3>,
    truth: &Image<DVec3>,
    mask: &Image<bool>,
) -> Result<Errors, MetricError> {
    let mask = Some(mask);
    Ok(Errors {
        rmse: 10_f64.powf(-psnr(picture, truth, mask)? / 20.0),
        mean: mean_difference(picture, truth, mask)?,
        off: share_off(picture, truth, OFF, mask)?,
    })
}

impl Aliasing {
    /// Writes the picture, its truth, a map of the error and crops to a folder.
    pub(crate) fn draw(
        &self,
        scene: &Scene,
        method: &Method,
        folder: &std::path::Path,
    ) -> Result<(), ReportError> {
        maps::write(
            scene,
            method,
            (&self.picture, &self.truth),
            &self.edges,
            folder,
        )
    }

    /// Writes all values to a table.
    pub(crate) fn write(&self, table: &mut Table, subject: Subject) {
        for (region, errors) in &self.errors {
            table.add(subject, "aliasing_rmse", region, errors.rmse, "1");
            table.add(subject, "aliasing_mean", region, errors.mean, "1");
            table.add(subject, "aliasing_off", region, errors.off, "1");
        }
        if let Some(sharpness) = self.sharpness {
            table.add(subject, "sharpness", "inside", sharpness, "1");
        }
        for (path, motion) in &self.motions {
            let [ratio, pops, flips] = path.quantities();
            table.add(subject, ratio, "all", motion.ratio, "1");
            table.add(subject, pops, "all", motion.pops, "1");
            table.add(subject, flips, "all", motion.flips, "1");
        }
    }
}
