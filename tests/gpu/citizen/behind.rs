//! Glass, transparent objects and rain behind, around and before liquid.

use super::*;
use bevy::{
    core_pipeline::{oit::OrderIndependentTransparencySettings, prepass::DepthPrepass},
    render::occlusion_culling::OcclusionCulling,
};

const PANE: Vec3 = vec3(2.0, 2.0, 0.02);

#[test]
fn ink_is_seen_through_glass() {
    let mut open = scene(Color::WHITE, FluidMaterial::INK, |_, _| {});
    let mut glazed = scene(Color::WHITE, FluidMaterial::INK, |world, _| {
        paint(world, PANE, glass(), vec3(0.0, 0.0, -2.0));
    });
    let (open, glazed) = (pixel(&mut open, MIDDLE), pixel(&mut glazed, MIDDLE));
    assert!(
        open[0] < 60 && differ(open, glazed) < 40,
        "{open:?} {glazed:?}"
    );
}

#[test]
fn ink_is_seen_in_a_glass_box() {
    let mut app = scene(Color::WHITE, FluidMaterial::INK, |world, _| {
        for z in [-3.6, -2.4] {
            paint(world, vec3(1.2, 1.2, 0.02), glass(), vec3(0.0, 0.0, z));
        }
    });
    let middle = pixel(&mut app, MIDDLE);
    assert!(middle[0] < 60, "{middle:?}");
}

/// A pane whose colour shows through clear water, whether it is glass, blended or opaque.
#[test]
fn a_pane_behind_clear_water_is_seen_through_it() {
    let green = Color::srgb(0.1, 0.9, 0.1);
    let through = |pane: StandardMaterial| {
        let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, _| {
            paint(
                world,
                vec3(9.0, 9.0, 0.1),
                unlit(Color::WHITE),
                vec3(0.0, 0.0, -9.0),
            );
            paint(world, vec3(6.0, 6.0, 0.02), pane, vec3(0.0, 0.0, -5.0));
        });
        pixel(&mut app, MIDDLE)
    };
    let opaque = through(unlit(green));
    let blend = through(blended(green.with_alpha(0.99)));
    let glass = through(StandardMaterial {
        base_color: green,
        ..glass()
    });
    for pane in [opaque, blend, glass] {
        assert!(
            pane[1] > 150 && pane[0] < 150,
            "{opaque:?} {blend:?} {glass:?}"
        );
    }
    assert!(differ(opaque, blend) < 16, "{opaque:?} {blend:?}");
}

#[test]
fn a_pane_before_milk_is_drawn_over_it_once() {
    let middle = |with_pane: bool| {
        let mut app = scene(Color::BLACK, FluidMaterial::MILK, |world, _| {
            if with_pane {
                let red = blended(Color::srgba(1.0, 0.0, 0.0, 0.5));
                paint(world, PANE, red, vec3(0.0, 0.0, -2.0));
            }
        });
        // More frames than one: what was taken out of Bevy's phases is back in them.
        fluid_stage::step(&mut app, 3);
        pixel(&mut app, MIDDLE)
    };
    let (milk, pane) = (middle(false), middle(true));
    assert!(
        pane[0] > 150 && pane[1] < milk[1] / 2 + 60,
        "{milk:?} {pane:?}"
    );
}

/// Also with transparency that is independent of order.
#[test]
fn milk_hides_a_pane_behind_it() {
    let middle = |oit: bool, pane: bool| {
        let mut app = scene(Color::BLACK, FluidMaterial::MILK, |world, camera| {
            world.entity_mut(camera).insert(Msaa::Off);
            if oit {
                let settings = OrderIndependentTransparencySettings::default();
                world.entity_mut(camera).insert(settings);
            }
            if pane {
                let yellow = blended(Color::srgba(1.0, 1.0, 0.0, 0.8));
                paint(world, vec3(0.4, 0.4, 0.02), yellow, vec3(0.0, 0.0, -5.0));
            }
        });
        pixel(&mut app, MIDDLE)
    };
    let milk = middle(false, false);
    for oit in [false, true] {
        let hidden = middle(oit, true);
        assert!(differ(milk, hidden) < 8, "{oit}: {milk:?} {hidden:?}");
    }
}

