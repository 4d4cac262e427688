//! Normals not written by smoothing: the bulk's from depth, the spray's from its ellipsoids.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, RenderPipelineDescriptor, SpecializedRenderPipeline,
        },
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    frame::{
        Frame, FrameLayout, Group, Input, Inputs, Kept, Layers, NORMAL_FORMAT, NoUniform, Stage,
        add_stage, cleared,
        pipelines::{Tiles, fragment, one_texture_layout, tile_pipeline},
        splats::{Class, SplatLayouts, SplatPass, Splats, normals_pipeline},
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

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "depth_normals.wgsl");
    add_stage::<NormalsPipeline>(app);
}

impl FromWorld for NormalsPipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            splats: world.resource::<SplatLayouts>().clone(),
            layout: one_texture_layout("fluid_normals_layout"),
            depth_normals: load_embedded_asset!(world, "depth_normals.wgsl"),
        }
    }
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

impl Stage for NormalsPipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = NoUniform;
    /// The layers of bulk and spray that normals are computed from.
    type State = [Group; 2];

    fn keys(&self, variant: &Variant) -> Vec<NormalSource> {
        let plan = &variant.plan;
        let bulk = plan.normals_from_depth().then_some(NormalSource::Depth);
        let spray = (plan.spray && !plan.index_one).then_some(NormalSource::Ellipsoids);
        bulk.into_iter().chain(spray).collect()
    }

    fn prepare(&self, of: &mut [Group; 2], _: &Surface, layers: &Layers, inputs: &Inputs) {
        for (group, layers) in of.iter_mut().zip([&layers.bulk, &layers.spray]) {
            let layers = [Input::texture(layers.as_ref())];
            group.prepare(inputs.gpu, SPAN, &self.layout, &layers);
        }
    }
}

/// The pass: normals of all surfaces.
pub(super) fn normals(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Kept<NormalsPipeline>)>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, kept) in surfaces {
            let [bulk_layers, spray_layers] = &kept.state;
            for (source, pipeline) in kept.pipelines(surface) {
                match source {
                    NormalSource::Depth => {
                        let pipeline = splats.cache.get_render_pipeline(*pipeline);
                        let (Some(pipeline), Some(target), Some(group)) =
                            (pipeline, &layers.bulk_normals, bulk_layers.get())
                        else {
                            continue;
                        };
                        let targets = [cleared(target, [0.0; 4])];
                        let mut pass = frame.begin(ctx, SPAN, &targets, None, pipeline);
                        pass.set_bind_group(1, group, &[]);
                        frame.draw_tiles(&mut pass);
                    }
                    NormalSource::Ellipsoids => {
                        if let Some(finished) = spray_layers.get() {
                            let target = &layers.spray_normals;
                            let pass = SplatPass::normals(finished, target, *pipeline);
                            splats.record(ctx, (surface, frame), pass, &[Class::Spray]);
                        }
                    }
                }
            }
        }
    });
}
