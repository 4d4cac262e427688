//! Distance fog before liquids, smoke and rain.

use super::*;
use bevy::pbr::{DistanceFog, FogFalloff};

const FOG: Color = Color::srgb(0.6, 0.7, 0.8);

fn fog(falloff: FogFalloff) -> DistanceFog {
    DistanceFog {
        color: FOG,
        falloff,
        ..default()
    }
}

fn falloffs() -> [FogFalloff; 4] {
    [
        FogFalloff::Linear {
            start: 5.0,
            end: 60.0,
        },
        FogFalloff::Exponential { density: 0.03 },
        FogFalloff::ExponentialSquared { density: 0.03 },
        FogFalloff::Atmospheric {
            extinction: vec3(0.01, 0.03, 0.05),
            inscattering: vec3(0.02, 0.01, 0.03),
        },
    ]
}

/// A black ball of liquid beside a black box as far away, under each kind of fog.
#[test]
fn ink_is_fogged_as_a_mesh_is() {
    for falloff in falloffs() {
        let glowing = DistanceFog {
            directional_light_color: Color::srgba(1.0, 0.9, 0.5, 0.002),
            directional_light_exponent: 8.0,
            ..fog(falloff.clone())
        };
        for fog in [fog(falloff.clone()), glowing] {
            let mut app = headless_app(SIZE, |app| {
                app.add_plugins(FluidPlugin::default())
                    .insert_resource(ClearColor(FOG));
                let world = app.world_mut();
                world.spawn((
                    Camera3d::default(),
                    ScreenSpaceFluid::default(),
                    fog.clone(),
                ));
                let black = FluidMaterial {
                    refractive_index: 1.0,
                    ..FluidMaterial::INK
                };
                let ink = FluidParticles::new(ball(5.0, 0.35), 0.35);
                world.spawn((ink, black, Transform::from_xyz(-4.0, 0.0, -30.0)));
                // Its front is as far away as the ball's.
                let black = StandardMaterial {
                    unlit: true,
                    ..Color::BLACK.into()
                };
                paint(world, Vec3::splat(6.0), black, vec3(4.0, 0.0, -28.0));
                world.spawn((
                    DirectionalLight::default(),
                    Transform::default().looking_to(Vec3::Z, Vec3::Y),
                ));
            })
            .unwrap();
            settle(&mut app).unwrap();
            let picture = capture(&mut app).unwrap();
            let [ink, mesh] = [63, 97].map(|x| picture.get_pixel(x, 60).0);
            assert!(mesh[2] > 40, "{mesh:?}");
            assert!(differ(ink, mesh) < 8, "{fog:?}: ink {ink:?}, mesh {mesh:?}");
        }
    }
}

/// Clear water does not add fog of its own to what is fogged already.
#[test]
fn clear_water_in_fog_looks_as_what_is_behind_it() {
    let mut app = headless_app(SIZE, |app| {
        app.add_plugins(FluidPlugin::default())
            .insert_resource(ClearColor(FOG));
        let world = app.world_mut();
        let linear = FogFalloff::Linear {
            start: 5.0,
            end: 100.0,
        };
        world.spawn((
            Camera3d::default(),
            ScreenSpaceFluid::default(),
            fog(linear),
        ));
        let clear = FluidMaterial {
            refractive_index: 1.0,
            ..FluidMaterial::CLEAR_WATER
        };
        let water = FluidParticles::new(ball(5.0, 0.35), 0.35);
        world.spawn((water, clear, Transform::from_xyz(0.0, 0.0, -30.0)));
        paint(
            world,
            vec3(99.0, 99.0, 1.0),
            unlit(Color::BLACK),
            vec3(0.0, 0.0, -60.0),
        );
    })
    .unwrap();
    settle(&mut app).unwrap();
    let picture = capture(&mut app).unwrap();
    let [beside, through] = [10, 80].map(|x| picture.get_pixel(x, 60).0);
    assert!(
        beside[2] > 40 && differ(beside, through) < 6,
        "{beside:?} {through:?}"
    );
}

/// Bright rain, white by itself, has the colour of fog that is denser than it is near.
#[test]
fn rain_is_fogged() {
    let light = |fogged: bool| {
        let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, camera| {
            let mut camera = world.entity_mut(camera);
            camera.insert(bright_rain(100.0));
            if fogged {
                let thick = FogFalloff::Exponential { density: 3.0 };
                camera.insert(DistanceFog {
                    color: Color::srgb(0.0, 0.0, 1.0),
                    falloff: thick,
                    ..default()
                });
            }
        });
        let picture = capture(&mut app).unwrap();
        let corner = || (0..40).flat_map(|x| (0..30).map(move |y| (x, y)));
        [0, 2].map(|channel| {
            let sum: u32 = corner()
                .map(|(x, y)| u32::from(picture.get_pixel(x, y).0[channel]))
                .sum();
            f64::from(sum) / 1200.0
        })
    };
    let ([red, blue], [fogged_red, fogged_blue]) = (light(false), light(true));
    assert!(red > 5.0 && blue < 2.0 * red, "{red} {blue}");
    assert!(
        fogged_blue > 5.0 && fogged_red < 0.2 * fogged_blue,
        "{fogged_red} {fogged_blue}"
    );
}

/// Kilometres away, where the air is blue: a black ball of liquid beside a black box.
#[test]
#[ignore = "lavapipe of Mesa 22 crashes in Bevy's own atmosphere: run it on a GPU"]
fn ink_lies_in_an_atmosphere_as_a_mesh_does() {
    use bevy::{
        light::{Atmosphere, atmosphere::ScatteringMedium},
        pbr::AtmosphereSettings,
    };
    let mut app = headless_app(SIZE, |app| {
        app.add_plugins(FluidPlugin::default())
            .insert_resource(ClearColor(Color::BLACK));
        let world = app.world_mut();
        let medium = ScatteringMedium::earth(256, 256);
        let medium = world.resource_mut::<Assets<ScatteringMedium>>().add(medium);
        world.spawn(Atmosphere::earth(medium));
        let far = Projection::Perspective(PerspectiveProjection {
            far: 1e5,
            ..default()
        });
        world.spawn((
            Camera3d::default(),
            ScreenSpaceFluid::default(),
            AtmosphereSettings::default(),
            Msaa::Off,
            far,
            Transform::from_xyz(0.0, 500.0, 0.0),
        ));
        world.spawn((
            DirectionalLight::default(),
            Transform::default().looking_to(vec3(0.3, -1.0, -0.2), Vec3::Y),
        ));
        let black = FluidMaterial {
            refractive_index: 1.0,
            ..FluidMaterial::INK
        };
        let ink = FluidParticles::new(ball(1000.0, 70.0), 70.0);
        world.spawn((ink, black, Transform::from_xyz(-1200.0, 500.0, -7000.0)));
        let size = Vec3::splat(1200.0);
        paint(
            world,
            size,
            unlit(Color::BLACK),
            vec3(1200.0, 500.0, -6600.0),
        );
    })
    .unwrap();
    settle(&mut app).unwrap();
    let picture = capture(&mut app).unwrap();
    let [ink, mesh] = [55, 105].map(|x| picture.get_pixel(x, 60).0);
    assert!(mesh[2] > 20, "the air is seen: {mesh:?}");
    assert!(differ(ink, mesh) < 10, "ink {ink:?}, mesh {mesh:?}");
}
