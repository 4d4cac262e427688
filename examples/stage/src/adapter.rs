//! Checks for an adapter that can render, first of all, since Bevy panics without one.

use std::sync::OnceLock;

use bevy::{render::settings::WgpuSettings, tasks::block_on};
use wgpu::{BackendOptions, Instance, InstanceDescriptor, RequestAdapterOptions};

use crate::StageError;

/// Checks once per process, with Bevy's own settings (`WGPU_BACKEND` and the like), so that Bevy
/// finds the same adapter.
pub(crate) fn require_adapter() -> Result<(), StageError> {
    static FOUND: OnceLock<bool> = OnceLock::new();
    if *FOUND.get_or_init(|| block_on(find_adapter())) {
        Ok(())
    } else {
        Err(StageError::NoAdapter)
    }
}

async fn find_adapter() -> bool {
    let settings = WgpuSettings::default();
    let Some(backends) = settings.backends else {
        return false;
    };
    Instance::new(InstanceDescriptor {
        backends,
        flags: settings.instance_flags,
        memory_budget_thresholds: settings.instance_memory_budget_thresholds,
        display: None,
        backend_options: BackendOptions::default(),
    })
    .request_adapter(&RequestAdapterOptions {
        power_preference: settings.power_preference,
        ..Default::default()
    })
    .await
    .is_ok()
}
