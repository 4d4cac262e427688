//! Lights of other layers, and more lights than count.

use super::*;
use bevy::camera::RenderTarget;

fn sun(illuminance: f32) -> impl Bundle {
    (
        DirectionalLight {
            illuminance,
            ..default()
        },
        Transform::default().looking_to(vec3(0.2, -0.5, -1.0), Vec3::Y),
    )
}

/// A light of layer 1, which another camera sees: no reason for this one to see it.
#[test]
fn a_light_of_another_layer_does_not_light_milk() {
    let milk = |light: bool, other: bool| {
        let mut app = scene(Color::BLACK, FluidMaterial::MILK, |world, _| {
            if light {
                world.spawn((sun(20_000.0), RenderLayers::layer(1)));
            }
            if other {
                let image = Image::new_target_texture(
                    8,
                    8,
                    bevy::render::render_resource::TextureFormat::Rgba8UnormSrgb,
                    None,
                );
                let image = world.resource_mut::<Assets<Image>>().add(image);
                let layers = RenderLayers::from_layers(&[0, 1]);
                world.spawn((Camera3d::default(), RenderTarget::from(image), layers));
            }
        });
        pixel(&mut app, MIDDLE)
    };
    let dark = milk(false, true);
    assert_eq!(milk(true, false), dark);
    assert_eq!(milk(true, true), dark);
}

#[test]
fn the_brightest_lights_count_rather_than_the_first() {
    let highlight = |dim: usize| {
        let mut app = scene(Color::BLACK, FluidMaterial::INK, |world, _| {
            for _ in 0..dim {
                world.spawn((
                    DirectionalLight {
                        illuminance: 1e-3,
                        ..default()
                    },
                    Transform::default().looking_to(Vec3::Y, Vec3::X),
                ));
            }
            world.spawn(sun(50_000.0));
        });
        let picture = capture(&mut app).unwrap();
        picture.pixels().map(|pixel| pixel.0[1]).max().unwrap()
    };
    let (alone, among) = (highlight(0), highlight(4));
    assert!(alone > 100, "{alone}");
    assert_eq!(among, alone);
}

/// The sibling for rain: a lamp of another layer.
#[test]
fn a_lamp_of_another_layer_does_not_light_rain() {
    let lit = |layer: usize| {
        let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, camera| {
            let rain = Rain {
                rate: 100.0,
                brightness: 30.0,
                ..Rain::HEAVY
            };
            let none = AmbientLight {
                brightness: 0.0,
                ..default()
            };
            world.entity_mut(camera).insert((rain, none));
            let lamp = PointLight {
                intensity: 1e7,
                ..default()
            };
            let at = Transform::from_xyz(0.0, 1.0, -5.0);
            world.spawn((lamp, at, RenderLayers::layer(layer)));
            let layers = RenderLayers::from_layers(&[layer]);
            let image = Image::new_target_texture(
                8,
                8,
                bevy::render::render_resource::TextureFormat::Rgba8UnormSrgb,
                None,
            );
            let image = world.resource_mut::<Assets<Image>>().add(image);
            world.spawn((Camera3d::default(), RenderTarget::from(image), layers));
        });
        let picture = capture(&mut app).unwrap();
        picture
            .pixels()
            .map(|pixel| u32::from(pixel.0[1]))
            .sum::<u32>()
    };
    let (here, elsewhere) = (lit(0), lit(1));
    assert!(here > 10_000 && elsewhere < here / 20, "{here} {elsewhere}");
}

/// The next frame knows of every change.
#[test]
fn a_light_that_changes_is_seen_in_the_next_frame() {
    let mut light = Entity::PLACEHOLDER;
    let mut app = scene(Color::BLACK, FluidMaterial::MILK, |world, _| {
        light = world.spawn(sun(20_000.0)).id();
    });
    let mut now = |change: &dyn Fn(EntityWorldMut)| {
        change(app.world_mut().entity_mut(light));
        fluid_stage::step(&mut app, 1);
        pixel(&mut app, MIDDLE)
    };
    let white = now(&|_| {});
    let recolor = |mut light: EntityWorldMut| {
        light.get_mut::<DirectionalLight>().unwrap().color = Color::srgb(1.0, 0.0, 0.0);
    };
    let red = now(&recolor);
    // Tone mapping lets bright red fade.
    assert!(2 * red[2] < white[2] && red[0] > 60, "{white:?} {red:?}");
    let elsewhere = now(&|mut light| {
        light.insert(RenderLayers::layer(5));
    });
    let hidden = now(&|mut light| {
        light.insert((RenderLayers::layer(0), Visibility::Hidden));
    });
    let back = now(&|mut light| {
        light.insert(Visibility::Inherited);
    });
    let gone = now(&|light| light.despawn());
    assert!(gone[0] < red[0] / 2, "{gone:?}");
    assert_eq!([elsewhere, hidden], [gone; 2]);
    assert_eq!(back, red);
}

/// Lamps light neither milk nor water; where they are must not matter.
#[test]
fn lamps_in_and_on_the_liquid_do_no_harm() {
    let mut app = scene(Color::BLACK, FluidMaterial::MILK, |world, camera| {
        world.entity_mut(camera).insert(Rain::HEAVY);
        for (z, range) in [
            (-2.5, 20.0),
            (-3.0, 20.0),
            (-2.0, 0.0),
            (-2.0, f32::INFINITY),
        ] {
            let lamp = PointLight { range, ..default() };
            world.spawn((lamp, Transform::from_xyz(0.0, 0.0, z)));
        }
    });
    crate::common::assert_sound(&app);
    assert_eq!(pixel(&mut app, MIDDLE)[3], 255);
}
