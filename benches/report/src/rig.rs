//! An app that shows a scene, and what its GPU holds, as images in f64.

use bevy::{
    camera::{Hdr, SubCameraView},
    core_pipeline::{Core3d, tonemapping::Tonemapping},
    math::{DVec2, DVec3, UVec2},
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            Extent3d, Texture, TextureDataOrder, TextureDescriptor, TextureDimension,
            TextureFormat, TextureUsages,
        },
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
    },
};
use bevy_fluid::{
    particles::ShapedFluid,
    prelude::{FluidMaterial, FluidParticles, FluidPlugin},
    render::{ExitRay, FluidPasses, Layers, ViewSurfaces, decode_normal, encode_normal},
};
use fluid_reference::{
    Image, Lens, Span,
    mesh::{Layer, Sheet},
    metrics::Front,
};
use fluid_stage::{TextureData, capture, headless_app, read_texture, settle, step};
use half::f16;

use crate::{ReportError, methods::Method, scenes::Scene, surroundings::Surroundings};

/// An app that shows a scene.
pub(crate) struct Rig {
    pub(crate) app: App,
    camera: fluid_reference::Camera,
    eye: Entity,
    fluid: Entity,
}

/// What the camera sees of bulk and spray.
pub(crate) struct Seen {
    pub(crate) bulk: Layer,
    pub(crate) spray: Layer,
}

impl Rig {
    pub(crate) fn new(scene: &Scene) -> Result<Self, ReportError> {
        let camera = scene.camera;
        let mut entities = (Entity::PLACEHOLDER, Entity::PLACEHOLDER);
        let app = headless_app(camera.size, |app| {
            app.add_plugins(FluidPlugin::default());
            let world = app.world_mut();
            let sky = Surroundings::sky(world);
            scene.around.spawn(world);
            let eye = world.spawn((
                Camera3d::default(),
                Hdr,
                Msaa::Off,
                Tonemapping::None,
                projection(camera.lens),
                transform(&camera),
                sky,
            ));
            let eye = eye.id();
            let particles = FluidParticles::new(scene.positions.clone(), scene.radius as f32);
            let fluid = world.spawn((particles, FluidMaterial::WATER)).id();
            entities = (eye, fluid);
            if let Some(render) = app.get_sub_app_mut(RenderApp) {
                render.add_systems(
                    Core3d,
                    put_exact_layers
                        .after(FluidPasses::Normals)
                        .before(FluidPasses::Refract),
                );
            }
        })?;
        let (eye, fluid) = entities;
        Ok(Self {
            app,
            camera,
            eye,
            fluid,
        })
    }

    /// Draws with a method from the next frame on.
    pub(crate) fn choose(&mut self, method: &Method) {
        let world = self.app.world_mut();
        world.entity_mut(self.eye).insert(method.settings);
        let mut fluid = world.entity_mut(self.fluid);
        if fluid.get() != Some(&method.kernel) {
            fluid.insert(method.kernel);
        }
        if fluid.get() != Some(&method.material) {
            fluid.insert(method.material);
        }
    }

    /// Draws with a method, its pipelines compiled.
    pub(crate) fn show(&mut self, method: &Method) -> Result<(), ReportError> {
        self.choose(method);
        Ok(settle(&mut self.app)?)
    }

    /// Looks from another camera of the same size and lens, through places so many pixels off the
    /// middles of its pixels, from the next frame on. What is measured in pixels stays as it is.
    pub(crate) fn aim(&mut self, camera: &fluid_reference::Camera, off: DVec2) {
        self.camera = *camera;
        let mut eye = self.app.world_mut().entity_mut(self.eye);
        eye.insert(transform(camera));
        if let Some(mut eye) = eye.get_mut::<Camera>() {
            eye.sub_camera_view = (off != DVec2::ZERO).then(|| SubCameraView {
                full_size: camera.size,
                offset: off.as_vec2(),
                size: camera.size,
            });
        }
    }

