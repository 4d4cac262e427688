//! Rain in a street with a fountain of liquid: at night in the light of a lamp and of a car, and on
//! an overcast day.
//!
//! ```text
//! cargo run --release --example rain -- --scene headlights --rate 20 --out rain.png
//! ```
//! The scenes `headlights`, `driver`, `lamp` and `under-lamp` are the rain paper's two
//! applications, each from its two viewpoints; `day` is overcast, `shelter` looks out from under a
//! roof. Try `--wind 6,0`, `--exposure 0.033`, `--per-drop`.

mod street;

use std::path::PathBuf;

use bevy::prelude::*;
use bevy_fluid::{
    prelude::*,
    rain::{Exposure, RainMethod, RainStreakSettings},
};
use clap::{Parser, ValueEnum};
use fluid_stage::{StagePlugins, VIEW_SIZE, parse_args, scenery::Scenery};

/// Rain in a street.
#[derive(Parser, Resource, Clone, Debug)]
#[command(name = "rain")]
struct Args {
    /// The scene to draw
    #[arg(long, value_enum, default_value_t = Scene::Headlights)]
    scene: Scene,
    /// Rain rate in mm/h: 1 is drizzle, 20 heavy, 75 a cloudburst
    #[arg(long, default_value = "10", allow_hyphen_values = true)]
    rate: f32,
    /// How far streaks are drawn, in metres
    #[arg(long, default_value = "20")]
    distance: f32,
    /// Wind along x and z in m/s
    #[arg(long, default_value = "0,0", value_parser = pair, allow_hyphen_values = true)]
    wind: Vec2,
    /// Exposure time in seconds; the time of a frame if not given
    #[arg(long)]
    exposure: Option<f32>,
    /// Brightness of drops relative to the light that real drops scatter
    #[arg(long, default_value = "1")]
    brightness: f32,
    /// Draw every drop individually
    #[arg(long)]
    per_drop: bool,
    /// Write a picture (PNG) instead of opening a window
    #[arg(long)]
    out: Option<PathBuf>,
    /// Width and height in pixels
    #[arg(long, default_value = "1280x720", value_parser = size)]
    size: UVec2,
    /// Frames before the picture is taken
    #[arg(long, default_value = "45")]
    frames: u32,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum Scene {
    /// A car's headlights from the side
    Headlights,
    /// The same from behind the windscreen
    Driver,
    /// A street lamp from afar
    Lamp,
    /// The same lamp from beneath
    UnderLamp,
    /// An overcast day
    Day,
    /// The same day from under a roof
    Shelter,
}

impl Scene {
    fn is_night(self) -> bool {
        !matches!(self, Self::Day | Self::Shelter)
    }

    /// The eye and its target.
    fn view(self) -> (Vec3, Vec3) {
        match self {
            Self::Headlights => (vec3(5.2, 1.5, 3.6), vec3(0.2, 0.7, -0.4)),
            Self::Driver => (vec3(-1.2, 1.35, 0.3), vec3(4.0, 0.75, 0.3)),
            Self::Lamp => (vec3(-1.5, 1.6, 6.5), vec3(-1.2, 2.0, -3.2)),
            Self::UnderLamp => (vec3(-2.4, 1.6, -0.9), vec3(-1.2, 3.6, -3.4)),
            Self::Day => (vec3(3.5, 1.7, 5.0), vec3(-0.8, 0.8, -2.0)),
            Self::Shelter => (vec3(3.0, 1.6, -4.6), vec3(0.0, 0.9, 1.0)),
        }
    }
}

fn main() -> AppExit {
    let args: Args = parse_args();
    let stage = StagePlugins {
        out: args.out.clone(),
        size: args.size,
        frames: args.frames,
        title: "rain · bevy_fluid".into(),
        ..default()
    };
    let rain = RainPlugin {
        // A picture must not depend on how fast textures are drawn.
        synchronous_bake: args.out.is_some(),
    };
    App::new()
        .add_plugins((stage, FluidPlugin::default(), rain))
        .insert_resource(RainStreakSettings {
            exposure: args.exposure.map_or_else(default, Exposure::Seconds),
            ..default()
        })
        .insert_resource(args)
        .add_systems(Startup, setup)
        .run()
}

fn setup(mut scenery: Scenery, args: Res<Args>, mut ambient: ResMut<GlobalAmbientLight>) {
    ambient.brightness = 0.0;
    let lit_by = street::light(&mut scenery, args.scene.is_night());
    street::build(&mut scenery, args.scene.is_night());
    let (eye, target) = args.scene.view();
    let rain = Rain {
        distance: args.distance,
        wind: args.wind,
        brightness: args.brightness,
        method: if args.per_drop {
            RainMethod::PerDrop
        } else {
            RainMethod::Streaks
        },
        ..Rain::falling(args.rate)
    };
    scenery.commands.spawn((
        fluid_stage::scenery::orbit_camera(eye, target),
        ScreenSpaceFluid::default(),
        rain,
        lit_by,
    ));
}

fn pair(text: &str) -> Result<Vec2, String> {
    let (x, y) = text
        .split_once(',')
        .ok_or("not two numbers with a comma between")?;
    let number = |word: &str| {
        word.trim()
            .parse()
            .map_err(|_| format!("`{word}` is not a number"))
    };
    Ok(vec2(number(x)?, number(y)?))
}

fn size(text: &str) -> Result<UVec2, String> {
    let side = |word: &str| word.parse().ok().filter(|side| (1..=8192).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some(uvec2(side(width)?, side(height)?)))
        .ok_or_else(|| format!("not WIDTHxHEIGHT, as in {}x{}", VIEW_SIZE.x, VIEW_SIZE.y))
}
