//! Values that are invalid.

use bevy_fluid::{emitter::EmitterBounds, solid::SolidShape};

use super::*;

type Emitter = ParticleEmitter;

const EMITTER_FIELDS: [(&str, fn(&mut Emitter, f32)); 11] = [
    ("rate", |e, v| e.rate = v),
    ("speed", |e, v| e.speed = v),
    ("cone_half_angle", |e, v| e.cone_half_angle = v),
    ("nozzle_radius", |e, v| e.nozzle_radius = v),
    ("jitter", |e, v| e.jitter = v),
    ("particle_radius", |e, v| e.particle_radius = v),
    ("lifetime", |e, v| e.lifetime = v),
    ("gravity.x", |e, v| e.gravity.x = v),
    ("gravity.y", |e, v| e.gravity.y = v),
    ("gravity.z", |e, v| e.gravity.z = v),
    ("drag", |e, v| e.drag = v),
];

const SHAPES: [(&str, fn(f32) -> SolidShape); 8] = [
    ("shape.radius", |radius| SolidShape::Sphere { radius }),
    ("shape.half_size.x", |v| SolidShape::Cuboid {
        half_size: vec3(v, 1.0, 1.0),
    }),
    ("shape.half_size.y", |v| SolidShape::Cuboid {
        half_size: vec3(1.0, v, 1.0),
    }),
    ("shape.half_size.z", |v| SolidShape::Cuboid {
        half_size: vec3(1.0, 1.0, v),
    }),
    ("shape.radius", |radius| SolidShape::Capsule {
        radius,
        half_length: 1.0,
    }),
    ("shape.half_length", |half_length| SolidShape::Capsule {
        radius: 1.0,
        half_length,
    }),
    ("shape.radius", |radius| SolidShape::Cylinder {
        radius,
        half_height: 1.0,
    }),
    ("shape.half_height", |half_height| SolidShape::Cylinder {
        radius: 1.0,
        half_height,
    }),
];

#[test]
fn presets_and_defaults_make_sense() {
    for emitter in [
        Emitter::DEFAULT,
        Emitter::JET,
        Emitter::FOUNTAIN,
        Emitter::SHOWER,
        Emitter::SPRAY,
        Emitter::DRIP,
        Emitter::jet(1e4, 20.0),
        Emitter::fountain(1e4, 20.0),
        Emitter::shower(1e4, 2.0),
        Emitter::bursts(3.0),
        EXACT,
    ] {
        assert_eq!(emitter.validate(), Ok(()));
        assert_eq!(emitter.clamped(), emitter);
    }
    assert_eq!(ParticleCollider::ground().validate(), Ok(()));
}

#[test]
fn bad_fields_are_named_and_clamped() {
    for (field, set) in EMITTER_FIELDS {
        for value in [-1e9, f32::NAN, f32::NEG_INFINITY] {
            let mut bad = Emitter::DEFAULT;
            set(&mut bad, value);
            let error = bad.validate().unwrap_err().to_string();
            let named = format!("`ParticleEmitter::{field}` is {value};");
            assert!(error.starts_with(&named), "{error}");
            assert_eq!(bad.clamped().validate(), Ok(()));
        }
    }
    for (field, shape) in SHAPES {
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            let bad = ParticleCollider::from(shape(value));
            let error = bad.validate().unwrap_err().to_string();
            let named = format!("`ParticleCollider::{field}` is {value};");
            assert!(error.starts_with(&named), "{error}");
            assert_eq!(bad.clamped().validate(), Ok(()));
        }
    }
    let bad = Emitter {
        capacity: u32::MAX,
        ..default()
    };
    let error = bad.validate().unwrap_err();
    assert_eq!(error.name, "ParticleEmitter::capacity");
    assert_eq!(error.value, u32::MAX.to_string());
    assert_eq!(bad.clamped().capacity, 10_000_000);
    let upside_down = EmitterBounds {
        min: Vec3::ONE,
        max: Vec3::ZERO,
    };
    let bad = Emitter {
        bounds: Some(upside_down),
        ..default()
    };
    let error = bad.validate().unwrap_err();
    assert_eq!(error.name, "ParticleEmitter::bounds");
    assert_eq!(bad.clamped(), Emitter::DEFAULT);
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        let bad = Emitter {
            direction,
            ..default()
        };
        let error = bad.validate().unwrap_err();
        assert_eq!(error.name, "ParticleEmitter::direction");
        assert_eq!(bad.clamped(), Emitter::DEFAULT);
    }
}

