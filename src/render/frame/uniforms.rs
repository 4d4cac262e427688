//! Uniforms of the same type, of which each pass reads one.

use bevy::{
    prelude::*,
    render::render_resource::{DynamicUniformBuffer, ShaderType, encase::internal::WriteInto},
};

use super::{Gpu, Input};

/// Where an element lies in its array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Offset(u32);

impl Offset {
    /// As a dynamic offset.
    pub(crate) fn bytes(self) -> u32 {
        self.0
    }
}

/// Uniforms of all surfaces, or all fluids; uploaded only when one of them has changed.
#[derive(Resource)]
pub(crate) struct UniformArray<T: ShaderType> {
    values: Vec<T>,
    written: Vec<T>,
    buffer: DynamicUniformBuffer<T>,
}

impl<T: ShaderType> Default for UniformArray<T> {
    fn default() -> Self {
        Self {
            values: Vec::new(),
            written: Vec::new(),
            buffer: DynamicUniformBuffer::default(),
        }
    }
}

impl<T: ShaderType + WriteInto + Copy + PartialEq> UniformArray<T> {
    pub(crate) fn clear(&mut self) {
        self.values.clear();
    }

    pub(crate) fn push(&mut self, value: T) -> Offset {
        let index = self.values.len() as u64;
        self.values.push(value);
        // `DynamicUniformBuffer` aligns to 256, the largest alignment that a device may ask for.
        Offset((index * T::min_size().get().next_multiple_of(256)) as u32)
    }

    pub(crate) fn write(&mut self, gpu: &Gpu) {
        let written = self.values.is_empty() || self.buffer.buffer().is_some();
        if self.values == self.written && written {
            return;
        }
        self.written.clone_from(&self.values);
        self.buffer.clear();
        for value in &self.values {
            self.buffer.push(value);
        }
        self.buffer.write_buffer(&gpu.device, &gpu.queue);
    }

    pub(crate) fn input(&self) -> Input<'_> {
        Input::dynamic(&self.buffer)
    }
}
