//! The stage shared by the examples, tests and benches of `bevy_fluid`.
//!
//! - [`StagePlugins`] replaces `DefaultPlugins`: a window, or a picture written without one.
//! - [`headless_app`] with [`settle`], [`step`], [`capture`] and [`read_texture`] renders frame by
//!   frame and reads back the GPU's data, for tests and benches.
//! - [`scenery`] builds the surroundings of the liquid: floor, pillars, sky, sun, tank and camera.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use fluid_stage::{StagePlugins, scenery::Scenery};
//!
//! fn main() -> AppExit {
//!     App::new()
//!         .add_plugins(StagePlugins::from_args())
//!         .add_systems(Startup, setup)
//!         .run()
//! }
//!
//! fn setup(mut scenery: Scenery) {
//!     scenery.checker_floor(Vec3::ZERO, 4.0, 8);
//! }
//! ```

mod adapter;
mod args;
mod error;
mod headless;
pub mod log;
mod picture;
mod pipelines;
mod plugins;
mod read;
pub mod scenery;
mod shapes;
mod stage;
mod texels;
mod timing;

pub use args::{ArgumentError, parse_args};
pub use error::StageError;
pub use headless::{
    adapter_name, capture, headless_app, headless_app_in_background, headless_app_with, resize,
    set_time_step, settle, step, validation_errors,
};
pub use picture::PendingPicture;
pub use plugins::{StagePlugins, VIEW_SIZE};
pub use read::{read_buffer, read_subresource, read_texture};
pub use shapes::{ball, cylinder, dam, lattice};
pub use stage::Stage;
pub use texels::TextureData;
pub use timing::{gpu_spans, median_gpu_ms};