#[test]
fn bad_values_are_said_once_and_all_goes_on() {
    let (mut app, entity) = emitting(EXACT);
    let ground = app.world_mut().spawn(ParticleCollider::ground()).id();
    let fields =
        EMITTER_FIELDS.map(|(field, _)| format!("entity {entity}: `ParticleEmitter::{field}`"));
    for (named, (_, set)) in fields.iter().zip(EMITTER_FIELDS) {
        for value in [f32::NAN, -1e9, f32::NEG_INFINITY] {
            set(&mut emitter(&mut app, entity), value);
            run(&mut app, 0.1, 30.0);
        }
        *emitter(&mut app, entity) = EXACT;
        step(&mut app, 0.01);
        assert_eq!(log::count(named), 1, "{named}");
    }
    let mut collider = app.world_mut().get_mut::<ParticleCollider>(ground).unwrap();
    collider.restitution = 7.5;
    run(&mut app, 0.5, 30.0);
    let named = format!("entity {ground}: `ParticleCollider::restitution` is 7.5");
    assert_eq!(log::count(&named), 1);
    assert!(!particles(&app, entity).is_empty());
    for (place, velocity) in drawn(&app, entity)
        .iter()
        .zip(particles(&app, entity).velocities())
    {
        assert!(place.is_finite() && velocity.is_finite());
    }
}

#[test]
fn a_transform_without_an_inverse_is_said_once() {
    let (mut app, entity) = emitting(EXACT);
    run(&mut app, 0.2, 30.0);
    for scale in [Vec3::ZERO, vec3(1.0, 0.0, 1.0)] {
        place(&mut app, entity).scale = scale;
        run(&mut app, 0.2, 30.0);
        assert!(drawn(&app, entity).is_empty());
    }
    assert_eq!(
        log::count(&format!("emitter {entity}: its `GlobalTransform`")),
        1
    );
    place(&mut app, entity).scale = Vec3::ONE;
    run(&mut app, 0.2, 30.0);
    assert!(drawn(&app, entity).len() >= 190);
    assert!(drawn(&app, entity).iter().all(|p| p.is_finite()));
    // A collider of no size and one of no place.
    for transform in [
        Transform::from_scale(Vec3::ZERO),
        Transform::from_translation(Vec3::NAN),
    ] {
        app.world_mut()
            .spawn((ParticleCollider::from(Sphere::new(1.0)), transform));
        run(&mut app, 0.2, 30.0);
        assert!(drawn(&app, entity).iter().all(|p| p.is_finite()));
    }
}

#[test]
fn the_fluid_has_the_emitters_radius() {
    let (mut app, entity) = emitting(EXACT);
    step(&mut app, 0.01);
    let radius = |app: &App| app.world().get::<FluidParticles>(entity).unwrap().radius;
    assert_eq!(radius(&app), EXACT.particle_radius);
    emitter(&mut app, entity).particle_radius = 0.1;
    step(&mut app, 0.0);
    assert_eq!(radius(&app), 0.1);
}

#[test]
fn an_emitter_that_is_put_back_is_told_again() {
    let mut app = app();
    // The log is that of all tests: an entity that no other is called like.
    let entity = (0..1000).map(|_| app.world_mut().spawn_empty().id()).last();
    let entity = app.world_mut().entity_mut(entity.unwrap());
    let entity = { entity }.insert(EXACT).remove::<SurfaceKernel>().id();
    run(&mut app, 0.1, 30.0);
    place(&mut app, entity).scale = Vec3::ZERO;
    let said = || log::count(&format!("emitter {entity}: its `GlobalTransform`"));
    step(&mut app, 0.1);
    step(&mut app, 0.1);
    assert_eq!(said(), 1);
    let mut fluid = app.world_mut().entity_mut(entity);
    fluid.remove::<ParticleEmitter>();
    step(&mut app, 0.1);
    let mut fluid = app.world_mut().entity_mut(entity);
    fluid.insert((EXACT, FluidParticles::new(vec![Vec3::ZERO], 0.02)));
    step(&mut app, 0.1);
    assert_eq!(said(), 2);
}
