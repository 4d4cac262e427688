//! A view's voxels and cells of drops, and its copy of the scene's depth.

use core::ops::Range;

use bevy::{
    prelude::*,
    render::{
        render_resource::{
            BindGroup, BufferId, BufferUsages, RawBufferVec, TextureFormat, TextureViewId,
        },
        texture::CachedTexture,
    },
};

use super::gpu_types::GpuQuad;

/// Maximum number of shells between which transparent objects are sorted.
pub(crate) const MAX_SHELLS: usize = 16;

/// Items of a view after its shells.
pub(crate) const BACKDROP: usize = MAX_SHELLS;
pub(crate) const DROPS: usize = MAX_SHELLS + 1;

/// The rain that a view draws, in the render world.
#[derive(Component)]
pub struct RainQuads {
    /// Voxels of streaks from far to near, followed by cells of individually drawn drops.
    pub(crate) instances: RawBufferVec<GpuQuad>,
    pub(crate) shells: Vec<Shell>,
    pub(crate) cells: Range<u32>,
    /// Indices to draw for every cell of drops.
    pub(crate) drop_indices: u32,
    pub(crate) depth: Option<CachedTexture>,
    pub(crate) bind_group: Option<RainBindGroup>,
    pub(crate) uniform_offset: u32,
    pub(crate) view_offset: u32,
    /// Format and samples of the target in the last frame.
    pub(crate) target: Option<(TextureFormat, u32)>,
}

/// The bind group of the shaders and the resources it was made from; it is valid until they change.
pub(crate) struct RainBindGroup {
    pub(crate) group: BindGroup,
    pub(crate) buffers: [BufferId; 2],
    pub(crate) textures: [TextureViewId; 3],
}

/// Voxels at about the same distance from the eye.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shell {
    pub(crate) instances: Range<u32>,
    /// m.
    pub(crate) distance: f32,
}

impl RainQuads {
    /// Number of voxels of streaks and cells of drops that the view draws.
    pub fn len(&self) -> usize {
        self.instances.len()
    }

    /// Whether the view draws no voxels or cells.
    pub fn is_empty(&self) -> bool {
        self.instances.is_empty()
    }

    /// Sorts the voxels of streaks, the only instances so far, from far to near and cuts them into
    /// shells: a single shell if nothing needs to sort between them.
    pub(crate) fn cut_shells(&mut self, distance: f32, alone: bool) {
        self.shells.clear();
        let quads = self.instances.values_mut();
        quads.sort_unstable_by(|a, b| b.radius.total_cmp(&a.radius));
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
        // Shells beyond the maximum are merged into the last one.
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
            cells: 0..0,
            drop_indices: 0,
            depth: None,
            bind_group: None,
            uniform_offset: 0,
            view_offset: 0,
            target: None,
        }
    }
}
