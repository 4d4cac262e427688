//! Two materials in view at once, in both orders of depth.

use super::*;

const LIGHT: f32 = 0.5;

/// A puff of fog that hides half of the background along its axis.
fn fog(color: LinearRgba) -> FluidMaterial {
    unbent(Medium::scattering(color, 2.0))
}

fn ball(center: Vec3, material: FluidMaterial) -> impl Bundle {
    (FluidParticles::new(vec![center], 1.0), SPRAY, material)
}

fn lit(scene: impl FnOnce(&mut World)) -> App {
    let mut app = show(&PARALLEL, TRACED, scene);
    furnace(&mut app, LIGHT * white());
    app
}

/// The picture's colour on the axis, linear.
fn on_axis(app: &mut App) -> Vec3 {
    let axis = PARALLEL.size / 2;
    let [r, g, b, _] = capture(app).unwrap().get_pixel(axis.x, axis.y).0;
    Color::srgb_u8(r, g, b).to_linear().to_vec3()
}

#[test]
fn fogs_compose_in_the_order_of_depth() {
    let [red, blue] = [LinearRgba::RED, LinearRgba::BLUE].map(fog);
    for (near, far) in [(red, blue), (blue, red)] {
        let mut app = lit(|world| {
            world.spawn(ball(CENTER - 3.0 * Vec3::Z, far));
            world.spawn(ball(CENTER, near));
        });
        assert_eq!(surfaces(&app).len(), 2);
        let light = Vec3::splat(LIGHT);
        let [sent_near, sent_far] = [near, far].map(|m| m.medium.reflected(2.0, light));
        let [left_near, left_far] = [near, far].map(|m| m.medium.transmitted(2.0));
        let wanted = sent_near + left_near * (sent_far + left_far * light);
        let got = on_axis(&mut app);
        // Eight bits of sRGB.
        assert!(
            (got - wanted).abs().max_element() < 0.004,
            "{got}, not {wanted}"
        );
    }
}

#[test]
fn fogs_within_each_other_are_both_seen() {
    // One ball through another: whichever is painted last, none cuts the other off.
    let mut app = lit(|world| {
        world.spawn(ball(CENTER, fog(LinearRgba::RED)));
        world.spawn(ball(CENTER + vec3(0.1, 0.0, 0.3), fog(LinearRgba::BLUE)));
    });
    let picture = capture(&mut app).unwrap();
    for pixel in pixels(PARALLEL.size) {
        if chord(pixel).is_some_and(|chord| chord > 1.0) && pixel.x > PARALLEL.size.x / 2 {
            let [r, _, b, _] = picture.get_pixel(pixel.x, pixel.y).0;
            assert!(r > 40 && b > 40, "{pixel}: {r} {b}");
        }
    }
}

/// Clear balls of some refractive index, one before the other in front of a wall.
#[test]
fn liquids_are_seen_through_each_other() {
    let dyed = |index, color| FluidMaterial {
        refractive_index: index,
        ..unbent(Medium::absorbing(color, 2.0))
    };
    let honey = dyed(1.49, LinearRgba::rgb(0.9, 0.6, 0.1));
    let water = dyed(1.333, LinearRgba::rgb(0.3, 0.7, 0.9));
    for (near, far) in [(honey, water), (water, honey)] {
        let mut app = lit(|world| {
            world.spawn(ball(CENTER - 2.5 * Vec3::Z, far));
            world.spawn(ball(CENTER, near));
            let wall = world
                .resource_mut::<Assets<StandardMaterial>>()
                .add(StandardMaterial {
                    base_color: Color::WHITE,
                    unlit: true,
                    ..default()
                });
            let mesh = world
                .resource_mut::<Assets<Mesh>>()
                .add(Cuboid::new(20.0, 20.0, 0.1));
            let at = Transform::from_xyz(0.0, 0.0, -9.5);
            world.spawn((Mesh3d(mesh), MeshMaterial3d(wall), at));
        });
        let got = on_axis(&mut app);
        // Straight through both: four interfaces, each with its loss and the light it mirrors.
        let mut wanted = Vec3::ONE;
        for liquid in [far, near] {
            let n = liquid.refractive_index;
            let mirrored = ((n - 1.0) / (n + 1.0)).powi(2);
            let through = |behind: Vec3| mirrored * LIGHT + (1.0 - mirrored) * behind;
            wanted = through(liquid.medium.transmitted(2.0) * through(wanted));
        }
        let error = (got - wanted).abs().max_element();
        assert!(error < 0.02, "{got}, not {wanted}");
    }
}

#[test]
fn smoke_over_a_pool_is_seen_before_it_and_through_it() {
    // A wide, flat pool whose centre is nearer to the eye than the smoke's.
    let pool: Vec<_> = lattice(20, 0.2, 0.1)
        .iter()
        .filter(|p| p.y < 0.5)
        .map(|p| vec3(p.x - 1.9, p.y - 1.2, p.z - 5.0))
        .collect();
    let smoke = vec3(0.0, 0.4, -4.2);
    let scene = |world: &mut World| {
        world.spawn((
            FluidParticles::new(pool.clone(), 0.1),
            FluidMaterial::CLEAR_WATER,
        ));
        let puff = FluidParticles::new(vec![smoke], 0.4);
        world.spawn((puff, SPRAY, fog(LinearRgba::RED)));
    };
    let mut app = lit(scene);
    let order = |app: &App| {
        let surfaces = surfaces(app).into_iter();
        surfaces
            .map(|(surface, _)| surface.plan().unwrap().index_one)
            .collect::<Vec<_>>()
    };
    for (eye, smoke_first) in [(vec3(0.0, 2.5, 0.0), false), (vec3(0.0, -4.0, -2.0), true)] {
        let pose = Transform::from_translation(eye).looking_at(smoke, Vec3::Y);
        look(&mut app, pose);
        assert_eq!(order(&app), [smoke_first, !smoke_first], "seen from {eye}");
        let with = on_axis(&mut app);
        // Red smoke takes green from what is behind it, before the water and behind it.
        let puff = app
            .world_mut()
            .query::<(Entity, &FluidParticles)>()
            .iter(app.world())
            .find(|(_, particles)| particles.positions.len() == 1)
            .map(|(entity, _)| entity)
            .unwrap();
        app.world_mut().entity_mut(puff).insert(Visibility::Hidden);
        settle(&mut app).unwrap();
        let without = on_axis(&mut app);
        app.world_mut()
            .entity_mut(puff)
            .insert(Visibility::Inherited);
        settle(&mut app).unwrap();
        println!("seen from {eye}: {with} with smoke, {without} without");
        assert!(with.y < 0.85 * without.y, "{eye}: {with} {without}");
        assert!(with.x > 0.8 * without.x, "{eye}: {with} {without}");
    }
}
