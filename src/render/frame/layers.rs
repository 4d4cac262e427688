//! The textures that a surface's stages hand on to each other.

use bevy::{
    prelude::*,
    render::render_resource::{Texture, TextureFormat, TextureUsages},
};

use super::{
    Gpu, Target,
    pipelines::TILE,
    support::{FluidSupport, LAYER_FORMAT},
    targets::{TARGET, ensure, ensure_for},
};
use crate::{
    render::surface::{MARGIN, Surface, Variant},
    settings::{Antialiasing, FluidDebugView},
};

/// Front and back normals, octahedral, both towards the viewer.
pub(crate) const NORMAL_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Radiance, and the transmitted fraction of red.
pub(crate) const RADIANCE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// The transmitted fractions of green and blue.
pub(crate) const TRANSMISSION_FORMAT: TextureFormat = TextureFormat::Rg16Float;
/// The exit ray and the flags of a path. Before rays are traced, the same texture holds layers and
/// their slopes along x between the two halves of a separable fit, as bits of f32.
pub(crate) const EXIT_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

/// How much of each quarter of a pixel is covered.
pub(crate) const COVERAGE_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;
/// Light from the liquid and through it.
pub(crate) const LIGHT_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// 1 where there is (bulk, any liquid).
pub(super) const TILE_FORMAT: TextureFormat = TextureFormat::Rg8Unorm;

/// The textures of a surface, which hold the part of the view that it may cover.
///
/// Layers hold (device depth of the front, −device depth of the back); (0, −2) means nothing. A
/// front of exactly 1 means that the ray starts inside the liquid.
// A second record of exit rays would be one more texture here.
#[derive(Component, Default)]
pub struct Layers {
    size: UVec2,
    origin: IVec2,
    pub(super) tiles: Option<Target>,
    pub(crate) bulk: Option<Target>,
    /// Smoothing writes to this and the bulk's layers in turn, and ends in the bulk's.
    pub(crate) scratch: Option<Target>,
    /// Whether the bulk is splatted to the scratch texture.
    splatted_to_scratch: bool,
    pub(crate) bulk_normals: Option<Target>,
    pub(crate) spray: Option<Target>,
    pub(crate) spray_normals: Option<Target>,
    pub(crate) radiance: Option<Target>,
    pub(crate) transmission: Option<Target>,
    pub(crate) exits: Option<Target>,
    /// How much of each pixel's quarters is covered: upper left, upper right, lower left, lower
    /// right.
    pub(crate) coverage: Option<Target>,
    /// Light from the liquid and through it, and alpha; negative where there is no liquid.
    pub(crate) light: Option<Target>,
    /// The accumulated path length through all particles.
    pub(crate) thickness: Option<Target>,
    /// The number of splats, if a debug view shows it.
    pub(crate) overdraw: Option<Target>,
}

impl Layers {
    /// The size of the textures. Unit: pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The pixel of the view, from its upper left, at the textures' upper left texel; it may lie
    /// outside of the view.
    pub fn origin(&self) -> IVec2 {
        self.origin
    }

    /// The bulk's layers after smoothing.
    pub fn bulk(&self) -> Option<&Texture> {
        self.bulk.as_ref().map(|it| &it.texture)
    }

    /// The bulk's normals: front in rg, back in ba.
    pub fn bulk_normals(&self) -> Option<&Texture> {
        self.bulk_normals.as_ref().map(|it| &it.texture)
    }

    /// The spray's layers.
    pub fn spray(&self) -> Option<&Texture> {
        self.spray.as_ref().map(|it| &it.texture)
    }

    /// The spray's normals: front in rg, back in ba.
    pub fn spray_normals(&self) -> Option<&Texture> {
        self.spray_normals.as_ref().map(|it| &it.texture)
    }

    /// The liquid's own radiance (reflected, in-scattered and emitted light), and in its alpha the
    /// transmitted fraction of the background's red light. Where more than one ray is traced for
    /// antialiasing, the composite replaces it by the mean light of those rays.
    pub fn radiance(&self) -> Option<&Texture> {
        self.radiance.as_ref().map(|it| &it.texture)
    }

    /// The transmitted fractions of the background's green and blue light.
    pub fn transmission(&self) -> Option<&Texture> {
        self.transmission.as_ref().map(|it| &it.texture)
    }

    /// Exit rays and flags, in the layout of `pack_exit` in `refract.wgsl`.
    pub fn exits(&self) -> Option<&Texture> {
        self.exits.as_ref().map(|it| &it.texture)
    }

