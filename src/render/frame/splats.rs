//! Splats on the GPU, and passes that draw them.

use bevy::{
    app::SubApp,
    asset::load_embedded_asset,
    ecs::system::SystemParam,
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderStartup, RenderSystems,
        render_phase::TrackedRenderPass,
        render_resource::{
            BindGroup, BindGroupLayoutDescriptor, BindGroupLayoutEntries, Buffer, BufferDescriptor,
            BufferUsages, CachedRenderPipelineId, FragmentState, PipelineCache,
            RenderPassColorAttachment, RenderPassDepthStencilAttachment, RenderPipelineDescriptor,
            ShaderStages, VertexState,
            binding_types::{storage_buffer_read_only_sized, uniform_buffer},
        },
        renderer::{RenderContext, RenderDevice},
    },
    shader::ShaderDefVal,
};

use super::{
    Frame, FrameLayout, FrameStartup, Gpu, Group, Input, NORMAL_FORMAT, Offset, Target,
    UniformArray, cleared,
    pipelines::{MAX_BLEND, QUAD, fragment, one_texture_layout},
    support::FluidSupport,
};
use crate::{
    render::surface::{GpuFluid, Surface, SurfaceSystems, fluids::ExtractedFluid, plan::Plan},
    shape::Splat,
};

/// Splats in a storage buffer, uploaded only when they have changed.
#[derive(Component, Default)]
pub struct GpuSplats {
    buffer: Option<Buffer>,
    transform: Offset,
    group: Group,
    /// Number of times that splats have been uploaded.
    pub uploads: u64,
}

/// The layouts of passes over splats.
#[derive(Resource, Clone)]
pub(crate) struct SplatLayouts {
    /// Group 1: splats and their fluid's transform.
    pub(crate) splats: BindGroupLayoutDescriptor,
    /// Group 2 of a pass that compares splats with finished layers.
    pub(crate) finished: BindGroupLayoutDescriptor,
    normals: Handle<Shader>,
}

