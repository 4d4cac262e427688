//! What another path tracer needs to check the tracer: scenes in figures, and its pictures of them.

use std::{f64::consts::PI, ffi::OsString, fs};

use bevy::math::{DMat3, DVec3, UVec2, dvec3, uvec2};
use fluid_reference::{
    Camera, Hit, Image, Lens, Span, Surface,
    ellipsoids::{Ellipsoid, Ellipsoids},
    layers,
    mesh::{Layer, LayerMeshes},
    metrics::{PIXELS_PER_DEGREE, encode_srgb, flip, mean},
    scene,
    surface::{Cuboid, Figure, Wave},
    tracer::{Object, Optics, Tracer, World},
    yu_turk::{AnisotropicKernel, ImplicitSurface, anisotropic},
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
/// The same where a ray takes a hundred times as long.
const FEW_RAYS: u32 = 4;
/// As many interfaces as the half-filled box needs.
const INTERFACES: u32 = 32;
/// Rows of the map of the sky.
const SKY_ROWS: u32 = 1024;
const SIZE: UVec2 = uvec2(160, 120);
/// Height of the view.
const DEGREES: f64 = 40.0;

/// Writes a folder of `NAME.json`, a scene's figures in m, and `NAME.f32`, its picture: rows from the
/// top, RGB, linear, little-endian. `NAME.model.f32` is the picture of the renderer's model, four
/// interfaces that reflect the sky alone, and its FLIP error is among the figures. `sky.f32` is the sky
/// by longitude (from −z over +x, twice as many as latitudes) and latitude (from +y).
///
/// # Errors
/// A command line that is not understood, or a file that cannot be written.
pub fn run(
    words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
) -> Result<(), ReportError> {
    let checks = checks();
    let names: Vec<_> = checks.iter().map(|check| &*check.name).collect();
    let options = &Options::parse_of(words, &names)?;
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
    for check in &checks {
        let name = &check.name;
        if !options.wants_scene(name) {
            continue;
        }
        let mut objects = AROUND.objects();
        if let Some([min, max]) = check.post {
            objects.push(Object::new(Cuboid::between(min, max), |_| linear(LIGHT)));
        }
        let world = World {
            surface: &*check.surface,
            objects: &objects,
            sky: &sky,
        };
        let truth = Tracer {
            interfaces: INTERFACES,
            ..Tracer::truth(world, Optics::WATER)
        };
        let model = Tracer::renderer(world, Optics::WATER);
        let [truth, model] =
            [truth, model].map(|tracer| tracer.render(&check.camera(), check.rays));
        write(options, &format!("{name}.f32"), &floats(&truth))?;
        write(options, &format!("{name}.model.f32"), &floats(&model))?;
        let flip = mean_flip(name, &truth, &model)?;
        let figures = format!("{:#}\n", figures(check, flip));
        write(options, &format!("{name}.json"), figures.as_bytes())?;
    }
    Ok(())
}

/// A scene that both tracers draw.
struct Check {
    name: String,
    surface: Box<dyn Surface>,
    /// The surface in figures.
    bodies: Vec<Value>,
    eye: DVec3,
    target: DVec3,
    /// Least and greatest corner of a light box, m; the water in which it stands ends at y = 0.
    post: Option<[DVec3; 2]>,
    /// The root of the number of rays through each pixel.
    rays: u32,
}

impl Check {
    fn camera(&self) -> Camera {
        let lens = Lens::Perspective {
            fov: DEGREES.to_radians(),
            near: 0.1,
        };
        Camera::new(SIZE, lens).looking_at(self.eye, self.target)
    }
}

impl From<scene::Scene> for Check {
    fn from(of: scene::Scene) -> Self {
        Self {
            name: of.name.replace(' ', "-"),
            bodies: of.surface.figures().iter().map(body).collect(),
            surface: of.surface,
            eye: of.eye,
            target: of.target,
            post: None,
            rays: RAYS,
        }
    }
}

fn checks() -> Vec<Check> {
    vec![
        scene::sphere(RADIUS).into(),
        scene::slab(RADIUS, 30.0).into(),
        scene::half_filled_box(RADIUS).into(),
        scene::pool_and_droplets(RADIUS).into(),
        scene::thin_sheet(RADIUS).into(),
        scene::two_spheres(RADIUS).into(),
        post_in_water(),
        ellipsoids(),
        implicit_surface(),
        layer_meshes(),
    ]
}

/// Water that touches a solid, which stands in it and out of it.
fn post_in_water() -> Check {
    Check {
        name: "post-in-water".into(),
        post: Some([dvec3(-0.15, -0.4, -0.15), dvec3(0.15, 0.3, 0.15)]),
        ..scene::half_filled_box(RADIUS).into()
    }
}

/// Ellipsoids about one point: all of their union is seen from there.
fn ellipsoids() -> Check {
    let turned = |axis: DVec3, half: DVec3, center: DVec3| Ellipsoid {
        center,
        matrix: DMat3::from_axis_angle(axis.normalize(), 1.0) * DMat3::from_diagonal(half),
    };
    let all = [
        turned(DVec3::X, dvec3(0.7, 0.3, 0.5), dvec3(0.2, 0.0, 0.0)),
        turned(DVec3::Y, dvec3(0.3, 0.6, 0.4), dvec3(0.0, 0.2, 0.1)),
        turned(DVec3::ONE, dvec3(0.4, 0.3, 0.8), dvec3(-0.1, -0.1, 0.2)),
    ];
    Check {
        name: "ellipsoids".into(),
        bodies: vec![json!({ "ellipsoids": items(&all) })],
        surface: Box::new(Ellipsoids::new(all)),
        eye: dvec3(0.0, 0.6, 3.0),
        target: DVec3::ZERO,
        post: None,
        rays: RAYS,
    }
}

/// A ball of some hundred particles as kernels make it.
fn implicit_surface() -> Check {
    let mut particles = scene::sphere(RADIUS).particles;
    let middle = particles.iter().sum::<DVec3>() / particles.len() as f64;
    particles.retain(|p| p.distance(middle) < 6.0 * RADIUS);
    // Were its outermost particles moved and flattened, a ball so small would be hollow below them.
    let kernel = AnisotropicKernel {
        center_shift: 0.0,
        surface_offset: 0.0,
        max_ratio: 1.5,
        ..AnisotropicKernel::default()
    };
    let all = anisotropic(&particles, RADIUS, &kernel);
    Check {
        name: "implicit-surface".into(),
        bodies: vec![json!({ "implicit": {
            "items": items(&all),
            "radius": RADIUS,
            "support": ImplicitSurface::SUPPORT,
            "iso": ImplicitSurface::ISO,
            "middle": middle.to_array(),
        } })],
        surface: Box::new(ImplicitSurface::new(all, RADIUS)),
        eye: middle + dvec3(0.0, 0.2, 1.0),
        target: middle,
        post: None,
        rays: FEW_RAYS,
    }
}

/// Front and back of a ball as a camera sees them, as triangles between its pixels.
fn layer_meshes() -> Check {
    let ball = Check::from(scene::sphere(RADIUS));
    let camera = ball.camera();
    let spans = layers(&camera, &*ball.surface);
    let step = 2.0 * RADIUS;
    let sheet = |pick: fn(&Span) -> Hit| -> Vec<_> {
        let hits = spans.pixels().iter().map(|span| span.as_ref().map(pick));
        hits.map(|hit| hit.map(|hit| (hit.view_depth, hit.normal.to_array())))
            .collect()
    };
    Check {
        name: "layer-meshes".into(),
        bodies: vec![json!({ "layer": {
            "front": sheet(|span| span.front),
            "back": sheet(|span| span.back),
            "step": step,
        } })],
        surface: Box::new(LayerMeshes::new(
            &camera,
            &[Layer::from_spans(&spans)],
            step,
        )),
        ..ball
    }
}

/// Centres and matrices, row by row.
fn items(of: &[Ellipsoid]) -> Vec<Value> {
    let item = |of: &Ellipsoid| {
        let rows = of.matrix.transpose().to_cols_array_2d();
        json!({ "center": of.center.to_array(), "matrix": rows })
    };
    of.iter().map(item).collect()
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

fn figures(scene: &Check, flip_of_model: f64) -> Value {
    let colors = [LIGHT, DARK].map(|color| linear(color).to_array());
    json!({
        "size": SIZE.to_array(),
        "eye": scene.eye.to_array(),
        "target": scene.target.to_array(),
        "vertical_degrees": DEGREES,
        "refractive_index": Optics::WATER.refractive_index,
        "interfaces": INTERFACES,
        "rays": scene.rays * scene.rays,
        "flip_of_model": flip_of_model,
        "pixels_per_degree": PIXELS_PER_DEGREE,
        "bodies": scene.bodies,
        "floor": AROUND.floor,
        "wall": AROUND.wall,
        "post": scene.post.map(|corners| corners.map(|corner| corner.to_array())),
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
