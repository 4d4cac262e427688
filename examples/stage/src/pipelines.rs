//! Descriptions of waiting and failed pipelines.

use std::collections::HashSet;

use bevy::{
    prelude::*,
    render::{
        RenderApp,
        render_resource::{CachedPipeline, CachedPipelineState, PipelineCache, PipelineDescriptor},
    },
};

/// Pipelines that Bevy still tries to compile. A failure because of a missing shader is retried,
/// since the shader may still be loading; any other failure is final and not included.
pub(crate) fn waiting_pipelines(app: &App) -> Vec<String> {
    let Some(cache) = cache(app) else {
        return Vec::new();
    };
    let waiting: HashSet<usize> = cache.waiting_pipelines().collect();
    cache
        .pipelines()
        .enumerate()
        .filter(|(id, _)| waiting.contains(id))
        .map(|(_, pipeline)| describe(pipeline))
        .collect()
}

/// Pipelines that did not compile.
pub(crate) fn failed_pipelines(app: &App) -> Vec<String> {
    cache(app)
        .into_iter()
        .flat_map(PipelineCache::pipelines)
        .filter(|pipeline| matches!(pipeline.state, CachedPipelineState::Err(_)))
        .map(describe)
        .collect()
}

fn cache(app: &App) -> Option<&PipelineCache> {
    app.get_sub_app(RenderApp)?.world().get_resource()
}

fn describe(pipeline: &CachedPipeline) -> String {
    let label = match &pipeline.descriptor {
        PipelineDescriptor::RenderPipelineDescriptor(descriptor) => &descriptor.label,
        PipelineDescriptor::ComputePipelineDescriptor(descriptor) => &descriptor.label,
    };
    let state = match &pipeline.state {
        CachedPipelineState::Queued => "queued".into(),
        CachedPipelineState::Creating(_) => "compiling".into(),
        CachedPipelineState::Ok(_) => "compiled".into(),
        CachedPipelineState::Err(error) => error.to_string(),
    };
    format!("{}: {state}", label.as_deref().unwrap_or("(no label)"))
}
