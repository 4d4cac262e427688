//! What another path tracer needs to check the tracer: scenes in figures, and its pictures of them.

use std::{f64::consts::PI, fs};

use bevy::math::{DVec3, UVec2, dvec3, uvec2};
use fluid_reference::{
    Image,
    metrics::{PIXELS_PER_DEGREE, encode_srgb, flip, mean},
    scene::{self, Scene},
    surface::{Figure, Wave},
    tracer::{Optics, Tracer, World},
};
use serde_json::{Value, json};

use crate::{
    Options, ReportError,
    surroundings::{DARK, LIGHT, REACH, SQUARE, Surroundings, linear, sky},
};

/// Particle radius of the scenes, m.
const RADIUS: f64 = 0.025;
const AROUND: Surroundings = Surroundings {
    floor: -1.25,
    wall: -3.0,
};
/// The root of the number of rays through each pixel.
const RAYS: u32 = 16;
/// As many interfaces as the half-filled box needs.
const INTERFACES: u32 = 32;
/// Rows of the map of the sky.
const SKY_ROWS: u32 = 1024;
const SIZE: UVec2 = uvec2(160, 120);

/// Writes a folder of `NAME.json`, a scene's figures in m, and `NAME.f32`, its picture: rows from the
/// top, RGB, linear, little-endian. `NAME.model.f32` is the picture of the renderer's model, four
/// interfaces that reflect the sky alone, and its FLIP error is among the figures. `sky.f32` is the sky
/// by longitude (from −z over +x, twice as many as latitudes) and latitude (from +y).
///
/// # Errors
/// A file that cannot be written.
pub fn export(options: &Options) -> Result<(), ReportError> {
    let sky_map = Image::from_fn(uvec2(2 * SKY_ROWS, SKY_ROWS), |pixel| {
        let [phi, theta] =
            [pixel.x, pixel.y].map(|i| PI * (f64::from(i) + 0.5) / f64::from(SKY_ROWS));
        sky(dvec3(
            phi.sin() * theta.sin(),
            theta.cos(),
            -phi.cos() * theta.sin(),
        ))
    });
    write(options, "sky.f32", &floats(&sky_map))?;
    let scenes = [
        scene::sphere(RADIUS),
        scene::slab(RADIUS, 30.0),
        scene::half_filled_box(RADIUS),
        scene::pool_and_droplets(RADIUS),
        scene::thin_sheet(RADIUS),
    ];
    for scene in scenes {
        let name = scene.name.replace(' ', "-");
        if !options.wants_scene(&name) {
            continue;
        }
        let camera = scene.camera(SIZE);
        let objects = AROUND.objects();
        let world = World {
            surface: &*scene.surface,
            objects: &objects,
            sky: &sky,
        };
        let truth = Tracer {
            interfaces: INTERFACES,
            ..Tracer::truth(world, Optics::WATER)
        };
        let model = Tracer::renderer(world, Optics::WATER);
        let [truth, model] = [truth, model].map(|tracer| tracer.render(&camera, RAYS));
        write(options, &format!("{name}.f32"), &floats(&truth))?;
        write(options, &format!("{name}.model.f32"), &floats(&model))?;
        let flip = mean_flip(scene.name, &truth, &model)?;
        let figures = format!("{:#}\n", figures(&scene, flip));
        write(options, &format!("{name}.json"), figures.as_bytes())?;
    }
    Ok(())
}

/// How far one linear picture is from another, perceptually.
fn mean_flip(scene: &str, truth: &Image<DVec3>, other: &Image<DVec3>) -> Result<f64, ReportError> {
    let [truth, other] = [truth, other].map(|picture| picture.map(|color| encode_srgb(*color)));
    let map = flip(&truth, &other, PIXELS_PER_DEGREE);
    map.and_then(|map| mean("FLIP", &map, None))
        .map_err(|source| ReportError::Metric {
            scene: scene.into(),
            method: "the renderer's model".into(),
            source,
        })
}

fn figures(scene: &Scene, flip_of_model: f64) -> Value {
    let colors = [LIGHT, DARK].map(|color| linear(color).to_array());
    let bodies: Vec<_> = scene.surface.figures().iter().map(body).collect();
    json!({
        "size": SIZE.to_array(),
        "eye": scene.eye.to_array(),
        "target": scene.target.to_array(),
        "vertical_degrees": 40.0,
        "refractive_index": Optics::WATER.refractive_index,
        "interfaces": INTERFACES,
        "flip_of_model": flip_of_model,
        "pixels_per_degree": PIXELS_PER_DEGREE,
        "bodies": bodies,
        "floor": AROUND.floor,
        "wall": AROUND.wall,
        "reach": REACH,
        "square": SQUARE,
        "colors": colors,
    })
}

fn body(figure: &Figure) -> Value {
    match figure {
        Figure::Sphere(ball) => json!({ "sphere": {
            "center": ball.center.to_array(),
            "radius": ball.radius,
        } }),
        Figure::Cuboid(cuboid) => {
            let (axis, angle) = cuboid.turn.to_axis_angle();
            json!({ "cuboid": {
                "center": cuboid.center.to_array(),
                "half": cuboid.half.to_array(),
                "axis": axis.to_array(),
                "degrees": angle.to_degrees(),
            } })
        }
        Figure::Pool(pool) => {
            let wave = |wave: &Wave| {
                json!({
                    "amplitude": wave.amplitude,
                    "wave_vector": wave.wave_vector.to_array(),
                    "phase": wave.phase,
                })
            };
            let waves: Vec<_> = pool.waves.iter().map(wave).collect();
            json!({ "pool": {
                "min": pool.min.to_array(),
                "max": pool.max.to_array(),
                "waves": waves,
            } })
        }
    }
}

fn floats(image: &Image<DVec3>) -> Vec<u8> {
    let values = image.pixels().iter().flat_map(DVec3::to_array);
    values
        .flat_map(|value| (value as f32).to_le_bytes())
        .collect()
}

fn write(options: &Options, name: &str, bytes: &[u8]) -> Result<(), ReportError> {
    let path = options.out.join(name);
    fs::write(&path, bytes).map_err(|source| ReportError::Write { path, source })
}
