//! Bind groups of all passes, created once their textures and uniforms exist.

use bevy::{
    core_pipeline::prepass::ViewPrepassTextures,
    prelude::*,
    render::{
        render_asset::RenderAssets,
        render_resource::{BindGroup, BindGroupEntries, PipelineCache, TextureView},
        renderer::RenderDevice,
        texture::{FallbackImage, GpuImage},
        view::ViewUniforms,
    },
};

use super::{
    bindings::common_layout,
    bodies::{Body, FluidUniforms, ViewBodies},
    composite::CompositePipeline,
    extract::GpuSplats,
    normals::NormalsPipeline,
    refract::RefractPipeline,
    scene_depth::SceneDepthPipelines,
    scene_textures::Placeholders,
    smooth::SmoothPipeline,
    splat::SplatPipeline,
};

/// The layouts and their resources.
#[derive(bevy::ecs::system::SystemParam)]
pub(crate) struct Sources<'w> {
    cache: Res<'w, PipelineCache>,
    device: Res<'w, RenderDevice>,
    views: Res<'w, ViewUniforms>,
    scene_depth: Res<'w, SceneDepthPipelines>,
    uniforms: Res<'w, FluidUniforms>,
    splat: Res<'w, SplatPipeline>,
    smooth: Res<'w, SmoothPipeline>,
    normals: Res<'w, NormalsPipeline>,
    refract: Res<'w, RefractPipeline>,
    composite: Res<'w, CompositePipeline>,
    placeholders: Res<'w, Placeholders>,
    images: Res<'w, RenderAssets<GpuImage>>,
    fallback: Res<'w, FallbackImage>,
}

pub(crate) fn prepare_splat_bind_groups(mut fluids: Query<&mut GpuSplats>, sources: Sources) {
    for mut gpu in &mut fluids {
        let (Some(buffer), Some(transform)) = (&gpu.buffer, sources.uniforms.fluids.binding())
        else {
            continue;
        };
        // Requested only here: a device without storage buffers has no such layout, nor any splats.
        let layout = sources
            .cache
            .get_bind_group_layout(&sources.splat.fluid_layout);
        let group = sources.device.create_bind_group(
            "fluid_splats",
            &layout,
            &BindGroupEntries::sequential((buffer.as_entire_binding(), transform)),
        );
        gpu.bind_group = Some(group);
    }
}

pub(crate) fn prepare_body_bind_groups(
    mut views: Query<(&mut ViewBodies, &ViewPrepassTextures)>,
    sources: Sources,
) {
    for (mut view, prepass) in &mut views {
        let Some(prepass_depth) = prepass.depth_view() else {
            continue;
        };
        view.scene_depth_group = Some(sources.scene_depth.bind_group(
            &sources.device,
            &sources.cache,
            view.multisampled,
            prepass_depth,
        ));
        let scene_depth_ready = sources
            .scene_depth
            .pipeline(&sources.cache, view.multisampled)
            .is_some();
        let scene_depth = view.scene_depth.default_view.clone();
        let scene_color = view
            .scene_color
            .as_ref()
            .map(|copy| copy.default_view.clone());
        let scene_before = view
            .scene_before
            .as_ref()
            .map(|copy| copy.default_view.clone());
        for body in &mut view.bodies {
            body.groups.common = sources.common(&scene_depth);
            body.groups.merge = sources.merge(body);
            body.groups.smooth = body.steps.bind_groups(
                &sources.device,
                &sources.cache,
                &sources.smooth,
                &body.layers,
            );
            body.groups.bulk_layers = Some(sources.layer(body.layers.bulk_view()));
            body.groups.splat_normals = body
                .layers
                .splat_normals
                .as_ref()
                .map(|normals| sources.layer(&normals.default_view));
            body.groups.spray_layers = Some(sources.layer(&body.layers.spray.default_view));
            body.groups.refract = Some(sources.refract(body));
            body.groups.composite = match &scene_color {
                Some(color) => {
                    let before = scene_before.as_ref().unwrap_or(color);
                    Some(sources.composite(body, color, before))
                }
                None => sources.debug(body),
            };
            body.mark_ready(&sources.cache, scene_depth_ready);
        }
    }
}

impl Sources<'_> {
    fn common(&self, scene_depth: &TextureView) -> Option<BindGroup> {
        let layout = self.cache.get_bind_group_layout(&common_layout());
        Some(self.device.create_bind_group(
            "fluid_common",
            &layout,
            &BindGroupEntries::sequential((
                self.views.uniforms.binding()?,
                self.uniforms.bodies.binding()?,
                scene_depth,
            )),
        ))
    }

    fn merge(&self, body: &Body) -> Option<BindGroup> {
        let [front, back] = body.layers.depths.as_ref()?;
        let layout = self.cache.get_bind_group_layout(&self.splat.merge_layout);
        Some(self.device.create_bind_group(
            "fluid_merge",
            &layout,
            &BindGroupEntries::sequential((&front.default_view, &back.default_view)),
        ))
    }

    fn layer(&self, view: &TextureView) -> BindGroup {
        self.normals.bind_group(&self.device, &self.cache, view)
    }

    /// A cubemap; white where there is none, which the uniform's intensity of 0 hides.
    fn cube(&self, image: Option<AssetId<Image>>) -> &GpuImage {
        image
            .and_then(|id| self.images.get(id))
            .unwrap_or(&self.fallback.cube)
    }

    fn refract(&self, body: &Body) -> BindGroup {
        let layout = self.cache.get_bind_group_layout(&self.refract.layout);
        let layers = &body.layers;
        self.device.create_bind_group(
            "fluid_refract",
            &layout,
            &BindGroupEntries::sequential((
                &self.cube(body.cubemaps.environment).texture_view,
                &self.placeholders.linear,
                layers.bulk_view(),
                &layers.bulk_normals.default_view,
                &layers.spray.default_view,
                &layers.spray_normals.default_view,
                &self.cube(body.cubemaps.diffuse).texture_view,
                &layers
                    .thickness
                    .as_ref()
                    .unwrap_or(&self.placeholders.layers)
                    .default_view,
            )),
        )
    }

    fn composite(
        &self,
        body: &Body,
        scene_color: &TextureView,
        scene_before: &TextureView,
    ) -> BindGroup {
        let layout = self.cache.get_bind_group_layout(&self.composite.layout);
        let layers = &body.layers;
        self.device.create_bind_group(
            "fluid_composite",
            &layout,
            &BindGroupEntries::sequential((
                &self.cube(body.cubemaps.environment).texture_view,
                &self.placeholders.linear,
                &layers.radiance.default_view,
                &layers.transmission.default_view,
                &layers.exits.default_view,
                layers.bulk_view(),
                &layers.spray.default_view,
                scene_color,
                &self.placeholders.linear,
                scene_before,
            )),
        )
    }

    fn debug(&self, body: &Body) -> Option<BindGroup> {
        let layout = self
            .cache
            .get_bind_group_layout(&self.composite.debug_layout);
        let layers = &body.layers;
        Some(
            self.device.create_bind_group(
                "fluid_debug_view",
                &layout,
                &BindGroupEntries::sequential((
                    layers.bulk_view(),
                    &layers.bulk_normals.default_view,
                    &layers.spray.default_view,
                    &layers.spray_normals.default_view,
                    &layers.exits.default_view,
                    self.uniforms.depth_ranges.binding()?,
                    &layers
                        .overdraw
                        .as_ref()
                        .or(layers.thickness.as_ref())
                        .unwrap_or(&self.placeholders.layers)
                        .default_view,
                )),
            ),
        )
    }
}
