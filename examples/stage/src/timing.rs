//! GPU times.

use bevy::{
    diagnostic::{DiagnosticPath, DiagnosticsStore},
    prelude::*,
};

/// The median GPU time of a span over the frames that Bevy keeps (120), in milliseconds.
///
/// `path` is as in `render/main_opaque_pass_3d/elapsed_gpu`; `None` if no frame has recorded it, as
/// on adapters without timestamp queries.
pub fn median_gpu_ms(app: &App, path: &str) -> Option<f64> {
    let store = app.world().get_resource::<DiagnosticsStore>()?;
    let mut times: Vec<f64> = store
        .get(&DiagnosticPath::new(path.to_owned()))?
        .values()
        .copied()
        .collect();
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}

/// The paths of all GPU spans recorded so far, sorted.
pub fn gpu_spans(app: &App) -> Vec<String> {
    let Some(store) = app.world().get_resource::<DiagnosticsStore>() else {
        return Vec::new();
    };
    let mut paths: Vec<String> = store
        .iter()
        .map(|diagnostic| diagnostic.path().to_string())
        .filter(|path| path.ends_with("/elapsed_gpu"))
        .collect();
    paths.sort();
    paths
}