    /// Draws once more.
    pub(crate) fn frame(&mut self) {
        step(&mut self.app, 1);
    }

    /// Has the particles shaped anew in the next frame.
    pub(crate) fn stir(&mut self) {
        if let Some(mut particles) = self.app.world_mut().get_mut::<FluidParticles>(self.fluid) {
            particles.set_changed();
        }
    }

    pub(crate) fn shaped(&self) -> Option<&ShapedFluid> {
        self.app.world().get(self.fluid)
    }

    /// Puts the camera in a white furnace, or back under the sky.
    pub(crate) fn heat(&mut self, on: bool) {
        let world = self.app.world_mut();
        if on {
            let furnace = Surroundings::furnace(world);
            world.entity_mut(self.eye).insert(furnace);
        } else {
            let sky = Surroundings::sky(world);
            world.entity_mut(self.eye).insert(sky);
        }
    }

    /// Textures of the only surface.
    fn layers(&self) -> Option<&Layers> {
        let render = self.app.get_sub_app(RenderApp)?.world();
        let mut surfaces = render.iter_entities();
        surfaces.find_map(|entity| entity.get::<Layers>())
    }

    /// A texture, as large as the view.
    fn read(
        &self,
        pick: fn(&Layers) -> Option<&Texture>,
    ) -> Result<Option<TextureData>, ReportError> {
        let Some((layers, texture)) = self
            .layers()
            .and_then(|layers| Some((layers, pick(layers)?)))
        else {
            return Ok(None);
        };
        let data = read_texture(&self.app, texture)?;
        let nothing: &[u8] = match data.format {
            TextureFormat::Rg32Float => bytemuck::cast_slice(&[0.0_f32, -2.0]),
            _ => &[0; 16],
        };
        Ok(Some(data.placed(
            layers.origin(),
            self.camera.size,
            nothing,
        )))
    }

    /// Layers and normals as the last frame left them.
    pub(crate) fn seen(&self) -> Result<Seen, ReportError> {
        let size = self.camera.size;
        let world_from_view = self.camera.world_from_view;
        let layer = |depths, normals| -> Result<Layer, ReportError> {
            let depths = self.read(depths)?;
            let normals = self.read(normals)?;
            let sheet = |back: bool| Sheet {
                depth: image(size, &depths, |data, UVec2 { x, y }| {
                    let [front, stored_back] = data.f32x2(x, y);
                    let depth = if back { -stored_back } else { front };
                    let there = if back {
                        stored_back > -2.0
                    } else {
                        front > 0.0
                    };
                    there.then_some(f64::from(depth))
                }),
                normals: Some(image(size, &normals, |data, UVec2 { x, y }| {
                    let [a, b, c, d] = data.f16x4(x, y);
                    // Both are stored towards the viewer.
                    let code = if back { [c, d] } else { [a, b] };
                    let out = decode_normal(code).as_dvec3() * if back { -1.0 } else { 1.0 };
                    (code != [0.0; 2]).then(|| world_from_view.transform_vector3(out))
                })),
            };
            Ok(Layer {
                front: sheet(false),
                back: sheet(true),
            })
        };
        Ok(Seen {
            bulk: layer(Layers::bulk, Layers::bulk_normals)?,
            spray: layer(Layers::spray, Layers::spray_normals)?,
        })
    }

    /// The nearest surface of each pixel's middle as the last frame left it.
    pub(crate) fn fronts(&self) -> Result<Image<Option<Front>>, ReportError> {
        let (size, camera) = (self.camera.size, &self.camera);
        let [bulk, spray] = [self.read(Layers::bulk)?, self.read(Layers::spray)?];
        let depth = |data: &Option<TextureData>, UVec2 { x, y }: UVec2| -> f32 {
            data.as_ref().map_or(0.0, |data| data.f32x2(x, y)[0])
        };
        Ok(Image::from_fn(size, |pixel| {
            let [bulk, spray] = [depth(&bulk, pixel), depth(&spray, pixel)];
            let nearest = bulk.max(spray);
            (nearest > 0.0).then(|| Front {
                view_depth: camera.view_from_device(f64::from(nearest)),
                droplet: spray > bulk,
            })
        }))
    }