pub(super) fn plugin(render_app: &mut SubApp) {
    render_app
        .init_gpu_resource::<UniformArray<GpuFluid>>()
        .add_systems(
            RenderStartup,
            (init_layouts, forget_buffers).in_set(FrameStartup),
        )
        .add_systems(
            Render,
            (
                // Plans count the splats that are there.
                (upload_splats, prepare_transforms)
                    .chain()
                    .in_set(RenderSystems::PrepareResources)
                    .before(SurfaceSystems::Plan),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<ExtractedFluid, GpuSplats>();
    world.add_observer(
        |removed: On<Remove, ExtractedFluid>, mut commands: Commands| {
            commands.entity(removed.entity).try_remove::<GpuSplats>();
        },
    );
}

fn init_layouts(mut commands: Commands, assets: Res<AssetServer>) {
    commands.insert_resource(SplatLayouts {
        splats: BindGroupLayoutDescriptor::new(
            "fluid_splats_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX,
                (
                    storage_buffer_read_only_sized(false, None),
                    uniform_buffer::<GpuFluid>(true),
                ),
            ),
        ),
        finished: one_texture_layout("fluid_finished_layers_layout"),
        normals: load_embedded_asset!(assets.as_ref(), "splat_normals.wgsl"),
    });
}

/// Drops the buffers of a lost device; the splats are still available.
fn forget_buffers(mut fluids: Query<&mut GpuSplats>) {
    for mut gpu in &mut fluids {
        gpu.buffer = None;
        gpu.group = Group::default();
    }
}

fn upload_splats(
    mut fluids: Query<(&mut ExtractedFluid, &mut GpuSplats)>,
    support: Res<FluidSupport>,
    gpu: Gpu,
) {
    if !support.drawing {
        return;
    }
    for (mut fluid, mut splats) in &mut fluids {
        if !fluid.fresh && (splats.buffer.is_some() || fluid.splats.is_empty()) {
            continue;
        }
        fluid.fresh = false;
        if fluid.splats.is_empty() {
            continue;
        }
        let room = room(&gpu.device);
        if fluid.splats.len() > room {
            bevy::utils::once!(warn!(
                "a fluid of {} splats exceeds the adapter's buffers: the first {room} are drawn",
                fluid.splats.len()
            ));
            fluid.bulk = fluid.bulk.min(room as u32);
            fluid.interior = fluid.interior.min(room as u32 - fluid.bulk);
            let spray = fluid.spray.min(room as u32 - fluid.bulk - fluid.interior);
            // The partial ones are the last.
            let cut = fluid.spray - spray;
            fluid.partial[1] = fluid.partial[1].saturating_sub(cut);
            fluid.spray = spray;
            fluid.splats.truncate(room);
        }
        let bytes: &[u8] = bytemuck::cast_slice(&fluid.splats);
        let needed = bytes.len() as u64;
        if splats.buffer.as_ref().is_none_or(|b| b.size() < needed) {
            let capacity = fluid.splats.len().next_power_of_two().min(room);
            splats.buffer = Some(gpu.device.create_buffer(&BufferDescriptor {
                label: Some("fluid_splats"),
                size: (capacity * size_of::<Splat>()) as u64,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &splats.buffer {
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
        splats.uploads += 1;
    }
}

/// How many splats fit into a buffer.
fn room(device: &RenderDevice) -> usize {
    let limit = device.limits();
    let bytes = limit
        .max_storage_buffer_binding_size
        .min(limit.max_buffer_size);
    bytes as usize / size_of::<Splat>()
}

/// Writes the transform of every fluid.
fn prepare_transforms(
    mut fluids: Query<(&ExtractedFluid, &mut GpuSplats)>,
    mut uniforms: ResMut<UniformArray<GpuFluid>>,
    gpu: Gpu,
) {
    uniforms.clear();
    for (fluid, mut splats) in &mut fluids {
        splats.transform = uniforms.push(GpuFluid {
            world_from_local: fluid.transform.to_matrix(),
            radius: fluid.local_radius,
        });
    }
    uniforms.write(&gpu);
}

fn prepare_groups(
    mut fluids: Query<&mut GpuSplats>,
    layouts: Res<SplatLayouts>,
    uniforms: Res<UniformArray<GpuFluid>>,
    gpu: Gpu,
) {
    for mut splats in &mut fluids {
        let GpuSplats { buffer, group, .. } = &mut *splats;
        // Requested only here: a device without storage buffers has no such layout, nor any splats.
        if let Some(buffer) = buffer {
            let inputs = [Input::buffer(buffer), uniforms.input()];
            group.prepare(&gpu, "fluid_splats", &layouts.splats, &inputs);
        }
    }
}

/// Which splats are drawn; `All` includes the interior.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Class {
    Bulk,
    Spray,
    All,
}

/// Draws the splats of a surface.
#[derive(SystemParam)]
pub(crate) struct Splats<'w, 's> {
    fluids: Query<'w, 's, &'static GpuSplats>,
    pub(crate) cache: Res<'w, PipelineCache>,
}

impl Splats<'_, '_> {
    /// Draws the splats of one class of all of a surface's fluids.
    fn draw<'a>(
        &'a self,
        pass: &mut TrackedRenderPass<'a>,
        surface: &Surface,
        plan: &Plan,
        class: Class,
        of_fluid: Option<GroupOf<'a>>,
    ) {
        for fluid in &surface.fluids {
            let Ok(splats) = self.fluids.get(fluid.entity) else {
                continue;
            };
            let Some(group) = splats.group.get() else {
                continue;
            };
            if let Some(of_fluid) = of_fluid {
                let Some((group, offset)) = of_fluid(fluid.entity) else {
                    continue;
                };
                pass.set_bind_group(2, group, &[offset]);
            }
            let bulk = fluid.bulk + if plan.interior { fluid.interior } else { 0 };
            let spray = fluid.bulk + fluid.interior;
            let range = match class {
                Class::Bulk => 0..bulk,
                Class::Spray => spray..spray + fluid.spray,
                // Each particle once.
                Class::All => fluid.partial[0]..spray + fluid.spray - fluid.partial[1],
            };
            if !range.is_empty() {
                pass.set_bind_group(1, group, &[splats.transform.bytes()]);
                pass.draw(0..4, range);
            }
        }
    }

    /// A pass over the splats of some classes of a surface; none without an attachment.
    pub(crate) fn record<'a>(
        &'a self,
        ctx: &'a mut RenderContext,
        (surface, frame): (&Surface, &'a Frame),
        pass: SplatPass<'a>,
        classes: &[Class],
    ) {
        let SplatPass {
            color,
            coverage,
            depth,
            ..
        } = pass;
        let pipeline = pass
            .pipeline
            .and_then(|id| self.cache.get_render_pipeline(id));
        let (Some(plan), Some(pipeline)) = (surface.plan(), pipeline) else {
            return;
        };
        if color.is_none() && depth.is_none() {
            return;
        }
        let colors = [color, coverage];
        let colors = match &colors {
            [None, ..] => &[],
            [_, None] => &colors[..1],
            both => both,
        };
        let mut recorded = frame.begin(ctx, pass.label, colors, depth, pipeline);
        if let Some(finished) = pass.finished {
            recorded.set_bind_group(2, finished, &[]);
        }
        for &class in classes {
            self.draw(&mut recorded, surface, plan, class, pass.of_fluid);
        }
    }
}

/// A pass over splats.
#[derive(Default)]
pub(crate) struct SplatPass<'a> {
    pub(crate) label: &'static str,
    pub(crate) pipeline: Option<CachedRenderPipelineId>,
    pub(crate) color: Option<RenderPassColorAttachment<'a>>,
    /// Written as well, where pipelines do.
    pub(crate) coverage: Option<RenderPassColorAttachment<'a>>,
    pub(crate) depth: Option<RenderPassDepthStencilAttachment<'a>>,
    /// Group 2: finished layers that splats are compared with.
    pub(crate) finished: Option<&'a BindGroup>,
    /// Group 2, if each fluid has its own.
    pub(crate) of_fluid: Option<GroupOf<'a>>,
}

/// The bind group of a fluid, with its dynamic offset.
pub(crate) type GroupOf<'a> = &'a dyn Fn(Entity) -> Option<(&'a BindGroup, u32)>;

impl<'a> SplatPass<'a> {
    /// Sums up a value over splats.
    pub(crate) fn sum(
        label: &'static str,
        target: &'a Option<Target>,
        pipeline: Option<CachedRenderPipelineId>,
    ) -> Self {
        Self {
            label,
            pipeline,
            color: target.as_ref().and_then(|it| cleared(it, [0.0; 4])),
            ..default()
        }
    }

    /// Normals of the ellipsoids that made finished layers.
    pub(crate) fn normals(
        finished: &'a BindGroup,
        target: &'a Option<Target>,
        pipeline: CachedRenderPipelineId,
    ) -> Self {
        Self {
            label: "fluid_splat_normals",
            pipeline: Some(pipeline),
            color: target.as_ref().and_then(|it| cleared(it, [-2.0; 4])),
            finished: Some(finished),
            ..default()
        }
    }
}

/// A pass over splats: `layouts` are those of groups 2 and up.
pub(crate) fn splat_pipeline(
    label: &'static str,
    frame: &FrameLayout,
    splats: &SplatLayouts,
    layouts: impl IntoIterator<Item = BindGroupLayoutDescriptor>,
    vertex_defs: Vec<ShaderDefVal>,
    fragment: FragmentState,
) -> RenderPipelineDescriptor {
    RenderPipelineDescriptor {
        label: Some(label.into()),
        layout: [frame.layout.clone(), splats.splats.clone()]
            .into_iter()
            .chain(layouts)
            .collect(),
        vertex: VertexState {
            shader: fragment.shader.clone(),
            shader_defs: vertex_defs,
            entry_point: Some("vertex".into()),
            buffers: vec![],
        },
        primitive: QUAD,
        fragment: Some(fragment),
        ..default()
    }
}

/// The pipeline of [`SplatPass::normals`].
pub(crate) fn normals_pipeline(
    frame: &FrameLayout,
    splats: &SplatLayouts,
) -> RenderPipelineDescriptor {
    let label = "fluid_splat_normals_pipeline";
    let finished = [splats.finished.clone()];
    // If two ellipsoids made the same pixel, either normal is valid.
    let fragment = fragment(&splats.normals, vec![], &[NORMAL_FORMAT], Some(MAX_BLEND));
    splat_pipeline(label, frame, splats, finished, vec![], fragment)
}
