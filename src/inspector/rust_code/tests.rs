use core::any::TypeId;

use super::*;
use crate::{
    emitter::EmitterBounds,
    prelude::*,
    rain::{Exposure, RainStreakSettings},
    settings::{
        Antialiasing, Bilateral, FluidDebugView, Fresnel, PlaneFit, PlaneFitForm, Refractions,
        Search, Smoothing, Window,
    },
    solid::SolidShape,
};

fn registry() -> TypeRegistry {
    let mut registry = TypeRegistry::new();
    registry.register::<Transform>();
    registry.register::<FluidParticles>();
    registry.register::<ParticleEmitter>();
    registry.register::<ParticleCollider>();
    registry.register::<FluidMaterial>();
    registry.register::<SurfaceKernel>();
    registry.register::<ScreenSpaceFluid>();
    registry.register::<Rain>();
    registry.register::<RainStreakSettings>();
    registry
}

/// The code of a literal is the literal, but for white space, and so it compiles; and the literal
/// is the value.
macro_rules! assert_code {
    ($value:expr, $literal:expr) => {
        let value = $value;
        assert_eq!(value, $literal);
        let code = rust_code(&value, &registry());
        let dense = |text: &str| text.replace(char::is_whitespace, "").replace(",}", "}");
        assert_eq!(dense(&code), dense(stringify!($literal)));
    };
}

#[test]
fn only_what_differs_is_listed() {
    let camera = ScreenSpaceFluid {
        smoothing: Smoothing::PlaneFit(PlaneFit {
            iterations: 3,
            window: Window::Radii(1.0),
            ..PlaneFit::DEFAULT
        }),
        refractions: Refractions::One,
        search: Search::Bracketed { coarse_samples: 8 },
        ..ScreenSpaceFluid::DEFAULT
    };
    let code = "\
ScreenSpaceFluid {
    smoothing: Smoothing::PlaneFit(PlaneFit {
        iterations: 3,
        window: Window::Radii(1.0),
        ..default()
    }),
    refractions: Refractions::One,
    search: Search::Bracketed { coarse_samples: 8 },
    ..default()
}";
    assert_eq!(rust_code(&camera, &registry()), code);
}

#[test]
fn the_code_of_every_kind_of_camera_compiles() {
    assert_code!(ScreenSpaceFluid::DEFAULT, ScreenSpaceFluid::default());
    assert_code!(
        ScreenSpaceFluid::FAST,
        ScreenSpaceFluid {
            refractions: Refractions::One,
            antialiasing: Antialiasing::Edges,
            ..default()
        }
    );
    assert_code!(
        ScreenSpaceFluid::THESIS,
        ScreenSpaceFluid {
            smoothing: Smoothing::PlaneFit(PlaneFit {
                form: PlaneFitForm::TotalLeastSquares,
                iterations: 3,
                window: Window::Pixels,
                ..default()
            }),
            search: Search::Secant,
            fresnel: Fresnel::Schlick,
            contact: 0.0,
            antialiasing: Antialiasing::None,
            ..default()
        }
    );
    assert_code!(
        ScreenSpaceFluid::EARLIER,
        ScreenSpaceFluid {
            smoothing: Smoothing::Bilateral(Bilateral {
                window: Window::Pixels,
                ..default()
            }),
            refractions: Refractions::Two,
            search: Search::Secant,
            fresnel: Fresnel::Schlick,
            contact: 0.0,
            antialiasing: Antialiasing::None,
        }
    );
}

#[test]
fn the_code_of_materials_kernels_and_rain_compiles() {
    assert_code!(
        FluidMaterial::INK,
        FluidMaterial {
            refractive_index: 1.34,
            medium: Medium {
                absorption_density: 12.0,
                absorption_color: LinearRgba::rgb(0.02, 0.25, 0.85),
                ..default()
            },
            ..default()
        }
    );
    assert_code!(
        FluidMaterial::FIRE,
        FluidMaterial {
            refractive_index: 1.0,
            medium: Medium {
                absorption_density: 0.5,
                absorption_color: LinearRgba::rgb(0.0, 0.0, 0.0),
                emission: LinearRgba::rgb(25000.0, 5500.0, 500.0),
                ..default()
            },
            thickness: Thickness::Accumulated { softness: 1.0 },
            ..default()
        }
    );
    assert_code!(
        SurfaceKernel::EARLIER,
        SurfaceKernel {
            spray_threshold: 0,
            anisotropic: false,
            skip_interior: false,
            ..default()
        }
    );
    assert_code!(
        Rain {
            wind: Vec2::new(-2.5, 1e-9),
            ..Rain::HEAVY
        },
        Rain {
            rate: 20.0,
            wind: vec2(-2.5, 1e-9),
            ..default()
        }
    );
    assert_code!(
        RainStreakSettings {
            exposure: Exposure::Seconds(0.02),
            seed: u64::MAX,
            ..RainStreakSettings::default()
        },
        RainStreakSettings {
            exposure: Exposure::Seconds(0.02),
            seed: 18446744073709551615,
            ..default()
        }
    );
}

