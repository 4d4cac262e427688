//! A shader that does not compile ends in an error, not in a picture without it.

use bevy::{
    prelude::*,
    render::render_resource::AsBindGroup,
    shader::{Shader, ShaderRef},
};
use fluid_stage::{StageError, headless_app, settle};

#[derive(Asset, TypePath, AsBindGroup, Clone, Default)]
struct Broken {}

const SHADER: Handle<Shader> = bevy::asset::uuid_handle!("6b2b1a3e-7a53-4f0e-9d6f-4b5a3d1f2c60");

impl Material for Broken {
    fn fragment_shader() -> ShaderRef {
        SHADER.into()
    }
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<Broken>>,
) {
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 0.0, 4.0)));
    commands.spawn((
        Mesh3d(meshes.add(Cuboid::default())),
        MeshMaterial3d(materials.add(Broken {})),
    ));
}

#[test]
fn a_broken_shader_is_reported() {
    let mut app = headless_app(UVec2::new(16, 16), |app| {
        app.add_plugins(MaterialPlugin::<Broken>::default())
            .add_systems(Startup, setup);
        let shader = Shader::from_wgsl("@fragment fn fragment() -> nonsense {}", "broken.wgsl");
        let _ = app
            .world_mut()
            .resource_mut::<Assets<Shader>>()
            .insert(SHADER.id(), shader);
    })
    .unwrap();
    match settle(&mut app) {
        Err(StageError::Pipelines(failed)) => assert!(!failed.is_empty()),
        other => panic!("{other:?}"),
    }
}
