//! Normals not written by smoothing: the bulk's from depth, the spray's from its ellipsoids.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, CachedRenderPipelineId, RenderPipelineDescriptor,
            SpecializedRenderPipeline,
        },
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    frame::{
        Frame, FrameLayout, FrameStartup, Gpu, Group, Input, Kept, Layers, NORMAL_FORMAT, Stage,
        add_stage, cleared,
        pipelines::{Tiles, fragment, one_texture_layout, tile_pipeline},
        splats::{Class, SplatLayouts, Splats, normals_pipeline},
        timed,
    },
    surface::{Surface, Variant, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_normals";

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum NormalSource {
    /// The smaller one-sided differences of a layer.
    Depth,
    /// The ellipsoids that made the layer.
    Ellipsoids,
}

#[derive(Resource)]
pub(super) struct NormalsPipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    layout: BindGroupLayoutDescriptor,
    depth_normals: Handle<Shader>,
}

/// Layers that normals are computed from.
#[derive(Component, Default)]
pub(super) struct NormalsGroups {
    bulk: Group,
    spray: Group,
}

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "depth_normals.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .add_systems(RenderStartup, init_pipeline.after(FrameStartup))
        .add_systems(
            Render,
            prepare_groups.in_set(RenderSystems::PrepareBindGroups),
        );
    add_stage::<NormalsPipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, NormalsGroups>();
}

fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
    splats: Res<SplatLayouts>,
) {
    commands.insert_resource(NormalsPipeline {
        frame: frame.clone(),
        splats: splats.clone(),
        layout: one_texture_layout("fluid_normals_layout"),
        depth_normals: load_embedded_asset!(assets.as_ref(), "depth_normals.wgsl"),
    });
}

impl SpecializedRenderPipeline for NormalsPipeline {
    type Key = NormalSource;

    fn specialize(&self, source: NormalSource) -> RenderPipelineDescriptor {
        match source {
            NormalSource::Ellipsoids => normals_pipeline(&self.frame, &self.splats),
            NormalSource::Depth => tile_pipeline(
                "fluid_depth_normals_pipeline",
                &self.frame,
                [self.layout.clone()],
                Tiles::Bulk,
                fragment(&self.depth_normals, vec![], &[NORMAL_FORMAT], None),
            ),
        }
    }
}

/// Of bulk and spray, where each is needed.
pub(super) struct NormalsPipelines {
    bulk: Option<CachedRenderPipelineId>,
    spray: Option<CachedRenderPipelineId>,
}

impl Stage for NormalsPipeline {
    type Pipelines = NormalsPipelines;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(NormalSource) -> CachedRenderPipelineId,
    ) -> NormalsPipelines {
        let plan = &variant.plan;
        let spray = plan.spray && !plan.index_one;
        NormalsPipelines {
            bulk: plan
                .normals_from_depth()
                .then(|| request(NormalSource::Depth)),
            spray: spray.then(|| request(NormalSource::Ellipsoids)),
        }
    }

    fn ids(pipelines: &NormalsPipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        pipelines.bulk.into_iter().chain(pipelines.spray)
    }
}

fn prepare_groups(
    mut surfaces: Query<(&Layers, &mut NormalsGroups)>,
    pipeline: Res<NormalsPipeline>,
    gpu: Gpu,
) {
    for (layers, mut groups) in &mut surfaces {
        let NormalsGroups { bulk, spray } = &mut *groups;
        for (group, layers) in [(bulk, &layers.bulk), (spray, &layers.spray)] {
            let inputs = [Input::texture(layers.as_ref())];
            group.prepare(&gpu, "fluid_normals", &pipeline.layout, &inputs);
        }
    }
}

/// The pass: normals of all surfaces.
pub(super) fn normals(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(
        &Surface,
        &Frame,
        &Layers,
        &NormalsGroups,
        &Kept<NormalsPipeline>,
    )>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, groups, pipelines) in surfaces {
            let Some(pipelines) = pipelines.drawn(surface) else {
                continue;
            };
            let bulk = pipelines
                .bulk
                .and_then(|id| splats.cache.get_render_pipeline(id));
            if let (Some(pipeline), Some(target), Some(group)) =
                (bulk, &layers.bulk_normals, groups.bulk.get())
            {
                let targets = [cleared(target, [0.0; 4])];
                let mut pass = frame.begin(ctx, SPAN, &targets, None, pipeline);
                pass.set_bind_group(1, group, &[]);
                frame.draw_tiles(&mut pass);
            }
            if let Some(pipeline) = pipelines.spray {
                let (target, of) = (&layers.spray_normals, (surface, frame));
                splats.normals(ctx, of, &groups.spray, target, pipeline, Class::Spray);
            }
        }
    });
}
