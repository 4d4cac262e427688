//! What plugins need of others: what is missing when all are added is logged in one sentence.

use bevy::prelude::*;

/// Sees to a clock: without one, time stands still.
pub(crate) fn need_time(app: &mut App, plugin: &str) {
    if !app.world().contains_resource::<Time>() {
        error!(
            "`{plugin}` needs `TimePlugin`, part of `MinimalPlugins` and of `DefaultPlugins`: \
             without it nothing moves"
        );
        app.init_resource::<Time>();
    }
}

/// Logs that a plugin had to do without the renderer, which was added after it.
pub(crate) fn log_late_renderer(plugin: &str, effect: &str) {
    error!(
        "`{plugin}` was added before `RenderPlugin` and {effect}: add it after `DefaultPlugins`"
    );
}