    /// The part of each pixel that the liquid covers as the last frame left it: all or nothing
    /// where edges are not antialiased.
    pub(crate) fn coverage(&self) -> Result<Image<f64>, ReportError> {
        let Some(data) = self.read(Layers::coverage)? else {
            return Ok(self.fronts()?.map(|front| f64::from(front.is_some())));
        };
        Ok(Image::from_fn(self.camera.size, |UVec2 { x, y }| {
            let quarters = data.u8x4(x, y).map(f64::from);
            quarters.iter().sum::<f64>() / (4.0 * 255.0)
        }))
    }

    /// What is left of every pixel's ray.
    pub(crate) fn exits(&self) -> Result<Image<Option<ExitRay>>, ReportError> {
        let data = self.read(Layers::exits)?;
        let size = self.camera.size;
        Ok(image(size, &data, |data, pixel| {
            ExitRay::unpack(data.u32x4(pixel.x, pixel.y))
        }))
    }

    /// Radiance and transmission where there is liquid.
    pub(crate) fn light(&self) -> Result<[Image<Option<DVec3>>; 2], ReportError> {
        let size = self.camera.size;
        let exits = self.exits()?;
        let radiance = self.read(Layers::radiance)?;
        let transmission = self.read(Layers::transmission)?;
        let there = |pixel: UVec2| exits.get(pixel).is_some();
        let light = image(size, &radiance, |data, pixel| {
            let [r, g, b, _] = data.f16x4(pixel.x, pixel.y);
            there(pixel).then(|| vec3(r, g, b).as_dvec3())
        });
        // Red is the radiance's alpha.
        let passed = image(size, &transmission, |data, pixel| {
            let [.., r] = radiance.as_ref()?.f16x4(pixel.x, pixel.y);
            let halves: [u16; 2] = data.texel(pixel.x, pixel.y);
            let [g, b] = halves.map(|half| f16::from_bits(half).to_f32());
            there(pixel).then(|| vec3(r, g, b).as_dvec3())
        });
        Ok([light, passed])
    }

    /// The picture, sRGB-encoded in 0..=1.
    pub(crate) fn picture(&mut self) -> Result<Image<DVec3>, ReportError> {
        let picture = capture(&mut self.app)?;
        Ok(Image::from_fn(self.camera.size, |pixel| {
            let [r, g, b, _] = picture.get_pixel(pixel.x, pixel.y).0;
            DVec3::from([r, g, b].map(f64::from)) / 255.0
        }))
    }

    /// Has rays traced through these layers instead of the bulk's own, or no longer.
    pub(crate) fn put_exact_layers(&mut self, spans: Option<&Image<Option<Span>>>) {
        let exact = spans.map(|spans| self.exact_layers(spans));
        let Some(render) = self.app.get_sub_app_mut(RenderApp) else {
            return;
        };
        match exact {
            Some(exact) => render.insert_resource(exact),
            None => {
                render.world_mut().remove_resource::<ExactLayers>();
                render
            }
        };
    }

