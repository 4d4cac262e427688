//! What is inside a fluid, held against the closed form and against pictures without shortcuts.

mod closed_form;
mod gpu;
mod light;
mod shortcuts;
mod thickness;
mod two;

use crate::common::*;
use bevy::{camera::Exposure, math::DVec3, prelude::*};
use bevy_fluid::{prelude::*, render::Layers, settings::Refractions};
use fluid_stage::{TextureData, capture};

/// Two metres square; depth 10 m.
const PARALLEL: View = View::new(
    96,
    Lens::Orthographic {
        height: 2.2,
        near: 0.0,
        far: 10.0,
    },
);
const TRACED: ScreenSpaceFluid = ScreenSpaceFluid {
    refractions: Refractions::Four,
    ..RAW
};
/// f16 has 11 bits: half a unit in the last place of a number below 1.
const HALF: f64 = 2.5e-4;

/// A sphere of 1 m, 5 m away.
const CENTER: Vec3 = Vec3::new(0.0, 0.0, -5.0);

/// A material of this medium that bends no light.
fn unbent(medium: Medium) -> FluidMaterial {
    FluidMaterial {
        refractive_index: 1.0,
        medium,
        ..FluidMaterial::CLEAR_WATER
    }
}

fn sphere(material: FluidMaterial) -> impl Bundle {
    (FluidParticles::new(vec![CENTER], 1.0), SPRAY, material)
}

/// The chord of a parallel ray through the sphere; `None` beside it and at its very rim.
fn chord(pixel: UVec2) -> Option<f64> {
    let ray = PARALLEL.ray(View::center(pixel));
    let sine = (CENTER.as_dvec3() - ray.origin)
        .cross(ray.direction)
        .length();
    (sine < 0.999).then(|| 2.0 * (1.0 - sine * sine).sqrt())
}

fn rgb(light: &TextureData, pixel: UVec2) -> DVec3 {
    let [r, g, b, _] = light.f16x4(pixel.x, pixel.y).map(f64::from);
    DVec3::new(r, g, b)
}

/// cd/m² that are shown as 1.
fn white() -> f32 {
    1.0 / Exposure::default().exposure()
}

/// Makes all the scene's light even: `luminance` (cd/m²) from everywhere, and as much behind the
/// fluid.
fn furnace(app: &mut App, luminance: f32) {
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let mut map = EnvironmentMapLight::solid_color(&mut images, Color::WHITE);
    map.intensity = luminance;
    app.insert_resource(GlobalAmbientLight::NONE);
    let shown = luminance / white();
    let camera = only::<Camera3d>(app);
    let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
    camera.clear_color = ClearColorConfig::Custom(Color::linear_rgb(shown, shown, shown));
    look(app, map);
}
