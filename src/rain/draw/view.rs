//! A view's rain: its voxels, its uniform, its copy of the scene's depth.

use core::ops::Range;

use bevy::{
    prelude::*,
    render::{
        render_resource::{BindGroup, BufferUsages, CachedRenderPipelineId, RawBufferVec},
        texture::CachedTexture,
    },
};

use super::{
    extract::{ExtractedRain, Shelters},
    gpu_types::{
        GpuQuad, GpuRain, GpuRainClass, GpuRainLevel, GpuShelter, LEVEL_COUNT, MAX_SHELTERS,
        SPEED_VECTORS,
    },
    lattice::{Eye, LEVELS, fall_axis},
};
use crate::rain::{
    classes::{Class, density_weights},
    drops::{LARGEST, SMALLEST, count, extinction, slope},
};

/// The most stretches of distance that transparent things sort between.
pub(crate) const MAX_SHELLS: usize = 16;

/// What a view draws of rain, in the render world.
#[derive(Component)]
pub struct RainQuads {
    pub(crate) instances: RawBufferVec<GpuQuad>,
    pub(crate) shells: Vec<Shell>,
    /// Indices to draw for every voxel of drops one by one; 0 for billboards.
    pub(crate) drop_indices: u32,
    pub(crate) depth: Option<CachedTexture>,
    pub(crate) bind_group: Option<BindGroup>,
    pub(crate) uniform_offset: u32,
    pub(crate) view_offset: u32,
    pub(crate) pipelines: Option<[CachedRenderPipelineId; 2]>,
}

/// Voxels at about the same distance from the eye.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shell {
    pub(crate) instances: Range<u32>,
    /// m.
    pub(crate) distance: f32,
}

impl RainQuads {
    /// How many voxels the view draws.
    pub fn len(&self) -> usize {
        self.instances.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.instances.is_empty()
    }

    /// Cuts the sorted voxels into shells: one for all where nothing needs to sort between them.
    pub(crate) fn cut_shells(&mut self, distance: f32, alone: bool) {
        self.shells.clear();
        let quads = self.instances.values();
        let width = (distance / (MAX_SHELLS - 1) as f32).max(0.5);
        let index = |quad: &GpuQuad| {
            if alone {
                0
            } else {
                (quad.radius / width) as u32
            }
        };
        let mut start = 0;
        for run in quads.chunk_by(|a, b| index(a) == index(b)) {
            let end = start + run.len() as u32;
            self.shells.push(Shell {
                instances: start..end,
                distance: run[run.len() / 2].radius,
            });
            start = end;
        }
        // More than the last one can hold are one.
        if self.shells.len() > MAX_SHELLS {
            self.shells.truncate(MAX_SHELLS);
            if let Some(last) = self.shells.last_mut() {
                last.instances.end = start;
            }
        }
    }
}

impl Default for RainQuads {
    fn default() -> Self {
        let mut instances = RawBufferVec::new(BufferUsages::VERTEX);
        instances.set_label(Some("rain_quads"));
        Self {
            instances,
            shells: Vec::new(),
            drop_indices: 0,
            depth: None,
            bind_group: None,
            uniform_offset: 0,
            view_offset: 0,
            pipelines: None,
        }
    }
}

/// Wraps what grows for ever, so that 32-bit floats can follow it. Unit: s.
const DROP_PERIOD: f64 = 256.0;

impl GpuRain {
    /// Without lights and shelters.
    pub(crate) fn new(extracted: &ExtractedRain, eye: &Eye) -> Self {
        let ExtractedRain {
            rain,
            clock,
            input,
            classes,
            ..
        } = extracted;
        let rate = f64::from(rain.rate);
        let axis = fall_axis(clock.lean);
        let mut gpu = Self {
            axis,
            distance: rain.distance,
            forward: eye.forward,
            perspective: u32::from(eye.perspective),
            ambient: extracted.ambient,
            extinction: extinction(rate) as f32,
            extent: rain.extent,
            brightness: rain.brightness,
            drop_count: count(rate, SMALLEST, LARGEST).round() as u32,
            exposure: input.exposure,
            seconds: (clock.seconds % DROP_PERIOD) as f32,
            wind: rain.wind,
            slope: slope(rate) as f32,
            smallest: SMALLEST as f32,
            largest: LARGEST as f32,
            speeds: core::array::from_fn(|i| {
                Vec4::from_array(core::array::from_fn(|k| {
                    input.law.speed(0.1 * (4 * i + k) as f64) as f32
                }))
            }),
            ..default()
        };
        let bounds = Class::all();
        for (index, class) in classes.iter().enumerate() {
            let fallen = clock.fallen[index];
            gpu.classes[index] = GpuRainClass {
                lean: rain.wind / class.speed as f32 - clock.lean,
                fallen_tiles: fallen.floor() as i64 as i32,
                fallen: (fallen - fallen.floor()) as f32,
            };
            for (level, voxel) in LEVELS.iter().enumerate() {
                let wanted = bounds[index].extinction(rate) * f64::from(voxel.size);
                gpu.weights[level][index] = density_weights(wanted, class.extinction) * class.scale;
            }
        }
        for (gpu, level) in gpu.levels.iter_mut().zip(LEVELS) {
            *gpu = GpuRainLevel {
                size: level.size,
                start: level.start,
                end: level.end,
                gain: level.gain(rain.distance),
            };
        }
        gpu
    }

    /// The nearest shelters.
    pub(crate) fn shelter(&mut self, shelters: &mut Shelters, eye: Vec3) {
        let away = |transform: &GlobalTransform| transform.translation().distance_squared(eye);
        shelters
            .0
            .sort_unstable_by(|a, b| away(&a.0).total_cmp(&away(&b.0)));
        for (slot, (transform, half_size)) in self.shelters.iter_mut().zip(&shelters.0) {
            let local_from_world = transform.affine().inverse();
            *slot = GpuShelter {
                local_from_relative: Mat4::from(local_from_world) * Mat4::from_translation(eye),
                half_size: *half_size,
            };
        }
        self.shelter_count = shelters.0.len().min(MAX_SHELTERS) as u32;
    }
}

const _: () = assert!(LEVEL_COUNT == LEVELS.len() && SPEED_VECTORS * 4 >= 61);
