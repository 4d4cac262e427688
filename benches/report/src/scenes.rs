//! What is measured on: bodies whose surface is known, the two scenes of the thesis, and what has
//! many edges.

mod ragged;

use std::{fs, path::PathBuf};

use bevy::math::{DVec3, UVec2, Vec3, dvec2, dvec3, uvec2};
use fluid_reference::{Camera, Lens, Surface, scene};

use crate::{Options, ReportError, surroundings::Surroundings};

/// A scene, ready to be drawn and to be judged.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) positions: Vec<Vec3>,
    /// Particle radius, m.
    pub(crate) radius: f64,
    pub(crate) camera: Camera,
    pub(crate) around: Surroundings,
    /// The exact surface of all of it; `None` where only particles are known.
    pub(crate) exact: Option<Box<dyn Surface>>,
    /// The exact surface of the bulk alone, where droplets are another body.
    pub(crate) exact_bulk: Option<Box<dyn Surface>>,
    pub(crate) measures: Measures,
}

/// What a scene is good for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Measures {
    /// The surface alone.
    Surface,
    /// All.
    All,
    /// The presets' times alone.
    Times,
    /// The times of the thesis's ways to smooth, window by window.
    Windows,
    /// The way through a body that does not bend light.
    Thickness,
    /// Antialiasing alone.
    Edges,
}

