//! How a fluid and its particles have moved since the frame before, for the GPU.

use bevy::{
    app::SubApp,
    core_pipeline::prepass::MotionVectorPrepass,
    math::{Affine3A, Mat3A},
    prelude::*,
    render::{
        ExtractSchedule, GpuResourceAppExt, MainWorld, Render, RenderStartup, RenderSystems,
        render_resource::{
            BindGroup, BindGroupLayoutDescriptor, BindGroupLayoutEntries, Buffer, BufferDescriptor,
            BufferUsages, ShaderStages, ShaderType,
            binding_types::{storage_buffer_read_only_sized, uniform_buffer},
        },
        sync_world::RenderEntity,
    },
};

use super::displacements::Displacements;
use crate::render::{
    frame::{FrameStartup, Gpu, Group, Input, Offset, UniformArray, support::FluidSupport},
    surface::{fluids::ExtractedFluid, views::FluidView},
};

/// The Rust twin of `GpuFluidMotion` in `splat_motion.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(super) struct GpuFluidMotion {
    change: Mat4,
    about_center: Mat3,
    before: Mat3,
    displaced: u32,
}

impl GpuFluidMotion {
    fn new(now: &Affine3A, before: &Affine3A, displaced: u32) -> Self {
        let change = now.matrix3 - before.matrix3;
        let about_center = change * now.matrix3.inverse();
        let is_usable = about_center.is_finite();
        Self {
            change: Mat4::from(Affine3A {
                matrix3: change,
                translation: now.translation - before.translation,
            }),
            // Of a fluid that is flat.
            about_center: Mat3::from(if is_usable { about_center } else { Mat3A::ZERO }),
            before: before.matrix3.into(),
            displaced,
        }
    }
}

/// A fluid's motion; its buffer is there while a view asks for it.
#[derive(Component, Default)]
pub(crate) struct FluidMotion {
    displacements: Vec<[f32; 4]>,
    before: Option<Affine3A>,
    moves: bool,
    buffer: Option<Buffer>,
    offset: Offset,
    group: Group,
}

impl FluidMotion {
    /// Whether the fluid or any of its particles has moved.
    pub(super) fn moves(&self) -> bool {
        self.moves
    }

    /// The bind group, and its dynamic offset.
    pub(super) fn get(&self) -> Option<(&BindGroup, u32)> {
        Some((self.group.get()?, self.offset.bytes()))
    }

    /// How many displacements are uploaded.
    fn upload(&mut self, gpu: &Gpu) -> u32 {
        let limit = gpu.device.limits();
        let largest = limit
            .max_storage_buffer_binding_size
            .min(limit.max_buffer_size);
        let size = size_of::<[f32; 4]>();
        let count = self.displacements.len().min(largest as usize / size);
        let needed = (count.max(1) * size) as u64;
        if self.buffer.as_ref().is_none_or(|it| it.size() < needed) {
            self.buffer = Some(gpu.device.create_buffer(&BufferDescriptor {
                label: Some("fluid_displacements"),
                size: needed.next_power_of_two().min(largest),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer
            && count > 0
        {
            let bytes = bytemuck::cast_slice(&self.displacements[..count]);
            gpu.queue.write_buffer(buffer, 0, bytes);
        }
        count as u32
    }
}

/// The layout of group 2 of passes over splats that move.
#[derive(Resource)]
pub(super) struct MotionLayout(pub(super) BindGroupLayoutDescriptor);

pub(super) fn plugin(render_app: &mut SubApp) {
    render_app
        .init_gpu_resource::<UniformArray<GpuFluidMotion>>()
        .add_systems(
            RenderStartup,
            (init_layout, forget_buffers).in_set(FrameStartup),
        )
        .add_systems(ExtractSchedule, extract_displacements)
        .add_systems(
            Render,
            (
                prepare_motions.in_set(RenderSystems::PrepareResources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<ExtractedFluid, FluidMotion>();
    world.add_observer(
        |removed: On<Remove, ExtractedFluid>, mut commands: Commands| {
            commands.entity(removed.entity).try_remove::<FluidMotion>();
        },
    );
}

fn init_layout(mut commands: Commands) {
    commands.insert_resource(MotionLayout(BindGroupLayoutDescriptor::new(
        "fluid_motion_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::VERTEX_FRAGMENT,
            (
                storage_buffer_read_only_sized(false, None),
                uniform_buffer::<GpuFluidMotion>(true),
            ),
        ),
    )));
}

fn forget_buffers(mut fluids: Query<&mut FluidMotion>) {
    for mut motion in &mut fluids {
        *motion = default();
    }
}

/// Swaps the displacements for those of the frame before, which the next frame overwrites.
fn extract_displacements(
    mut main: ResMut<MainWorld>,
    mut state: Local<Option<QueryState<(RenderEntity, &mut Displacements)>>>,
    mut fluids: Query<&mut FluidMotion>,
) {
    let state = state.get_or_insert_with(|| main.query());
    for mut motion in &mut fluids {
        motion.displacements.clear();
    }
    for (entity, mut displacements) in state.iter_mut(&mut main) {
        if let Ok(mut motion) = fluids.get_mut(entity) {
            let values = &mut displacements.bypass_change_detection().values;
            core::mem::swap(&mut motion.displacements, values);
        }
    }
}

/// Uploads the motion of every fluid, if a view asks for it.
fn prepare_motions(
    views: Query<(), (With<FluidView>, With<MotionVectorPrepass>)>,
    mut fluids: Query<(&ExtractedFluid, &mut FluidMotion)>,
    mut uniforms: ResMut<UniformArray<GpuFluidMotion>>,
    support: Res<FluidSupport>,
    gpu: Gpu,
) {
    let is_asked = support.drawing && !views.is_empty();
    uniforms.clear();
    for (fluid, mut motion) in &mut fluids {
        if !is_asked {
            if motion.before.is_some() {
                *motion = default();
            }
            continue;
        }
        let now = fluid.transform.affine();
        let before = motion.before.replace(now).unwrap_or(now);
        let count = motion.upload(&gpu);
        motion.moves = count > 0 || now != before;
        motion.offset = uniforms.push(GpuFluidMotion::new(&now, &before, count));
    }
    uniforms.write(&gpu);
}

fn prepare_groups(
    mut fluids: Query<&mut FluidMotion>,
    layout: Res<MotionLayout>,
    uniforms: Res<UniformArray<GpuFluidMotion>>,
    gpu: Gpu,
) {
    for mut motion in &mut fluids {
        let FluidMotion { buffer, group, .. } = &mut *motion;
        if let Some(buffer) = buffer {
            let inputs = [Input::buffer(buffer), uniforms.input()];
            group.prepare(&gpu, "fluid_motion", &layout.0, &inputs);
        }
    }
}
