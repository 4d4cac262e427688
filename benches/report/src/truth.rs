//! What is true of a scene, as far as a camera can see.

use bevy::math::{DVec3, UVec2};
use bevy_fluid::{
    prelude::{FluidMaterial, SurfaceKernel},
    shape::{FluidSplats, ShapeWorkspace, Splat},
};
use fluid_reference::{
    Camera, Crossing, Image, Nearest, Span, Surface,
    ellipsoids::{Ellipsoid, Ellipsoids},
    layers,
    surface::Union,
    tracer::Optics,
    yu_turk::ImplicitSurface,
};
use half::f16;

use crate::{ReportError, scenes::Scene};

/// The default's splats as they are drawn.
pub(crate) struct Splats {
    pub(crate) bulk: Vec<Ellipsoid>,
    pub(crate) interior: Vec<Ellipsoid>,
    pub(crate) spray: Vec<Ellipsoid>,
}

impl Splats {
    pub(crate) fn of(scene: &Scene) -> Result<Self, ReportError> {
        let mut splats = FluidSplats::default();
        ShapeWorkspace::default().shape(
            &scene.positions,
            scene.radius as f32,
            &SurfaceKernel::DEFAULT,
            &mut splats,
        )?;
        let [bulk, interior, spray] = splats.by_class().map(|class| {
            let ellipsoid =
                |s: &Splat| Ellipsoid::from_splat(s.center, s.scale, s.axes.map(f16::to_f32));
            class.iter().map(ellipsoid).collect()
        });
        Ok(Self {
            bulk,
            interior,
            spray,
        })
    }

    /// Front and back of the exact union of the bulk's ellipsoids, and of the spray's.
    pub(crate) fn layers(&self, camera: &Camera) -> [Image<Option<Span>>; 2] {
        [&self.bulk, &self.spray]
            .map(|class| layers(camera, &Ellipsoids::new(class.iter().copied())))
    }

    /// The smooth surface that the bulk's splats stand for, and the spray's spheres.
    fn implicit(&self, radius: f64) -> Union {
        let bulk = self.bulk.iter().chain(&self.interior).copied();
        Union(vec![
            Box::new(ImplicitSurface::new(bulk, radius)),
            Box::new(Ellipsoids::new(self.spray.iter().copied())),
        ])
    }
}

/// The strongest truth about a scene's surface.
pub(crate) enum Truth<'a> {
    /// Its form is known.
    Exact(&'a dyn Surface),
    /// The implicit surface of the particles' kernels, and where the rays of some pixels enter
    /// it: only some, because they are slow.
    Implicit {
        surface: Box<Union>,
        entries: Image<Vec<Crossing>>,
    },
}

/// One of so many pixels along each axis sees the implicit surface.
const STRIDE: u32 = 5;

impl<'a> Truth<'a> {
    pub(crate) fn of(scene: &'a Scene, splats: &Splats) -> Self {
        if let Some(exact) = &scene.exact {
            return Self::Exact(&**exact);
        }
        let surface = Box::new(splats.implicit(scene.radius));
        let entries = Image::from_fn(scene.camera.size, |pixel| {
            let mut crossings = Vec::new();
            if is_judged(pixel) {
                surface.crossings(&scene.camera.pixel_ray(pixel), &mut crossings);
            }
            crossings.retain(|crossing| crossing.entering);
            crossings
        });
        Self::Implicit { surface, entries }
    }

    pub(crate) fn surface(&self) -> &dyn Surface {
        match self {
            Self::Exact(surface) => *surface,
            Self::Implicit { surface, .. } => &**surface,
        }
    }

    /// Whether a pixel is judged.
    pub(crate) fn judges(&self, pixel: UVec2) -> bool {
        match self {
            Self::Exact(_) => true,
            Self::Implicit { .. } => is_judged(pixel),
        }
    }

    /// What the nearest part of the surface is to a point that a pixel's ray has found; of the
    /// implicit surface, the part nearest along the ray.
    pub(crate) fn nearest(&self, camera: &Camera, pixel: UVec2, point: DVec3) -> Option<Nearest> {
        match self {
            Self::Exact(surface) => surface.nearest(point),
            Self::Implicit { entries, .. } => {
                let ray = camera.pixel_ray(pixel);
                let beyond = |crossing: &Crossing| (point - ray.at(crossing.t)).dot(ray.direction);
                let entries = entries.get(pixel).iter();
                let nearest = entries.min_by(|a, b| beyond(a).abs().total_cmp(&beyond(b).abs()))?;
                Some(Nearest {
                    // Deeper along the ray is inside.
                    distance: -beyond(nearest),
                    normal: nearest.normal,
                })
            }
        }
    }
}

fn is_judged(pixel: UVec2) -> bool {
    pixel % STRIDE == UVec2::splat(STRIDE / 2)
}

/// The optics of the liquid that all scenes show.
pub(crate) fn water() -> Optics {
    let water = FluidMaterial::WATER;
    Optics {
        refractive_index: f64::from(water.refractive_index),
        extinction: water.medium.extinction().as_dvec3(),
    }
}
