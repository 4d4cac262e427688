//! How far pictures are from the tracer's.

use bevy::math::DVec3;
use bevy_fluid::{
    prelude::{FluidMaterial, ScreenSpaceFluid},
    settings::{Fresnel, Refractions},
};
use fluid_reference::{
    Image, Surface,
    mesh::LayerMeshes,
    metrics::{PIXELS_PER_DEGREE, encode_srgb, flip, furnace_error, mean, psnr, ssim},
    tracer::{Object, Tracer, World},
};

use crate::{
    ReportError,
    methods::{self, Method},
    rig::{Rig, Seen},
    scenes::Scene,
    surfaces::metric,
    surroundings::sky,
    table::{Subject, Table},
    truth::{Truth, water},
};

/// What the true picture is of a scene, sRGB-encoded; black where no pixel is judged.
pub(crate) struct TruePicture {
    image: Image<DVec3>,
    /// Whether all of it is there, so that perceptual metrics mean something.
    whole: bool,
    /// Where it is judged, by name; `deep` is where light meets more than two interfaces.
    regions: Vec<(&'static str, Image<bool>)>,
    names: Names,
}

/// The root of the number of rays through each pixel of a true picture.
const RAYS: u32 = 8;
/// The same where the surface is implicit: a hundred times as slow.
const IMPLICIT_RAYS: u32 = 2;

/// What the table calls errors from a picture.
#[derive(Clone, Copy)]
struct Names {
    psnr: &'static str,
    rmse: &'static str,
    flip: &'static str,
    ssim: &'static str,
}

/// From the truth.
const TRUTH: Names = Names {
    psnr: "psnr",
    rmse: "picture_rmse",
    flip: "flip",
    ssim: "ssim",
};

/// From what the renderer would compute were its layers and searches perfect.
const MODEL: Names = Names {
    psnr: "psnr_model",
    rmse: "picture_rmse_model",
    flip: "flip_model",
    ssim: "ssim_model",
};

impl TruePicture {
    /// Every reflection and refraction at the true surface, the mean over each pixel: what one ray
    /// through its middle sees would punish an edge without stairs.
    pub(crate) fn of(
        scene: &Scene,
        truth: &Truth,
        mut regions: Vec<(&'static str, Image<bool>)>,
    ) -> Self {
        let objects = scene.around.objects();
        let tracer = Tracer::truth(world(truth.surface(), &objects), water());
        let whole = matches!(truth, Truth::Exact(_));
        let all = regions[0].1.clone();
        if whole {
            let tracer = Tracer {
                interfaces: 3,
                ..Tracer::renderer(world(truth.surface(), &objects), water())
            };
            let is_deep = |pixel| tracer.path(scene.camera.pixel_ray(pixel)).vertices.len() > 2;
            let deep = Image::from_fn(scene.camera.size, |pixel| *all.get(pixel) && is_deep(pixel));
            regions.push(("deep", deep));
        }
        let side = if whole { RAYS } else { IMPLICIT_RAYS };
        let image = Image::from_fn(scene.camera.size, |pixel| {
            if whole || *all.get(pixel) {
                encode_srgb(tracer.pixel(&scene.camera, pixel, side))
            } else {
                DVec3::ZERO
            }
        });
        Self {
            image,
            whole,
            regions,
            names: TRUTH,
        }
    }

    /// What is left of the truth in the renderer's model: four interfaces, and reflections of the
    /// sky alone. Only of scenes whose form is known, for the implicit surface is slow.
    pub(crate) fn of_model(scene: &Scene, of: &Self) -> Option<Self> {
        let exact = scene.exact.as_deref()?;
        let objects = scene.around.objects();
        let tracer = Tracer::renderer(world(exact, &objects), water());
        Some(Self {
            image: tracer.render(&scene.camera, RAYS).map(|c| encode_srgb(*c)),
            whole: true,
            regions: of.regions.clone(),
            names: MODEL,
        })
    }
}

fn world<'a>(surface: &'a dyn Surface, objects: &'a [Object]) -> World<'a> {
    World {
        surface,
        objects,
        sky: &sky,
    }
}

/// The picture as it is drawn against a true one.
pub(crate) fn measure(
    table: &mut Table,
    subject: Subject,
    truth: &TruePicture,
    got: &Image<DVec3>,
) -> Result<(), ReportError> {
    let wrong = |source| metric(subject, source);
    let maps = if truth.whole {
        Some((
            flip(&truth.image, got, PIXELS_PER_DEGREE).map_err(wrong)?,
            ssim(&truth.image, got).map_err(wrong)?,
        ))
    } else {
        None
    };
    for (region, mask) in &truth.regions {
        if !mask.pixels().contains(&true) {
            continue;
        }
        // Of pictures that do not differ at all it is infinite.
        let peak = psnr(&truth.image, got, Some(mask))
            .map_err(wrong)?
            .min(99.0);
        table.add(subject, truth.names.psnr, region, peak, "dB");
        let rmse = 10_f64.powf(-peak / 20.0);
        table.add(subject, truth.names.rmse, region, rmse, "1");
        if let Some((flip, ssim)) = &maps {
            let flip = mean("FLIP", flip, Some(mask)).map_err(wrong)?;
            table.add(subject, truth.names.flip, region, flip, "1");
            let ssim = mean("SSIM", ssim, Some(mask)).map_err(wrong)?;
            table.add(subject, truth.names.ssim, region, ssim, "1");
        }
    }
    Ok(())
}

/// A picture of exact rays through the renderer's own layers: the thesis's reference. What the
/// renderer is off from it, its search and its order of interfaces are to blame for.
pub(crate) fn through_layers(scene: &Scene, seen: &Seen, method: &Method) -> Image<DVec3> {
    let layers = [&seen.bulk, &seen.spray].map(Clone::clone);
    let meshes = LayerMeshes::new(&scene.camera, &layers, 2.0 * scene.radius);
    let objects = scene.around.objects();
    let tracer = Tracer {
        interfaces: method.settings.refractions.count(),
        each_body_once: true,
        ..Tracer::renderer(world(&meshes, &objects), water())
    };
    tracer.render(&scene.camera, RAYS).map(|c| encode_srgb(*c))
}

/// Which part of the picture's error comes from the layers and which from the search.
pub(crate) fn ablate(
    table: &mut Table,
    scene: &Scene,
    truth: &TruePicture,
    rig: &mut Rig,
) -> Result<(), ReportError> {
    let method = methods::default();
    rig.show(&method)?;
    let subject = |parameters| Subject {
        scene,
        method: "ablation",
        parameters,
    };
    let seen = rig.seen()?;
    let drawn = rig.picture()?;
    let exact_search = through_layers(scene, &seen, &method);
    let of = subject("our layers, exact search");
    measure(table, of, truth, &exact_search)?;
    measure(table, subject("our layers, our search"), truth, &drawn)?;
    // Against each other: what the search alone is off by.
    let alone = TruePicture {
        image: exact_search,
        whole: true,
        regions: truth.regions.clone(),
        names: TRUTH,
    };
    measure(
        table,
        subject("our search against exact search"),
        &alone,
        &drawn,
    )?;
    let bulk = scene.exact_bulk.as_deref().or(scene.exact.as_deref());
    if let Some(bulk) = bulk {
        let spans = fluid_reference::layers(&scene.camera, bulk);
        rig.put_exact_layers(Some(&spans));
        rig.frame();
        let drawn = rig.picture()?;
        rig.put_exact_layers(None);
        measure(table, subject("exact layers, our search"), truth, &drawn)?;
    }
    Ok(())
}

/// Light made or lost in a white furnace.
pub(crate) fn measure_furnace(
    table: &mut Table,
    scene: &Scene,
    rig: &mut Rig,
) -> Result<(), ReportError> {
    rig.heat(true);
    for (name, fresnel) in [("exact", Fresnel::Exact), ("schlick", Fresnel::Schlick)] {
        let settings = ScreenSpaceFluid {
            fresnel,
            refractions: Refractions::Four,
            ..ScreenSpaceFluid::DEFAULT
        };
        rig.show(&Method {
            settings,
            material: FluidMaterial::CLEAR_WATER,
            ..methods::default()
        })?;
        let [radiance, transmission] = rig.light()?;
        let there = radiance.map(Option::is_some);
        let [radiance, transmission] =
            [radiance, transmission].map(|light| light.map(|light| light.unwrap_or(DVec3::ZERO)));
        let subject = Subject {
            scene,
            method: "furnace",
            parameters: name,
        };
        let error = furnace_error(&radiance, &transmission, Some(&there))
            .map_err(|source| metric(subject, source))?;
        table.add(subject, "furnace_p50", "all", error.p50, "1");
        table.add(subject, "furnace_max", "all", error.max, "1");
    }
    rig.heat(false);
    Ok(())
}
