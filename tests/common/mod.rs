//! Headless scenes for the GPU tests, and what their layers hold.

#![allow(dead_code, unused_imports, reason = "each test file uses a part")]

pub(crate) mod against;
pub(crate) mod exit;
pub(crate) mod geometry;
mod matrix_projection;
pub(crate) mod sound;

#[path = "../../src/shape/oracle.rs"]
pub(crate) mod oracle;

use bevy::{
    camera::{Hdr, ScalingMode},
    core_pipeline::tonemapping::Tonemapping,
    prelude::*,
    render::{
        RenderApp,
        render_resource::{Texture, TextureFormat},
    },
};
use bevy_fluid::{
    prelude::*,
    render::{Layers, Surface, ViewSurfaces},
    settings::{Antialiasing, Fresnel, Refractions, Search, Smoothing},
};
use fluid_stage::{TextureData, headless_app, read_texture};

pub(crate) use fluid_stage::settle;

pub(crate) use against::{INSIDE, NOTHING, assert_layers, compare_layers, union};
pub(crate) use exit::Exit;
pub(crate) use geometry::{Ellipsoid, Ray, angle, decode_normal};
pub(crate) use oracle::{Random, lattice};
pub(crate) use sound::assert_sound;

/// Every particle is a sphere of its radius, in the bulk.
pub(crate) const BULK: SurfaceKernel = SurfaceKernel {
    neighbor_radius: 4.0,
    spray_threshold: 0,
    anisotropic: false,
    center_shift: 0.0,
    surface_offset: 0.0,
    max_ratio: 1.0,
    radius_scale: 1.0,
    sphere_neighbors: 0,
    full_neighbors: 0,
    skip_interior: false,
};

/// Every particle is a sphere of its radius, in the spray.
pub(crate) const SPRAY: SurfaceKernel = SurfaceKernel {
    spray_threshold: u32::MAX,
    ..BULK
};

/// Layers as they are splatted, and the least work beyond them.
pub(crate) const RAW: ScreenSpaceFluid = ScreenSpaceFluid {
    smoothing: Smoothing::None,
    refractions: Refractions::Zero,
    search: Search::BRACKETED,
    fresnel: Fresnel::Exact,
    contact: 0.0,
    antialiasing: Antialiasing::None,
};

/// A camera's view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) size: UVec2,
    pub(crate) lens: Lens,
    pub(crate) pose: Transform,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Lens {
    Perspective {
        fov: f32,
        near: f32,
    },
    Orthographic {
        height: f32,
        near: f32,
        far: f32,
    },
    /// Clip from view, whatever it is.
    Matrix(Mat4),
}

impl View {
    /// From the origin along −z.
    pub(crate) const fn new(side: u32, lens: Lens) -> Self {
        Self {
            size: UVec2::splat(side),
            lens,
            pose: Transform::IDENTITY,
        }
    }

    pub(crate) fn projection(&self) -> Projection {
        match self.lens {
            Lens::Perspective { fov, near } => Projection::Perspective(PerspectiveProjection {
                fov,
                near,
                near_clip_plane: vec4(0.0, 0.0, -1.0, -near),
                ..default()
            }),
            Lens::Orthographic { height, near, far } => {
                Projection::Orthographic(OrthographicProjection {
                    near,
                    far,
                    scaling_mode: ScalingMode::FixedVertical {
                        viewport_height: height,
                    },
                    ..OrthographicProjection::default_3d()
                })
            }
            Lens::Matrix(clip_from_view) => {
                Projection::custom(matrix_projection::Fixed(clip_from_view))
            }
        }
    }

    /// A camera that draws fluids, over black.
    pub(crate) fn camera(&self, settings: ScreenSpaceFluid) -> impl Bundle {
        (self.plain_camera(), settings)
    }

    /// The same camera without fluids.
    pub(crate) fn plain_camera(&self) -> impl Bundle {
        (
            Camera3d::default(),
            Camera {
                clear_color: ClearColorConfig::Custom(Color::BLACK),
                ..default()
            },
            Hdr,
            Msaa::Off,
            Tonemapping::None,
            self.projection(),
            self.pose,
        )
    }
}

/// An app that shows `scene` in this view, its pipelines compiled.
pub(crate) fn show(view: &View, settings: ScreenSpaceFluid, scene: impl FnOnce(&mut World)) -> App {
    show_with(FluidPlugin::default(), view, settings, scene)
}