    fn exact_layers(&self, spans: &Image<Option<Span>>) -> ExactLayers {
        let view_from_world = self.camera.view_from_world();
        let code = |normal: DVec3| {
            let view = view_from_world.transform_vector3(normal);
            encode_normal(view.as_vec3()).map(f16::from_f32)
        };
        let depths: Vec<[f32; 2]> = spans
            .pixels()
            .iter()
            .map(|span| match span {
                Some(span) => [
                    span.front.device_depth as f32,
                    -span.back.device_depth as f32,
                ],
                None => [0.0, -2.0],
            })
            .collect();
        let normals: Vec<[f16; 4]> = spans
            .pixels()
            .iter()
            .map(|span| {
                let Some(span) = span else {
                    return [f16::ZERO; 4];
                };
                let [a, b] = code(span.front.normal);
                let [c, d] = code(-span.back.normal);
                [a, b, c, d]
            })
            .collect();
        let texture = |pick: fn(&Layers) -> Option<&Texture>, bytes: &[u8]| {
            let format = self.layers().and_then(pick).map(|it| it.format());
            let world = self.app.world();
            world.resource::<RenderDevice>().create_texture_with_data(
                world.resource::<RenderQueue>(),
                &TextureDescriptor {
                    label: Some("exact_layers"),
                    size: Extent3d {
                        width: spans.size().x,
                        height: spans.size().y,
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: TextureDimension::D2,
                    format: format.expect("the liquid is in view"),
                    usage: TextureUsages::COPY_SRC,
                    view_formats: &[],
                },
                TextureDataOrder::default(),
                bytes,
            )
        };
        let halves: Vec<[u16; 4]> = normals.iter().map(|n| n.map(f16::to_bits)).collect();
        ExactLayers {
            layers: texture(Layers::bulk, bytemuck::cast_slice(&depths)),
            normals: texture(Layers::bulk_normals, bytemuck::cast_slice(&halves)),
        }
    }
}

/// Every texel's value; none without a texture.
fn image<T: Send>(
    size: UVec2,
    data: &Option<TextureData>,
    value: impl Fn(&TextureData, UVec2) -> Option<T> + Sync,
) -> Image<Option<T>> {
    Image::from_fn(size, |pixel| value(data.as_ref()?, pixel))
}

fn transform(camera: &fluid_reference::Camera) -> Transform {
    Transform::from_matrix(Mat4::from(camera.world_from_view.as_affine3a()))
}

fn projection(lens: Lens) -> Projection {
    match lens {
        Lens::Perspective { fov, near } => Projection::Perspective(PerspectiveProjection {
            fov: fov as f32,
            near: near as f32,
            near_clip_plane: vec4(0.0, 0.0, -1.0, -near as f32),
            ..default()
        }),
        Lens::Orthographic { height, near, far } => {
            Projection::Orthographic(OrthographicProjection {
                near: near as f32,
                far: far as f32,
                scaling_mode: bevy::camera::ScalingMode::FixedVertical {
                    viewport_height: height as f32,
                },
                ..OrthographicProjection::default_3d()
            })
        }
    }
}

/// Layers that take the place of the bulk's, in the render world.
#[derive(Resource)]
struct ExactLayers {
    layers: Texture,
    normals: Texture,
}

fn put_exact_layers(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<&Layers>,
    exact: Option<Res<ExactLayers>>,
    mut ctx: RenderContext,
) {
    let Some(exact) = exact else {
        return;
    };
    for layers in surfaces.iter_many(&view.into_inner().surfaces) {
        for (from, to) in [
            (&exact.layers, layers.bulk()),
            (&exact.normals, layers.bulk_normals()),
        ] {
            let Some(to) = to else {
                continue;
            };
            // The part of the view that the textures hold.
            let view = ivec2(from.width() as i32, from.height() as i32);
            let min = layers.origin().max(IVec2::ZERO);
            let max = (layers.origin() + layers.size().as_ivec2()).min(view);
            let mut source = from.as_image_copy();
            (source.origin.x, source.origin.y) = (min.x as u32, min.y as u32);
            let mut target = to.as_image_copy();
            let at = (min - layers.origin()).as_uvec2();
            (target.origin.x, target.origin.y) = (at.x, at.y);
            let size = (max - min).as_uvec2();
            ctx.command_encoder().copy_texture_to_texture(
                source,
                target,
                Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: 1,
                },
            );
        }
    }
}
