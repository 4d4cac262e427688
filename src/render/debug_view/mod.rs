//! Debug views: intermediate results in place of the liquid.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CompareFunction, MultisampleState,
            PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor, ShaderStages,
            SpecializedRenderPipeline, StoreOp, TextureFormat, TextureSampleType,
            binding_types::{texture_2d, uniform_buffer},
        },
        renderer::{RenderContext, ViewQuery},
        view::{ViewDepthTexture, ViewTarget},
    },
};

use super::{
    frame::{
        Frame, FrameLayout, Group, Input, Inputs, Kept, Layers, Stage, add_stage,
        pipelines::{Tiles, defs, depth_state, fragment, tile_pipeline, unfiltered},
        timed,
    },
    surface::{Surface, Variant, ViewSurfaces},
};
use crate::settings::FluidDebugView;

/// Name of the pass's time span.
const SPAN: &str = "fluid_debug_view";

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct DebugKey {
    pub(super) debug_view: FluidDebugView,
    pub(super) format: TextureFormat,
    pub(super) samples: u32,
    /// Whether the thickness that is shown is accumulated.
    pub(super) accumulated: bool,
}

#[derive(Resource)]
pub(super) struct DebugPipeline {
    frame: FrameLayout,
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "debug_view.wgsl");
    add_stage::<DebugPipeline>(app);
}

impl FromWorld for DebugPipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_debug_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        texture_2d(TextureSampleType::Uint),
                        uniform_buffer::<Vec4>(true),
                        unfiltered(),
                    ),
                ),
            ),
            shader: load_embedded_asset!(world, "debug_view.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for DebugPipeline {
    type Key = DebugKey;

    fn specialize(&self, key: DebugKey) -> RenderPipelineDescriptor {
        let is = |view| key.debug_view == view;
        let shader_defs = defs([
            ("BULK_FRONT", is(FluidDebugView::BulkFront)),
            ("BULK_BACK", is(FluidDebugView::BulkBack)),
            ("SPRAY_FRONT", is(FluidDebugView::SprayFront)),
            ("SPRAY_BACK", is(FluidDebugView::SprayBack)),
            ("NORMALS", is(FluidDebugView::Normals)),
            ("INTERFACES", is(FluidDebugView::Interfaces)),
            ("STATUS", is(FluidDebugView::Status)),
            ("CLASSES", is(FluidDebugView::Classes)),
            ("THICKNESS", is(FluidDebugView::Thickness)),
            ("ACCUMULATED", key.accumulated),
            ("EXIT_RAY", is(FluidDebugView::ExitRay)),
            ("OVERDRAW", is(FluidDebugView::Overdraw)),
        ]);
        RenderPipelineDescriptor {
            depth_stencil: depth_state(false, CompareFunction::Always),
            multisample: MultisampleState {
                count: key.samples,
                ..default()
            },
            ..tile_pipeline(
                "fluid_debug_pipeline",
                &self.frame,
                [self.layout.clone()],
                Tiles::AllInCamera,
                fragment(&self.shader, shader_defs, &[key.format], None),
            )
        }
    }
}

impl Stage for DebugPipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = Vec4;
    type State = Group;

    fn keys(&self, variant: &Variant) -> Vec<DebugKey> {
        let key = variant.debug_view.map(|debug_view| DebugKey {
            debug_view,
            format: variant.format,
            samples: variant.samples,
            accumulated: variant.plan.accumulated && debug_view == FluidDebugView::Thickness,
        });
        key.into_iter().collect()
    }

    /// The range of depths that is shown.
    fn uniform(surface: &Surface) -> Option<Vec4> {
        Some(surface.depths.extend(0.0).extend(0.0))
    }

    fn prepare(&self, group: &mut Group, surface: &Surface, layers: &Layers, inputs: &Inputs) {
        if surface.wanted.debug_view.is_none() {
            *group = default();
            return;
        }
        let amounts = if layers.overdraw.is_some() {
            &layers.overdraw
        } else {
            &layers.thickness
        };
        let shown = [
            inputs.or_nothing(&layers.bulk),
            inputs.or_nothing(&layers.bulk_normals),
            inputs.or_nothing(&layers.spray),
            inputs.or_nothing(&layers.spray_normals),
            Input::texture(layers.exits.as_ref()),
            inputs.uniform.clone(),
            inputs.or_nothing(amounts),
        ];
        group.prepare(inputs.gpu, SPAN, &self.layout, &shown);
    }
}

/// The pass: all surfaces of a view that has a debug view.
pub(super) fn debug_view(
    view: ViewQuery<(&ViewTarget, &ViewDepthTexture, &ViewSurfaces)>,
    surfaces: Query<(&Surface, &Frame, &Kept<DebugPipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (target, depth, view) = view.into_inner();
    let is_shown = |surface: &Surface| surface.wanted.debug_view.is_some();
    let surfaces = surfaces.iter_many(&view.surfaces);
    let mut surfaces = surfaces
        .filter(|(surface, ..)| is_shown(surface))
        .peekable();
    if surfaces.peek().is_none() {
        return;
    }
    timed(&mut ctx, SPAN, |ctx| {
        for (surface, frame, kept) in surfaces {
            let (Some(pipeline), Some(group)) = (kept.only(surface, &cache), kept.state.get())
            else {
                continue;
            };
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some(SPAN),
                color_attachments: &[Some(target.get_color_attachment())],
                depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
                ..default()
            });
            frame.enter(&mut pass, pipeline);
            pass.set_bind_group(1, group, &[kept.offset.bytes()]);
            frame.draw_tiles(&mut pass);
        }
    });
}
