//! h44 and h47: transforms of cameras, lights and fluids that are more than a place.

use bevy::prelude::*;
use bevy_fluid::{prelude::*, render::Layers};

use super::*;

fn particles() -> Vec<Vec3> {
    let block = lattice(6, 0.2, 0.2);
    let shifted = block.iter().map(|p| p + vec3(-0.5, -0.5, -5.5));
    shifted.chain([vec3(0.6, 0.8, -4.5)]).collect()
}

fn lit(world: &mut World, light: Transform) {
    walls(world);
    let mut material = FluidMaterial::INK;
    // Highlights as wide as can be: every direction counts.
    material.perceptual_roughness = 0.6;
    world.spawn((FluidParticles::new(particles(), 0.1), material));
    let sun = DirectionalLight {
        illuminance: 20_000.0,
        ..default()
    };
    world.spawn((sun, light));
}

#[test]
fn h44_directions_that_are_not_of_unit_length() {
    let view = View::new(64, PERSPECTIVE);
    let light = Transform::default().looking_to(vec3(-0.4, -1.0, -0.6), Vec3::Y);
    let mut app = show(&view, ScreenSpaceFluid::default(), |world| {
        lit(world, light);
    });
    let straight = picture(&mut app);
    // A light that is scaled.
    let lights = [
        light.with_scale(Vec3::splat(7.0)),
        light.with_scale(vec3(0.1, 3.0, 0.5)),
    ];
    let sun = only::<DirectionalLight>(&mut app);
    for stretched in lights {
        app.world_mut().entity_mut(sun).insert(stretched);
        settle(&mut app).unwrap();
        let changed = differing(&picture(&mut app), &straight, 1);
        assert_eq!(changed, 0, "{stretched:?}");
    }
    app.world_mut().entity_mut(sun).insert(light);
    // A camera that is scaled: view space has other metres than the world.
    for scale in [0.25, 3.0] {
        look(&mut app, view.pose.with_scale(Vec3::splat(scale)));
        let changed = differing(&picture(&mut app), &straight, 2);
        assert!(changed <= 4, "a camera scaled by {scale}: {changed} pixels");
    }
}

#[test]
fn h47_scaled_and_mirrored_fluids() {
    let view = View::new(64, PERSPECTIVE);
    let mut app = show(&view, RAW, |_| {});
    let mut random = Random(2);
    let positions: Vec<_> = (0..12).map(|_| 2.0 * random.point() - 1.0).collect();
    let turn = Quat::from_euler(EulerRot::XYZ, 0.4, 0.9, -0.3);
    for scale in [
        vec3(1.6, 0.3, 0.9),
        vec3(-1.0, 1.0, 1.0),
        vec3(-0.7, -1.2, -0.4),
        vec3(1.0, -0.2, 1.0),
    ] {
        let place = Transform {
            translation: vec3(0.0, 0.1, -5.0),
            rotation: turn,
            scale,
        };
        for (kernel, layers, normals) in [
            (BULK, Layers::bulk as LayerOf, None),
            (SPRAY, Layers::spray, Some(Layers::spray_normals as LayerOf)),
        ] {
            pour(&mut app, (fluid(&positions, 0.4, kernel), place));
            assert_sound(&app);
            let bodies: Vec<_> = positions
                .iter()
                .map(|&p| Ellipsoid::new(&view, &place, p, 0.4))
                .collect();
            let layers = read(&app, layers);
            assert_layers(&view, &layers, &bodies, 1e-3);
            let Some(normals) = normals.map(|normals| read(&app, normals)) else {
                continue;
            };
            let mut seen = 0;
            for pixel in pixels(view.size) {
                let ray = view.ray(View::center(pixel));
                let mut fronts: Vec<_> = bodies
                    .iter()
                    .filter_map(|body| Some((body.crossings(&ray)?[0], body)))
                    .collect();
                fronts.sort_by(|a, b| a.0.total_cmp(&b.0));
                let Some(&(t, body)) = fronts.first() else {
                    continue;
                };
                // Where two meet, rounding decides whose normal it is.
                if fronts.get(1).is_some_and(|next| next.0 - t < 1e-3) {
                    continue;
                }
                let normal = body.normal(ray.at(t));
                // At the silhouette it turns by degrees a pixel.
                if normal.dot(ray.direction) > -0.3 {
                    continue;
                }
                seen += 1;
                let [x, y, ..] = normals.f16x4(pixel.x, pixel.y);
                let off = angle(decode_normal([x, y]), normal);
                assert!(off < 0.5, "{scale}, {pixel}: {off}°");
            }
            assert!(seen > 50, "{scale}: {seen}");
        }
    }
    // No extent, or no place at all: nothing is drawn, and nothing else is harmed.
    let empty = {
        pour(&mut app, fluid(&[], 0.4, SPRAY));
        picture(&mut app)
    };
    for place in [
        Transform::from_xyz(0.0, 0.0, -5.0).with_scale(Vec3::ZERO),
        Transform::from_xyz(0.0, 0.0, -5.0).with_scale(vec3(1.0, 0.0, 1.0)),
        Transform::from_translation(Vec3::NAN),
        Transform::from_xyz(0.0, 0.0, -5.0).with_scale(Vec3::splat(f32::INFINITY)),
    ] {
        for settings in [RAW, ScreenSpaceFluid::default()] {
            look(&mut app, settings);
            pour(&mut app, (fluid(&positions, 0.4, SPRAY), place));
            assert!(picture(&mut app) == empty, "{place:?}");
        }
    }
}