/// Two equal panes, which Bevy would draw in one batch: one is behind milk, one before it.
#[test]
fn one_of_two_panes_is_behind_milk() {
    let mut app = scene(Color::BLACK, FluidMaterial::MILK, |world, _| {
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Cuboid::new(0.4, 0.4, 0.02));
        let red = blended(Color::srgba(1.0, 0.0, 0.0, 0.5));
        let red = world.resource_mut::<Assets<StandardMaterial>>().add(red);
        for z in [-2.0, -5.0] {
            let at = Transform::from_xyz(0.0, 0.0, z);
            world.spawn((Mesh3d(mesh.clone()), MeshMaterial3d(red.clone()), at));
        }
    });
    let mut milk = scene(Color::BLACK, FluidMaterial::MILK, |_, _| {});
    let milk = pixel(&mut milk, MIDDLE);
    for _ in 0..3 {
        fluid_stage::step(&mut app, 1);
        let seen = pixel(&mut app, MIDDLE);
        assert!(
            seen[0] > milk[1] + 40 && seen[1] < milk[1],
            "{milk:?} {seen:?}"
        );
    }
}

/// A pane between two liquids of which the farther one reaches around it.
#[test]
fn a_pane_within_a_farther_liquid_does_not_come_out_before_it() {
    let middle = |pane: bool| {
        let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, _| {
            let milk = FluidParticles::new(ball(8.0, 0.5), 0.5);
            let at = Transform::from_xyz(0.0, 0.0, -14.0);
            world.spawn((milk, FluidMaterial::MILK, at));
            if pane {
                let red = blended(Color::srgba(1.0, 0.0, 0.0, 0.9));
                paint(world, vec3(9.0, 9.0, 0.02), red, vec3(0.0, 0.0, -14.0));
            }
        });
        pixel(&mut app, MIDDLE)
    };
    let (without, with) = (middle(false), middle(true));
    assert!(differ(without, with) < 8, "{without:?} {with:?}");
}

/// A pane between two liquids is seen through the nearer one, and before the farther one.
#[test]
fn a_pane_between_two_liquids_is_seen_through_the_nearer_one() {
    let middle = |pane: StandardMaterial| {
        let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, _| {
            world.spawn(drop_of(FluidMaterial::MILK, vec3(0.0, 0.0, -9.0)));
            paint(world, vec3(4.0, 4.0, 0.02), pane, vec3(0.0, 0.0, -6.0));
        });
        pixel(&mut app, MIDDLE)
    };
    let green = Color::srgb(0.1, 0.9, 0.1);
    let opaque = middle(unlit(green));
    let blend = middle(blended(green.with_alpha(0.99)));
    assert!(opaque[1] > 150 && opaque[0] < 150, "{opaque:?}");
    assert!(differ(opaque, blend) < 16, "{opaque:?} {blend:?}");
}

/// The eye moves, so that what the last frame hid matters.
#[test]
fn occlusion_culling_keeps_what_is_behind_clear_water() {
    let mut cameras = Vec::new();
    let [mut culled, mut whole] = [true, false].map(|culls| {
        scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, camera| {
            cameras.push(camera);
            world.entity_mut(camera).insert((DepthPrepass, Msaa::Off));
            if culls {
                world.entity_mut(camera).insert(OcclusionCulling);
            }
            let red = unlit(Color::srgb(0.9, 0.1, 0.1));
            paint(world, Vec3::splat(0.8), red, vec3(0.0, 0.0, -6.0));
        })
    });
    for i in 0..6 {
        for (app, camera) in [&mut culled, &mut whole].into_iter().zip(&cameras) {
            let at = Transform::from_xyz(0.01 * i as f32, 0.0, 0.0);
            app.world_mut().entity_mut(*camera).insert(at);
            fluid_stage::step(app, 1);
        }
        let (seen, all) = (pixel(&mut culled, MIDDLE), pixel(&mut whole, MIDDLE));
        assert!(
            all[0] > 100 && differ(seen, all) < 8,
            "frame {i}: {seen:?} {all:?}"
        );
    }
}

/// Rain behind clear water shows through it: bright rain on a black scene.
#[test]
fn rain_behind_clear_water_is_seen_through_it() {
    let light = |rate: f32| {
        let mut app = scene(Color::BLACK, FluidMaterial::CLEAR_WATER, |world, camera| {
            world.entity_mut(camera).insert(bright_rain(rate));
        });
        let picture = capture(&mut app).unwrap();
        let ball = (60..100).flat_map(|x| (45..75).map(move |y| (x, y)));
        let sum: u32 = ball
            .map(|(x, y)| u32::from(picture.get_pixel(x, y).0[1]))
            .sum();
        f64::from(sum) / 1200.0
    };
    let (dry, wet) = (light(0.0), light(100.0));
    assert!(wet > dry + 5.0, "{dry} {wet}");
}