#[test]
fn long_lists_are_left_to_the_default() {
    let particles = FluidParticles::new(vec![Vec3::ONE; 100], 0.05);
    let code = "\
FluidParticles {
    // positions: 100 of them
    radius: 0.05,
    ..default()
}";
    assert_eq!(rust_code(&particles, &registry()), code);
    let two = FluidParticles::new(vec![Vec3::ONE, Vec3::ZERO], 0.05);
    let code = "\
FluidParticles {
    positions: vec![vec3(1.0, 1.0, 1.0), vec3(0.0, 0.0, 0.0)],
    radius: 0.05,
    ..default()
}";
    assert_eq!(rust_code(&two, &registry()), code);
}

#[test]
fn structs_without_a_default_list_everything_and_options_are_written_out() {
    #[derive(Reflect, Debug, PartialEq)]
    struct Plain {
        name: String,
        some: Option<f32>,
        none: Option<u32>,
        pair: (i32, bool),
        edges: [f32; 3],
    }
    assert_code!(
        Plain {
            name: "a \"b\"".into(),
            some: Some(-0.5),
            none: None,
            pair: (-3, true),
            edges: [1.0, f32::INFINITY, -1e30],
        },
        Plain {
            name: String::from("a \"b\""),
            some: Some(-0.5),
            none: None,
            pair: (-3, true),
            edges: [1.0, f32::INFINITY, -1e30],
        }
    );
}

/// The code of what a system spawns is that system's, and so it compiles and spawns the same.
macro_rules! assert_spawns {
    ($commands:ident => $($statement:tt)*) => {
        fn setup(mut $commands: Commands) {
            $($statement)*
        }
        let registry = registry();
        let mut world = World::new();
        world.run_system_cached(setup).unwrap();
        let shown = [
            TypeId::of::<ScreenSpaceFluid>(),
            TypeId::of::<FluidMaterial>(),
            TypeId::of::<SurfaceKernel>(),
            TypeId::of::<FluidParticles>(),
            TypeId::of::<ParticleEmitter>(),
            TypeId::of::<ParticleCollider>(),
            TypeId::of::<RainStreakSettings>(),
        ];
        let mut entities = world.query::<EntityRef>();
        let is_shown = |entity: &EntityRef| {
            let ids = shown.iter().filter_map(|id| world.components().get_id(*id));
            ids.into_iter().any(|id| entity.contains_id(id))
        };
        let code: Vec<_> = entities
            .iter(&world)
            .filter(is_shown)
            .map(|entity| spawn_code(entity, &shown, &registry))
            .collect();
        let dense = |text: &str| {
            let text = text.replace(char::is_whitespace, "");
            text.replace(",}", "}").replace(",)", ")")
        };
        assert_eq!(dense(&code.concat()), dense(stringify!($($statement)*)));
    };
}

#[test]
fn the_code_of_an_entity_is_the_sum_of_its_parts() {
    let registry = registry();
    let mut world = World::new();
    let (material, emitter) = (FluidMaterial::INK, ParticleEmitter::jet(10.0, 2.0));
    let tap = world.spawn((Name::new("tap"), material, emitter)).id();
    let shown = [
        TypeId::of::<ParticleEmitter>(),
        TypeId::of::<FluidMaterial>(),
    ];
    let parts = [
        "Name::new(\"tap\")".into(),
        rust_code(&emitter, &registry),
        rust_code(&material, &registry),
    ];
    let lines = parts.map(|part| part.replace('\n', "\n    "));
    let sum = format!("commands.spawn((\n    {},\n));", lines.join(",\n    "));
    assert_eq!(spawn_code(world.entity(tap), &shown, &registry), sum);
}

#[test]
fn the_code_of_a_scene_spawns_it() {
    assert_spawns! { commands =>
        commands.insert_resource(RainStreakSettings {
            seed: 7,
            ..default()
        });
        commands.spawn((
            Name::new("eye"),
            Camera3d::default(),
            Transform {
                translation: vec3(0.0, 1.0, 4.0),
                ..default()
            },
            FluidDebugView::Normals,
            ScreenSpaceFluid {
                refractions: Refractions::Two,
                ..default()
            },
        ));
        commands.spawn((
            Name::new("tap"),
            FluidMaterial {
                refractive_index: 1.2,
                ..default()
            },
            SurfaceKernel::default(),
            FluidParticles::default(),
            ParticleEmitter {
                rate: 250.0,
                bounds: Some(EmitterBounds {
                    min: vec3(-1.0, 0.0, -1.0),
                    ..default()
                }),
                ..default()
            },
        ));
        commands.spawn((ParticleCollider {
            shape: SolidShape::Sphere { radius: 0.5 },
            ..default()
        },));
    }
}
