//! Every shader variant composes, validates and makes a pipeline; GPU twins are as large as they say.

use bevy::{
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            CachedPipelineState, PipelineCache, SpecializedRenderPipeline, TextureFormat,
        },
    },
};
use fluid_stage::{headless_app, settle};

use super::{
    gpu_types::GpuQuad,
    pipeline::{RainKey, RainPart, RainPipeline},
};
use crate::rain::{
    RainPlugin,
    streaks::{HEIGHT, VARIANTS, WIDTH},
};

#[test]
fn every_part_of_rain_is_made() {
    let mut app = headless_app(UVec2::splat(16), |app| {
        app.add_plugins(RainPlugin::default());
    })
    .unwrap();
    settle(&mut app).unwrap();
    let world = app.sub_app(RenderApp).world();
    let (pipeline, cache) = (
        world.resource::<RainPipeline>(),
        world.resource::<PipelineCache>(),
    );
    let mut ids = Vec::new();
    for part in [RainPart::Backdrop, RainPart::Billboards, RainPart::Drops] {
        for format in [TextureFormat::Rgba16Float, TextureFormat::Rgba8UnormSrgb] {
            for samples in [1, 4] {
                let key = RainKey {
                    part,
                    format,
                    samples,
                };
                ids.push(cache.queue_render_pipeline(pipeline.specialize(key)));
            }
        }
    }
    // An error here names the pipeline and what is wrong with it.
    settle(&mut app).unwrap();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    for id in ids {
        let state = cache.get_render_pipeline_state(id);
        assert!(matches!(state, CachedPipelineState::Ok(_)), "{state:?}");
    }
}

/// What WGSL repeats of Rust's numbers.
#[test]
fn shaders_know_the_same_numbers() {
    let types = include_str!("types.wgsl");
    for line in [
        format!("const VARIANTS: u32 = {VARIANTS}u;"),
        format!("vec2({WIDTH}.0, {HEIGHT}.0)"),
    ] {
        assert!(types.contains(&line), "{line}");
    }
    assert_eq!(size_of::<GpuQuad>(), 40);
}