    /// How much of the quarters of each pixel is covered (upper left, upper right, lower left, lower
    /// right), if edges are antialiased.
    pub fn coverage(&self) -> Option<&Texture> {
        self.coverage.as_ref().map(|it| &it.texture)
    }

    /// The accumulated path length through all particles in m, if it is summed up.
    pub fn thickness(&self) -> Option<&Texture> {
        self.thickness.as_ref().map(|it| &it.texture)
    }

    /// Number of splats drawn at each pixel, if a camera has [`FluidDebugView::Overdraw`].
    pub fn overdraw(&self) -> Option<&Texture> {
        self.overdraw.as_ref().map(|it| &it.texture)
    }

    pub(super) fn tiles(&self) -> Option<&Target> {
        self.tiles.as_ref()
    }

    /// Along both axes.
    pub(crate) fn tile_count(&self) -> UVec2 {
        (self.size + TILE - 1) / TILE
    }

    /// The bulk's layers as they are splatted.
    pub(crate) fn splatted(&self) -> &Option<Target> {
        if self.splatted_to_scratch {
            &self.scratch
        } else {
            &self.bulk
        }
    }

    /// Moves the textures over a rectangle of the view. They are made anew if they are too small,
    /// or more than twice as large as needed.
    fn place(&mut self, rect: URect, largest: u32) {
        self.origin = rect.min.as_ivec2() - MARGIN as i32;
        let needed = rect.size() + 2 * MARGIN;
        let rounded = ((needed + TILE - 1) / TILE * TILE).min(UVec2::splat(largest));
        let area = |size: UVec2| u64::from(size.x) * u64::from(size.y);
        if needed.cmpgt(self.size).any() || area(self.size) > 2 * area(rounded) {
            self.size = rounded;
        }
    }

    fn prepare(&mut self, gpu: &Gpu, support: &FluidSupport, variant: &Variant) {
        let plan = &variant.plan;
        let passes = plan.smoothing.layer_passes();
        self.splatted_to_scratch = passes % 2 == 1;
        let size = self.size;
        let normals = !plan.index_one;
        let sum = support.thickness_format;
        let counted = variant.debug_view == Some(FluidDebugView::Overdraw);
        let keep = |target: &mut Option<Target>, wanted, label, format| {
            ensure(target, wanted, gpu, label, size, format);
        };
        keep(&mut self.bulk, plan.bulk, "fluid_bulk_layers", LAYER_FORMAT);
        let label = "fluid_bulk_layers_scratch";
        keep(&mut self.scratch, passes > 0, label, LAYER_FORMAT);
        let (wanted, label) = (plan.bulk && normals, "fluid_bulk_normals");
        keep(&mut self.bulk_normals, wanted, label, NORMAL_FORMAT);
        keep(
            &mut self.spray,
            plan.spray,
            "fluid_spray_layers",
            LAYER_FORMAT,
        );
        let (wanted, label) = (plan.spray && normals, "fluid_spray_normals");
        keep(&mut self.spray_normals, wanted, label, NORMAL_FORMAT);
        let usage = match plan.antialiasing {
            Antialiasing::Full { rays } if rays > 0 => TARGET | TextureUsages::STORAGE_BINDING,
            _ => TARGET,
        };
        let texels = (RADIANCE_FORMAT, usage);
        ensure_for(
            &mut self.radiance,
            true,
            gpu,
            "fluid_radiance",
            size,
            texels,
        );
        let label = "fluid_transmission";
        keep(&mut self.transmission, true, label, TRANSMISSION_FORMAT);
        keep(&mut self.exits, true, "fluid_exits", EXIT_FORMAT);
        let (wanted, label) = (plan.antialiasing.covers(), "fluid_coverage");
        keep(&mut self.coverage, wanted, label, COVERAGE_FORMAT);
        keep(&mut self.light, true, "fluid_light", LIGHT_FORMAT);
        keep(
            &mut self.thickness,
            plan.accumulated,
            "fluid_thickness",
            sum,
        );
        keep(&mut self.overdraw, counted, "fluid_overdraw", sum);
        let tiles = self.tile_count();
        ensure(
            &mut self.tiles,
            true,
            gpu,
            "fluid_tiles",
            tiles,
            TILE_FORMAT,
        );
    }
}

pub(super) fn prepare_layers(
    mut surfaces: Query<(&Surface, &mut Layers)>,
    support: Res<FluidSupport>,
    gpu: Gpu,
) {
    for (surface, mut layers) in &mut surfaces {
        if let Some(variant) = &surface.drawn {
            layers.place(surface.rect, gpu.device.limits().max_texture_dimension_2d);
            layers.prepare(&gpu, &support, variant);
        }
    }
}
