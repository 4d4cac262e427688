//! Pipelines of motion vectors.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::{core_3d::CORE_3D_DEPTH_FORMAT, prepass::MOTION_VECTOR_PREPASS_FORMAT},
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, CompareFunction, MultisampleState,
        RenderPipelineDescriptor, ShaderStages, ShaderType, SpecializedRenderPipeline,
        TextureFormat, binding_types::uniform_buffer,
    },
};

use super::{SPAN, fluid::MotionLayout};
use crate::render::{
    frame::{
        FrameLayout, Group, Input, Inputs, Layers, Stage, Target, ensure,
        pipelines::{Tiles, defs, depth_state, fragment, tile_pipeline, unfiltered},
        splats::{SplatLayouts, splat_pipeline},
    },
    surface::{Surface, Variant},
};

/// Displacements are as large as a shift of the whole world, and as small as a part of a pixel.
const DISPLACEMENT_FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// The Rust twin of `GpuMotion` in `motion_vectors.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(crate) struct GpuMotion {
    clip_from_view: Mat4,
    clip_from_view_before: Mat4,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MotionKey {
    /// Displacements of the nearest splats; `cut`: whether some may be cut by the near plane.
    Splats { cut: bool },
    /// Motion vectors, in a view of so many samples.
    ToCamera { samples: u32 },
}

impl MotionKey {
    pub(super) fn is_to_camera(&self) -> bool {
        matches!(self, Self::ToCamera { .. })
    }
}

/// What a surface keeps.
#[derive(Default)]
pub(crate) struct MotionTextures {
    /// How far the nearest splat has moved, in view space. Unit: m.
    pub(super) displacement: Option<Target>,
    /// The nearest splat's depth.
    pub(super) nearest: Option<Target>,
    pub(super) group: Group,
}

#[derive(Resource)]
pub(crate) struct MotionPipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    of_fluid: BindGroupLayoutDescriptor,
    layout: BindGroupLayoutDescriptor,
    splat_motion: Handle<Shader>,
    motion_vectors: Handle<Shader>,
}

impl FromWorld for MotionPipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            splats: world.resource::<SplatLayouts>().clone(),
            of_fluid: world.resource::<MotionLayout>().0.clone(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_motion_vectors_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (
                        uniform_buffer::<GpuMotion>(true),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                    ),
                ),
            ),
            splat_motion: load_embedded_asset!(world, "splat_motion.wgsl"),
            motion_vectors: load_embedded_asset!(world, "motion_vectors.wgsl"),
        }
    }
}

impl MotionPipeline {
    fn on_splats(&self, cut: bool) -> RenderPipelineDescriptor {
        let shader_defs = defs([("MOTION", true), ("NONE_CUT", !cut)]);
        let formats = [DISPLACEMENT_FORMAT];
        let fragment = fragment(&self.splat_motion, shader_defs.clone(), &formats, None);
        RenderPipelineDescriptor {
            depth_stencil: depth_state(true, CompareFunction::Greater),
            ..splat_pipeline(
                "fluid_splat_motion_pipeline",
                &self.frame,
                &self.splats,
                [self.of_fluid.clone()],
                shader_defs,
                fragment,
            )
        }
    }

    fn to_camera(&self, samples: u32) -> RenderPipelineDescriptor {
        let formats = [MOTION_VECTOR_PREPASS_FORMAT];
        RenderPipelineDescriptor {
            // Where the composite has written this surface's depth, and nowhere else.
            depth_stencil: depth_state(false, CompareFunction::Equal),
            multisample: MultisampleState {
                count: samples,
                ..default()
            },
            ..tile_pipeline(
                "fluid_motion_vectors_pipeline",
                &self.frame,
                [self.layout.clone()],
                Tiles::LiquidInCamera,
                fragment(&self.motion_vectors, vec![], &formats, None),
            )
        }
    }
}

impl SpecializedRenderPipeline for MotionPipeline {
    type Key = MotionKey;

    fn specialize(&self, key: MotionKey) -> RenderPipelineDescriptor {
        match key {
            MotionKey::Splats { cut } => self.on_splats(cut),
            MotionKey::ToCamera { samples } => self.to_camera(samples),
        }
    }
}

fn is_wanted(variant: &Variant) -> bool {
    variant.plan.motion_vectors && variant.debug_view.is_none()
}

impl Stage for MotionPipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = GpuMotion;
    type State = MotionTextures;

    fn keys(&self, variant: &Variant) -> Vec<MotionKey> {
        if !is_wanted(variant) {
            return Vec::new();
        }
        let samples = variant.samples;
        let cut = variant.plan.cut;
        vec![MotionKey::Splats { cut }, MotionKey::ToCamera { samples }]
    }

    /// The near plane may cut splats at any time.
    fn ahead(key: &MotionKey) -> Option<MotionKey> {
        match key {
            MotionKey::Splats { cut } => Some(MotionKey::Splats { cut: !cut }),
            MotionKey::ToCamera { .. } => None,
        }
    }

    fn uniform(surface: &Surface) -> Option<GpuMotion> {
        let [clip_from_view, clip_from_view_before] = surface.clip_from_view?;
        Some(GpuMotion {
            clip_from_view,
            clip_from_view_before,
        })
    }

    fn prepare(
        &self,
        of: &mut MotionTextures,
        surface: &Surface,
        layers: &Layers,
        inputs: &Inputs,
    ) {
        let drawn = surface.drawn.as_ref();
        let wanted = drawn.is_some_and(is_wanted);
        let (gpu, size) = (inputs.gpu, layers.size());
        let label = "fluid_displacement";
        ensure(
            &mut of.displacement,
            wanted,
            gpu,
            label,
            size,
            DISPLACEMENT_FORMAT,
        );
        let label = "fluid_nearest_splat";
        ensure(
            &mut of.nearest,
            wanted,
            gpu,
            label,
            size,
            CORE_3D_DEPTH_FORMAT,
        );
        if wanted {
            let group = [
                inputs.uniform.clone(),
                Input::texture(of.displacement.as_ref()),
                inputs.or_nothing(&layers.bulk),
                inputs.or_nothing(&layers.spray),
            ];
            of.group.prepare(gpu, SPAN, &self.layout, &group);
        } else {
            of.group = default();
        }
    }
}
