//! Bind groups that are made anew only when one of their inputs is another.

use bevy::{
    ecs::system::SystemParam,
    prelude::*,
    render::{
        render_resource::{
            BindGroup, BindGroupEntry, BindGroupLayoutDescriptor, BindingResource, Buffer,
            BufferId, DynamicUniformBuffer, PipelineCache, Sampler, SamplerId, ShaderType,
            TextureView, TextureViewId, encase::internal::WriteInto,
        },
        renderer::{RenderDevice, RenderQueue},
    },
};

use super::{Target, TextureMemory};

/// What it takes to make things on the GPU.
#[derive(SystemParam)]
pub(crate) struct Gpu<'w> {
    pub(crate) device: Res<'w, RenderDevice>,
    pub(crate) queue: Res<'w, RenderQueue>,
    pub(crate) cache: Res<'w, PipelineCache>,
    pub(super) memory: Res<'w, TextureMemory>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InputId {
    Missing,
    Texture(TextureViewId),
    Sampler(SamplerId),
    Buffer(BufferId),
}

/// An input of a bind group; one that is missing makes for no group.
#[derive(Clone)]
pub(crate) struct Input<'a>(InputId, Option<BindingResource<'a>>);

impl<'a> Input<'a> {
    const MISSING: Self = Self(InputId::Missing, None);

    pub(crate) fn view(view: &'a TextureView) -> Self {
        let resource = BindingResource::TextureView(view);
        Self(InputId::Texture(view.id()), Some(resource))
    }

    pub(crate) fn texture(target: Option<&'a Target>) -> Self {
        target.map_or(Self::MISSING, |target| Self::view(&target.view))
    }

    pub(crate) fn sampler(sampler: &'a Sampler) -> Self {
        Self(
            InputId::Sampler(sampler.id()),
            Some(BindingResource::Sampler(sampler)),
        )
    }

    pub(crate) fn buffer(buffer: &'a Buffer) -> Self {
        Self(
            InputId::Buffer(buffer.id()),
            Some(buffer.as_entire_binding()),
        )
    }

    /// One element of an array of uniforms.
    pub(crate) fn dynamic<T: ShaderType + WriteInto>(
        uniforms: &'a DynamicUniformBuffer<T>,
    ) -> Self {
        let buffer = uniforms.buffer().zip(uniforms.binding());
        buffer.map_or(Self::MISSING, |(buffer, binding)| {
            Self(InputId::Buffer(buffer.id()), Some(binding))
        })
    }
}

/// A bind group, and what it was made of.
#[derive(Default)]
pub(crate) struct Group {
    inputs: Vec<InputId>,
    group: Option<BindGroup>,
}

impl Group {
    pub(crate) fn get(&self) -> Option<&BindGroup> {
        self.group.as_ref()
    }

    /// Makes the group, unless it is there and of the same inputs.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        label: &'static str,
        layout: &BindGroupLayoutDescriptor,
        inputs: &[Input],
    ) {
        if self.inputs.iter().eq(inputs.iter().map(|Input(id, _)| id)) {
            return;
        }
        self.inputs.clear();
        self.inputs.extend(inputs.iter().map(|Input(id, _)| *id));
        let entries: Option<Vec<_>> = (0..)
            .zip(inputs)
            .map(|(binding, Input(_, resource))| {
                Some(BindGroupEntry {
                    binding,
                    resource: resource.clone()?,
                })
            })
            .collect();
        self.group = entries.map(|entries| {
            let layout = gpu.cache.get_bind_group_layout(layout);
            gpu.device.create_bind_group(label, &layout, &entries)
        });
    }
}
