//! Rain: falling drops as streaks of light, for a camera with [`Rain`].
//!
//! After Yoshida, Dobashi and Yamamoto, *A fast rendering method of rain streaks for rainy
//! landscapes*: the streaks of all drops in a cubic metre of air are drawn into textures in advance
//! ([`streaks`]); voxels around the camera show them on billboards that face it. The scene's lights
//! light them.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_fluid::prelude::*;
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, RainPlugin::default()))
//!     .add_systems(Startup, |mut commands: Commands| {
//!         commands.spawn((Camera3d::default(), Rain::HEAVY));
//!     })
//!     .run();
//! ```
//!
//! # Differences from the paper
//!
//! - A streak's length follows the exposure time; its opacity keeps the extinction by a drop
//!   ([`drops::extinction`]) the same at any exposure.
//! - Within 2 m, where streaks can be distinguished, drops are drawn individually, each at its own
//!   place and speed. That is both more accurate and cheaper than many layers of small voxels.
//! - A column of falling billboards is replaced by one fixed billboard whose texture falls: all
//!   drops in one draw of one layer. Beyond 2 m, drops of all sizes therefore fall at one speed,
//!   the mean.
//! - As rain grows denser, drops are added and the others stay as they are: no change of the rate
//!   moves a drop.
//! - Voxels are two metres wide, and from 6 m on twice as wide each time the distance doubles: the
//!   cost grows with the logarithm of the distance.
//! - A texture holds four nested densities of drops, so that rain of any rate, and voxels of any
//!   depth, are mixed from one texel with the correct variance of pixels over time.
//!
//! Lights cast no shadows into the rain; a [`RainShelter`] keeps it dry under roofs, near and far.
//! Rain beyond the streaks is lit only by the surroundings: ambient light, and environment map or sky box.

mod bake;
pub(crate) mod births;
mod clock;
pub mod densities;
mod draw;
pub mod drops;
pub mod phase;
mod settings;
pub mod streaks;

use bevy::{
    diagnostic::{Diagnostic, RegisterDiagnostic},
    prelude::*,
    render::RenderApp,
};

#[doc(hidden)]
pub use self::draw::RainQuads;
pub use self::{
    bake::{BAKE_PROGRESS, BAKE_TIME, BakedStreaks},
    clock::RainClock,
    drops::DragLaw,
    settings::{Exposure, Rain, RainMethod, RainShelter, RainStreakSettings},
};
use crate::{
    needs::log_late_renderer,
    relocation::{self, Relocated},
    schedule::FluidSystems,
    settings::{Checked, check},
};

/// Draws rain for cameras with [`Rain`]; independent of `FluidPlugin`. Add it after
/// `DefaultPlugins`; without a renderer it does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct RainPlugin {
    /// Whether the app waits for the textures of streaks instead of drawing them in the background:
    /// for pictures and tests, where every frame counts. Default false.
    pub synchronous_bake: bool,
}

impl Plugin for RainPlugin {
    fn build(&self, app: &mut App) {
        check::<Rain>(app);
        check::<RainShelter>(app);
        check::<RainStreakSettings>(app);
        relocation::plugin(app);
        app.register_type::<Rain>()
            .register_type::<RainShelter>()
            .register_type::<RainStreakSettings>()
            .init_resource::<RainStreakSettings>()
            .init_resource::<BakedStreaks>()
            .init_resource::<bake::LostDevices>()
            .insert_resource(bake::SynchronousBake(self.synchronous_bake))
            .register_diagnostic(Diagnostic::new(BAKE_PROGRESS).with_max_history_length(1))
            .register_diagnostic(Diagnostic::new(BAKE_TIME).with_suffix(" ms"))
            .configure_sets(
                PostUpdate,
                RainSystems
                    .after(FluidSystems::Check)
                    .after(TransformSystems::Propagate),
            )
            .add_systems(PostUpdate, settings::check_places.in_set(RainSystems));
        // Without a renderer nobody sees the streaks.
        if app.get_sub_app(RenderApp).is_some() {
            app.add_plugins(draw::RainDrawPlugin).add_systems(
                PostUpdate,
                (bake::bake_streaks, advance_clocks)
                    .chain()
                    .in_set(RainSystems),
            );
        }
    }

    fn finish(&self, app: &mut App) {
        let is_drawn = app.is_plugin_added::<draw::RainDrawPlugin>();
        if app.get_sub_app(RenderApp).is_some() && !is_drawn {
            log_late_renderer("RainPlugin", "draws nothing");
        }
    }
}

/// Where settings, places and the rest of what rain is drawn from are known.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
struct RainSystems;

fn advance_clocks(
    mut cameras: Query<(&Checked<Rain>, &GlobalTransform, &mut RainClock)>,
    streaks: Res<BakedStreaks>,
    relocated: Res<Relocated>,
    time: Res<Time>,
) {
    let Some(ready) = streaks.ready() else {
        return;
    };
    for (rain, transform, mut clock) in &mut cameras {
        clock.origin = relocated.total;
        let height = f64::from(transform.translation().y) - clock.origin.y;
        clock.advance(time.delta_secs_f64(), rain.wind, ready.speed, height);
    }
}
