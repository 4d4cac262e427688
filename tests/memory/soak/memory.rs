//! Whose memory it is: Rust's, the GPU's, and all that the process holds.

use bevy::{prelude::*, render::renderer::RenderDevice};

use crate::heap;

pub(crate) const MEBIBYTE: f64 = 1_048_576.0;

/// Bytes in use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Memory {
    /// Held on the heap by Rust code: ours, Bevy's and wgpu's, not the driver's.
    pub(crate) heap: f64,
    /// Handed out by the GPU's allocator: every texture and buffer there is.
    pub(crate) gpu: f64,
    /// Of this process in memory, whatever they are for, the driver's among them; 0 where the
    /// system does not tell.
    pub(crate) process: f64,
}

impl Memory {
    pub(crate) fn of(app: &App) -> Self {
        let stats = heap::stats();
        let device = app.world().resource::<RenderDevice>();
        let report = device.wgpu_device().generate_allocator_report();
        let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
        let pages = statm.split(' ').nth(1).and_then(|pages| pages.parse().ok());
        Self {
            heap: (stats.bytes_allocated - stats.bytes_deallocated) as f64,
            gpu: report.map_or(0.0, |report| report.total_allocated_bytes as f64),
            process: 4096.0 * pages.unwrap_or(0.0),
        }
    }

    pub(crate) fn mean(samples: &[Self]) -> Self {
        let mean =
            |of: fn(&Self) -> f64| samples.iter().map(of).sum::<f64>() / samples.len() as f64;
        Self {
            heap: mean(|memory| memory.heap),
            gpu: mean(|memory| memory.gpu),
            process: mean(|memory| memory.process),
        }
    }

    /// Each part, named, before and after.
    pub(crate) fn beside(self, after: Self) -> [(&'static str, f64, f64); 3] {
        [
            ("Rust's heap", self.heap, after.heap),
            ("on the GPU", self.gpu, after.gpu),
            ("the process", self.process, after.process),
        ]
    }
}