/// A scene by name, not yet made.
struct Entry {
    name: &'static str,
    quick: bool,
    make: fn(&Options, &'static str) -> Result<Scene, ReportError>,
}

const fn entry(
    name: &'static str,
    quick: bool,
    make: fn(&Options, &'static str) -> Result<Scene, ReportError>,
) -> Entry {
    Entry { name, quick, make }
}

/// Particle radius of bodies that fill the picture, m.
const RADIUS: f64 = 0.025;

const ENTRIES: [Entry; 51] = [
    entry("slab", false, |o, n| {
        Ok(body(o, n, scene::slab(RADIUS, 30.0)))
    }),
    entry("tilted-plane", false, |o, n| {
        Ok(body(o, n, scene::tilted_plane(RADIUS, 60.0)))
    }),
    entry("sphere", true, |o, n| Ok(body(o, n, scene::sphere(RADIUS)))),
    entry("rippled-pool", false, |o, n| {
        Ok(body(o, n, scene::rippled_pool(RADIUS)))
    }),
    entry("half-filled-box", false, |o, n| {
        Ok(body(o, n, scene::half_filled_box(RADIUS)))
    }),
    entry("two-spheres", false, |o, n| {
        Ok(body(o, n, scene::two_spheres(RADIUS)))
    }),
    entry("pool-and-droplets", true, |o, n| {
        Ok(body(o, n, scene::pool_and_droplets(RADIUS)))
    }),
    entry("two-puffs", true, |o, n| {
        Ok(Scene {
            measures: Measures::Thickness,
            ..body(o, n, scene::two_spheres(RADIUS))
        })
    }),
    entry("thin-sheet", false, |o, n| {
        Ok(body(o, n, scene::thin_sheet(RADIUS)))
    }),
    entry("depth-step", true, |o, n| {
        Ok(body(o, n, scene::depth_step(RADIUS)))
    }),
    entry("plane-0-at-3px", false, |o, n| Ok(plane(o, n, 0.0, 3.0))),
    entry("plane-0-at-6px", true, |o, n| Ok(plane(o, n, 0.0, 6.0))),
    entry("plane-0-at-12px", false, |o, n| Ok(plane(o, n, 0.0, 12.0))),
    entry("plane-0-at-30px", false, |o, n| Ok(plane(o, n, 0.0, 30.0))),
    entry("plane-60-at-3px", false, |o, n| Ok(plane(o, n, 60.0, 3.0))),
    entry("plane-60-at-6px", false, |o, n| Ok(plane(o, n, 60.0, 6.0))),
    entry("plane-60-at-12px", false, |o, n| {
        Ok(plane(o, n, 60.0, 12.0))
    }),
    entry("plane-60-at-30px", false, |o, n| {
        Ok(plane(o, n, 60.0, 30.0))
    }),
    entry("plane-80-at-3px", false, |o, n| Ok(plane(o, n, 80.0, 3.0))),
    entry("plane-80-at-6px", true, |o, n| Ok(plane(o, n, 80.0, 6.0))),
    entry("plane-80-at-12px", false, |o, n| {
        Ok(plane(o, n, 80.0, 12.0))
    }),
    entry("plane-80-at-30px", false, |o, n| {
        Ok(plane(o, n, 80.0, 30.0))
    }),
    entry("sphere-at-3px", false, |o, n| Ok(ball(o, n, 3.0))),
    entry("sphere-at-6px", true, |o, n| Ok(ball(o, n, 6.0))),
    entry("sphere-at-12px", false, |o, n| Ok(ball(o, n, 12.0))),
    entry("sphere-at-30px", false, |o, n| Ok(ball(o, n, 30.0))),
    entry("wave", false, |o, n| {
        simulated(o, n, dvec3(1.6, 2.6, 6.2), dvec3(0.3, 0.8, 0.0))
    }),
    entry("step", false, |o, n| {
        simulated(o, n, dvec3(1.4, 2.2, 5.2), dvec3(0.2, 0.7, 0.0))
    }),
    entry(WINDOWS, false, |o, n| {
        let wave = simulated(o, n, dvec3(1.6, 2.6, 6.2), dvec3(0.3, 0.8, 0.0))?;
        Ok(Scene {
            measures: Measures::Windows,
            ..wave
        })
    }),
    entry("wave-1024x768", false, |o, n| {
        larger(o, n, dvec3(1.6, 2.6, 6.2), dvec3(0.3, 0.8, 0.0))
    }),
    entry("step-1024x768", false, |o, n| {
        larger(o, n, dvec3(1.4, 2.2, 5.2), dvec3(0.2, 0.7, 0.0))
    }),
    entry("pool", false, |o, n| Ok(ragged::pool(o, n))),
    entry("cloud", false, |o, n| Ok(ragged::cloud(o, n))),
    entry("sprayed-wall", false, |o, n| Ok(ragged::sprayed_wall(o, n))),
    entry("knot", false, |o, n| Ok(ragged::knot(o, n))),
    entry("cube-top", false, |o, n| Ok(ragged::cube_top(o, n))),
    entry("wave-at-0.5px", false, |o, n| wave_at(o, n, 0.5)),
    entry("wave-at-0.9px", false, |o, n| wave_at(o, n, 0.9)),
    entry("wave-at-1px", false, |o, n| wave_at(o, n, 1.0)),
    entry("wave-at-1.8px", false, |o, n| wave_at(o, n, 1.8)),
    entry("wave-at-2px", false, |o, n| wave_at(o, n, 2.0)),
    entry("wave-at-3.7px", false, |o, n| wave_at(o, n, 3.7)),
    entry("wave-at-4px", false, |o, n| wave_at(o, n, 4.0)),
    entry("pool-at-0.5px", false, |o, n| Ok(pool_at(o, n, 0.5))),
    entry("pool-at-1px", false, |o, n| Ok(pool_at(o, n, 1.0))),
    entry("pool-at-2px", false, |o, n| Ok(pool_at(o, n, 2.0))),
    entry("pool-at-4px", false, |o, n| Ok(pool_at(o, n, 4.0))),
    entry("cloud-at-0.5px", false, |o, n| Ok(cloud_at(o, n, 0.5))),
    entry("cloud-at-1px", false, |o, n| Ok(cloud_at(o, n, 1.0))),
    entry("cloud-at-2px", false, |o, n| Ok(cloud_at(o, n, 2.0))),
    entry("cloud-at-4px", false, |o, n| Ok(cloud_at(o, n, 4.0))),
];

/// What scenes are called.
pub(crate) fn names() -> Vec<&'static str> {
    ENTRIES.iter().map(|entry| entry.name).collect()
}

/// The scenes that are asked for, by name: a few without particles from files where it is to be
/// quick.
pub(crate) fn asked(options: &Options) -> Vec<&'static str> {
    let wanted = |entry: &&Entry| {
        options.wants_scene(entry.name)
            && (entry.quick || !options.quick || !options.scene.is_empty())
    };
    ENTRIES
        .iter()
        .filter(wanted)
        .map(|entry| entry.name)
        .collect()
}

/// Those that show what antialiasing does, where none is asked for.
pub(crate) const WITH_EDGES: [&str; 10] = [
    "wave",
    "step",
    "wave-at-0.9px",
    "wave-at-1.8px",
    "wave-at-3.7px",
    "pool",
    "cloud",
    "sprayed-wall",
    "knot",
    "cube-top",
];

/// Makes a scene; `None` if there is none of this name.
pub(crate) fn make(options: &Options, name: &str) -> Option<Result<Scene, ReportError>> {
    let entry = ENTRIES.iter().find(|entry| entry.name == name)?;
    Some((entry.make)(options, entry.name))
}

/// A body of the catalogue, in its own view.
fn body(options: &Options, name: &'static str, of: scene::Scene) -> Scene {
    let size = if options.quick {
        uvec2(128, 96)
    } else {
        uvec2(320, 240)
    };
    Scene {
        name,
        positions: of.positions(),
        radius: of.radius,
        camera: of.camera(size),
        around: Surroundings {
            floor: -1.25,
            wall: -3.0,
        },
        exact_bulk: (name == "pool-and-droplets").then(|| scene::rippled_pool(of.radius).surface),
        exact: Some(of.surface),
        measures: Measures::All,
    }
}