/// The same with a plugin that is not the default.
pub(crate) fn show_with(
    plugin: FluidPlugin,
    view: &View,
    settings: ScreenSpaceFluid,
    scene: impl FnOnce(&mut World),
) -> App {
    let mut app = headless_app(view.size, |app| {
        app.add_plugins(plugin);
        app.world_mut().spawn(view.camera(settings));
        scene(app.world_mut());
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

/// The only entity with a component.
pub(crate) fn only<C: Component>(app: &mut App) -> Entity {
    let world = app.world_mut();
    world
        .query_filtered::<Entity, With<C>>()
        .single(world)
        .unwrap()
}

/// Gives the only camera other components, and settles.
pub(crate) fn look(app: &mut App, bundle: impl Bundle) {
    let camera = only::<Camera3d>(app);
    app.world_mut().entity_mut(camera).insert(bundle);
    settle(app).unwrap();
}

/// Puts one fluid in place of all others, and settles.
pub(crate) fn pour(app: &mut App, fluid: impl Bundle) {
    let world = app.world_mut();
    let old: Vec<_> = world
        .query_filtered::<Entity, With<FluidParticles>>()
        .iter(world)
        .collect();
    for fluid in old {
        world.despawn(fluid);
    }
    world.spawn(fluid);
    settle(app).unwrap();
}

/// A fluid of water that absorbs nothing.
pub(crate) fn fluid(positions: &[Vec3], radius: f32, kernel: SurfaceKernel) -> impl Bundle + use<> {
    (
        FluidParticles::new(positions.to_vec(), radius),
        kernel,
        FluidMaterial::CLEAR_WATER,
    )
}

/// An opaque box.
pub(crate) fn spawn_box(world: &mut World, size: Vec3, transform: Transform) -> Entity {
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::from_size(size));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            base_color: Color::srgb(0.2, 0.5, 0.3),
            unlit: true,
            ..default()
        });
    world
        .spawn((Mesh3d(mesh), MeshMaterial3d(material), transform))
        .id()
}

/// What the first view that sees liquid holds of it.
pub(crate) fn view_surfaces(app: &App) -> Option<&ViewSurfaces> {
    app.sub_app(RenderApp)
        .world()
        .iter_entities()
        .find_map(|entity| entity.get::<ViewSurfaces>())
}

/// The surfaces of the first view that sees liquid, from far to near.
pub(crate) fn surfaces(app: &App) -> Vec<(&Surface, &Layers)> {
    let world = app.sub_app(RenderApp).world();
    let view = view_surfaces(app).expect("liquid is in view");
    let surfaces = view.surfaces.iter().map(|&surface| {
        let surface = world.entity(surface);
        (surface.get().unwrap(), surface.get().unwrap())
    });
    surfaces.collect()
}

/// The only surface in view.
pub(crate) fn surface(app: &App) -> (&Surface, &Layers) {
    let [surface] = surfaces(app)[..] else {
        panic!("one surface is in view");
    };
    surface
}

/// One of the only surface's textures, as large as the view: `read(&app, Layers::bulk)`. What it
/// lacks is "nothing"; radiance and transmission are whole, and have an alpha of 1 where there is
/// liquid.
pub(crate) fn read(app: &App, pick: fn(&Layers) -> Option<&Texture>) -> TextureData {
    let (_, layers) = surface(app);
    let size = view_surfaces(app).unwrap().viewport().size();
    let placed = |texture: Option<&Texture>| {
        let data = read_texture(app, texture.expect("it has one")).unwrap();
        let no_layers = bytemuck::cast_slice(&[0.0_f32, -2.0]);
        let nothing = match data.format {
            TextureFormat::Rg32Float => no_layers,
            _ => &[0; 16],
        };
        data.placed(layers.origin(), size, nothing)
    };
    let id = |texture: Option<&Texture>| texture.map(Texture::id);
    let is = |other: fn(&Layers) -> Option<&Texture>| id(pick(layers)) == id(other(layers));
    let mut data = placed(pick(layers));
    if is(Layers::radiance) || is(Layers::transmission) {
        let [radiance, transmission, exits] =
            [layers.radiance(), layers.transmission(), layers.exits()].map(placed);
        let texels = pixels(size).flat_map(|UVec2 { x, y }| {
            let [r, g, b, red]: [u16; 4] = radiance.texel(x, y);
            let [green, blue]: [u16; 2] = transmission.texel(x, y);
            let there = half::f16::from_f32((exits.u32x4(x, y)[3] >> 31) as f32).to_bits();
            if is(Layers::radiance) {
                [r, g, b, there]
            } else {
                [red, green, blue, there]
            }
        });
        data.bytes = texels.flat_map(u16::to_le_bytes).collect();
        data.format = TextureFormat::Rgba16Float;
    }
    data
}

/// All pixels of a texture.
pub(crate) fn pixels(size: UVec2) -> impl Iterator<Item = UVec2> {
    (0..size.y).flat_map(move |y| (0..size.x).map(move |x| uvec2(x, y)))
}

/// A thin disc, `half_width` in radius, whose normal is +z before `rotation`: flat to within its
/// thickness. It is one particle of the
/// bulk, in a fluid scaled to almost nothing along z.
pub(crate) fn plate(half_width: f32, center: Vec3, rotation: Quat) -> impl Bundle + use<> {
    (
        fluid(&[Vec3::ZERO], 1.0, BULK),
        plate_transform(half_width, center, rotation),
    )
}

/// The transform that makes the unit sphere a [`plate`].
pub(crate) fn plate_transform(half_width: f32, center: Vec3, rotation: Quat) -> Transform {
    Transform {
        translation: center,
        rotation,
        scale: vec3(half_width, half_width, PLATE_THICKNESS),
    }
}

/// Half of the thickness of a [`plate`].
pub(crate) const PLATE_THICKNESS: f32 = 1e-4;
