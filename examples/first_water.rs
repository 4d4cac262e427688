//! The program of the README: a hose pours water over a ball and onto the floor.
//!
//! In a window, or `--out FILE.png` for a picture. Try another speed, or `FluidMaterial::MILK`
//! beside the emitter.

use bevy::prelude::*;
use bevy_fluid::prelude::*;
use fluid_stage::StagePlugins;

fn main() -> AppExit {
    App::new()
        // In your own program: `DefaultPlugins`.
        .add_plugins((StagePlugins::from_args(), FluidPlugin::default()))
        .insert_resource(ClearColor(Color::srgb(0.7, 0.85, 1.0)))
        .add_systems(Startup, setup)
        .run()
}

fn setup(mut commands: Commands, assets: Res<AssetServer>, mut images: ResMut<Assets<Image>>) {
    // A hose: 8000 particles a second at 3 m/s, over a ball and onto the floor.
    let hose = Transform::from_xyz(-0.8, 0.8, 0.0).looking_to(vec3(1.0, 0.4, 0.0), Vec3::Y);
    commands.spawn((ParticleEmitter::jet(8000.0, 3.0), hose));
    let (air, gray) = (Color::srgb(0.2, 0.45, 0.9), Color::srgb(0.4, 0.4, 0.4));
    let paint = |color: Color| MeshMaterial3d(assets.add(StandardMaterial::from(color)));
    let (floor, ball) = (Plane3d::default().mesh().size(40.0, 40.0), Sphere::new(0.3));
    commands.spawn((
        ParticleCollider::ground(),
        Mesh3d(assets.add(floor.build())),
        paint(gray),
    ));
    let red = (
        paint(Color::srgb(0.8, 0.1, 0.05)),
        Transform::from_xyz(0.28, 0.3, 0.0),
    );
    commands.spawn((
        ParticleCollider::new(ball),
        Mesh3d(assets.add(ball.into())),
        red,
    ));
    let sun = Transform::default().looking_to(vec3(-1.0, -2.0, -1.0), Vec3::Y);
    commands.spawn((DirectionalLight::default(), sun));
    // Water shows what it reflects and refracts: a sky, a horizon, a ground.
    let mut sky = EnvironmentMapLight::hemispherical_gradient(&mut images, air, Color::WHITE, gray);
    sky.intensity = 1000.0;
    let eye = Transform::from_xyz(0.3, 0.9, 1.8).looking_at(Vec3::Y * 0.4, Vec3::Y);
    commands.spawn((Camera3d::default(), ScreenSpaceFluid::default(), sky, eye));
}