/// A plane tilted by some degrees, from afar, so many pixels for a particle's radius. Its borders
/// are out of view: they are no plane.
fn plane(options: &Options, name: &'static str, degrees: f64, pixels: f64) -> Scene {
    let side = if options.quick { 128 } else { 240 };
    let seen = 0.5 * f64::from(side) * RADIUS / pixels;
    // What is nearer to the eye than the middle needs less, what is farther more.
    let along = seen / degrees.to_radians().cos();
    let half = dvec2(1.0 + along / FAR, 1.0) * dvec2(seen, 1.6 * along) + 4.0 * RADIUS;
    let plate = scene::tilted_plate(RADIUS, degrees, half);
    Scene {
        // Behind all of it: what opaque things hide is not drawn.
        around: Surroundings {
            floor: -4.0,
            wall: -6.0 - half.y,
        },
        ..close_up(name, plate, side, pixels)
    }
}

/// A ball of ten particle radii, whole.
fn ball(_: &Options, name: &'static str, pixels: f64) -> Scene {
    close_up(
        name,
        scene::sphere(2.0 * RADIUS),
        (22.0 * pixels) as u32,
        pixels,
    )
}

/// How far off close-ups are taken, m: perspective hardly matters.
const FAR: f64 = 12.0;

fn close_up(name: &'static str, of: scene::Scene, side: u32, pixels: f64) -> Scene {
    let height = f64::from(side) * of.radius / pixels;
    let lens = Lens::Perspective {
        fov: 2.0 * (0.5 * height / FAR).atan(),
        near: 0.1,
    };
    Scene {
        name,
        positions: of.positions(),
        radius: of.radius,
        camera: Camera::new(UVec2::splat(side), lens).looking_at(DVec3::Z * FAR, DVec3::ZERO),
        around: Surroundings {
            floor: -4.0,
            wall: -6.0,
        },
        exact: Some(of.surface),
        exact_bulk: None,
        measures: Measures::Surface,
    }
}

/// The wave again, for tables 5.3 and 5.4.
pub(crate) const WINDOWS: &str = "wave-windows";

/// A simulated scene in the thesis's second size.
fn larger(
    options: &Options,
    name: &'static str,
    eye: DVec3,
    target: DVec3,
) -> Result<Scene, ReportError> {
    let mut scene = simulated(options, name, eye, target)?;
    scene.camera.size = uvec2(1024, 768);
    scene.measures = Measures::Times;
    Ok(scene)
}

/// The dam break from afar, so many pixels for a particle's radius.
fn wave_at(options: &Options, name: &'static str, pixels: f64) -> Result<Scene, ReportError> {
    let near = simulated(options, name, dvec3(1.6, 2.6, 6.2), dvec3(0.3, 0.8, 0.0))?;
    Ok(ragged::from_afar(near, pixels))
}

fn pool_at(options: &Options, name: &'static str, pixels: f64) -> Scene {
    ragged::from_afar(ragged::pool(options, name), pixels)
}

fn cloud_at(options: &Options, name: &'static str, pixels: f64) -> Scene {
    ragged::from_afar(ragged::cloud(options, name), pixels)
}

/// The size of pictures of scenes that look well in any.
fn size(options: &Options) -> UVec2 {
    options.size.unwrap_or(if options.quick {
        uvec2(160, 120)
    } else {
        uvec2(640, 480)
    })
}

/// A frame that the example `bake` has kept, by the first word of the scene's name.
fn simulated(
    options: &Options,
    name: &'static str,
    eye: DVec3,
    target: DVec3,
) -> Result<Scene, ReportError> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets"))
        .join(format!("{}.xyz", name.split('-').next().unwrap_or(name)));
    let unreadable = |reason: String| ReportError::Particles {
        path: path.clone(),
        reason,
    };
    let bytes = fs::read(&path).map_err(|error| unreadable(error.to_string()))?;
    let triples: &[[f32; 3]] =
        bytemuck::try_cast_slice(&bytes).map_err(|error| unreadable(error.to_string()))?;
    let lens = Lens::Perspective {
        fov: 35_f64.to_radians(),
        near: 0.1,
    };
    Ok(Scene {
        name,
        positions: triples.iter().map(|&p| Vec3::from(p)).collect(),
        radius: RADIUS,
        camera: Camera::new(size(options), lens).looking_at(eye, target),
        around: Surroundings {
            floor: -0.4,
            wall: -2.5,
        },
        exact: None,
        exact_bulk: None,
        measures: Measures::All,
    })
}
