//! How far the drawn surface is from the true one.

use bevy::math::{DVec3, UVec2};
use fluid_reference::{
    Hit, Image, Span,
    mesh::{Layer, Sheet},
    metrics::{Regions, depth_error, normal_error, silhouette_iou},
};

use crate::{
    ReportError,
    methods::Method,
    rig::Rig,
    scenes::Scene,
    table::{Subject, Table},
    truth::{Splats, Truth},
};

/// Difference in depth from pixel to pixel that makes an outline, in particle radii: more than a
/// plane at 80° has at three pixels a radius.
const OUTLINE: f64 = 5.0;
/// Cosine below which a surface is grazed.
const GRAZING: f64 = 0.2;

/// The parts of a scene's picture, by its splats: the same for all methods.
pub(crate) fn regions(scene: &Scene, truth: &Truth, raw: &Layer) -> Regions {
    let camera = &scene.camera;
    let spans = Image::from_fn(camera.size, |pixel| {
        let hit = |sheet: &Sheet| {
            let device_depth = (*sheet.depth.get(pixel))?;
            let view_depth = camera.view_from_device(device_depth);
            let point = camera.unproject(pixel.as_dvec2() + 0.5, view_depth);
            let ray = camera.pixel_ray(pixel);
            let nearest = truth.nearest(camera, pixel, point);
            Some(Hit {
                t: ray.direction.dot(point - ray.origin),
                view_depth,
                device_depth,
                normal: nearest.map_or(-ray.direction, |nearest| nearest.normal),
            })
        };
        Some(Span {
            front: hit(&raw.front)?,
            back: hit(&raw.back)?,
        })
    });
    let nearest_depth = spans
        .pixels()
        .iter()
        .flatten()
        .map(|span| span.front.view_depth)
        .fold(f64::INFINITY, f64::min);
    let pixels_per_radius = scene.radius / camera.pixel_size(nearest_depth.min(1e9));
    let band = (pixels_per_radius.ceil() as u32).clamp(2, 30);
    let parts = Regions::new(camera, &spans, band, OUTLINE * scene.radius, GRAZING);
    let judged = |mask: &Image<bool>| {
        Image::from_fn(camera.size, |pixel| *mask.get(pixel) && truth.judges(pixel))
    };
    Regions {
        interior: judged(&parts.interior),
        silhouette: judged(&parts.silhouette),
        grazing: judged(&parts.grazing),
    }
}

/// The regions by name, and all of them together.
pub(crate) fn named(regions: &Regions) -> [(&'static str, Image<bool>); 4] {
    let Regions {
        interior,
        silhouette,
        grazing,
    } = regions;
    let all = Image::from_fn(interior.size(), |pixel| {
        [interior, silhouette, grazing]
            .iter()
            .any(|mask| *mask.get(pixel))
    });
    [
        ("all", all),
        ("interior", interior.clone()),
        ("silhouette", silhouette.clone()),
        ("grazing", grazing.clone()),
    ]
}

/// The layers before smoothing against the exact union of the ellipsoids.
pub(crate) fn measure_layers(
    table: &mut Table,
    scene: &Scene,
    splats: &Splats,
    rig: &Rig,
) -> Result<(), ReportError> {
    let seen = rig.seen()?;
    let exact = splats.layers(&scene.camera);
    let subject = |method| Subject {
        scene,
        method,
        parameters: "",
    };
    for (method, got, exact) in [
        ("layers-bulk", &seen.bulk, &exact[0]),
        ("layers-spray", &seen.spray, &exact[1]),
    ] {
        let is_there = exact.map(Option::is_some);
        if !is_there.pixels().contains(&true) {
            continue;
        }
        let subject = subject(method);
        let wrong = |source| metric(subject, source);
        let drawn = got.front.depth.map(Option::is_some);
        let iou = silhouette_iou(&drawn, &is_there).map_err(wrong)?;
        table.add(subject, "silhouette_iou", "all", iou, "1");
        let step = OUTLINE * scene.radius;
        let parts = Regions::new(&scene.camera, exact, 1, step, GRAZING);
        for (side, sheet, hit) in [
            (
                "front_depth_rmse",
                &got.front,
                (|s: &Span| s.front) as fn(&Span) -> Hit,
            ),
            ("back_depth_rmse", &got.back, |s| s.back),
        ] {
            let measured = view_depths(scene, sheet);
            let truth = exact.map(|span| span.as_ref().map(|span| hit(span).view_depth));
            for (region, mask) in [("all", None), ("interior", Some(&parts.interior))] {
                if mask.is_some_and(|mask| !mask.pixels().contains(&true)) {
                    continue;
                }
                let error = depth_error(&measured, &truth, mask, scene.radius).map_err(wrong)?;
                table.add(subject, side, region, error.rmse, "r");
            }
        }
    }
    Ok(())
}

fn view_depths(scene: &Scene, sheet: &Sheet) -> Image<Option<f64>> {
    sheet
        .depth
        .map(|depth| depth.map(|depth| scene.camera.view_from_device(depth)))
}

/// A smoothed surface against the truth: its offset (positive: too deep), its roughness without
/// the offset, and its normals.
pub(crate) fn measure(
    table: &mut Table,
    scene: &Scene,
    truth: &Truth,
    regions: &Regions,
    method: &Method,
    rig: &Rig,
) -> Result<(), ReportError> {
    let front = rig.seen()?.bulk.front;
    let camera = &scene.camera;
    let subject = Subject {
        scene,
        method: method.name,
        parameters: &method.parameters,
    };
    let wrong = |source| metric(subject, source);
    let nearest = Image::from_fn(camera.size, |pixel: UVec2| {
        let depth = camera.view_from_device((*front.depth.get(pixel))?);
        let point = camera.unproject(pixel.as_dvec2() + 0.5, depth);
        truth
            .judges(pixel)
            .then(|| truth.nearest(camera, pixel, point))?
    });
    let depth = nearest.map(|nearest| nearest.map(|nearest| -nearest.distance));
    let level = nearest.map(|nearest| nearest.map(|_| 0.0));
    let true_normals = nearest.map(|nearest| nearest.map(|nearest| nearest.normal));
    let no_normals = || Image::from_fn(camera.size, |_| None::<DVec3>);
    let normals = front.normals.unwrap_or_else(no_normals);
    for (region, mask) in named(regions) {
        let covered = mask.pixels().iter().zip(nearest.pixels());
        if covered
            .filter(|(mask, there)| **mask && there.is_some())
            .count()
            < FEWEST
        {
            continue;
        }
        let error = depth_error(&depth, &level, Some(&mask), scene.radius).map_err(wrong)?;
        table.add(subject, "surface_offset", region, error.offset, "r");
        table.add(subject, "surface_roughness", region, error.roughness, "r");
        table.add(subject, "surface_rmse", region, error.rmse, "r");
        let error = normal_error(&normals, &true_normals, Some(&mask)).map_err(wrong)?;
        table.add(subject, "normal_p50", region, error.p50, "deg");
        table.add(subject, "normal_p95", region, error.p95, "deg");
        table.add(subject, "normal_max", region, error.max, "deg");
    }
    Ok(())
}

/// A region of fewer pixels says nothing.
const FEWEST: usize = 20;

pub(crate) fn metric(of: Subject, source: fluid_reference::metrics::MetricError) -> ReportError {
    ReportError::Metric {
        scene: of.scene.name.into(),
        method: format!("{} {}", of.method, of.parameters),
        source,
    }
}
