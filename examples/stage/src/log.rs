//! The log of a stage without a window, kept so that tests can check that a warning is logged once.

use std::sync::{Mutex, Once, PoisonError};

use bevy::{
    log::{
        BoxedLayer, Level, LogPlugin,
        tracing::{
            Event, Subscriber,
            field::{Field, Visit},
        },
        tracing_subscriber::layer::{Context, Layer},
    },
    prelude::*,
};

static LOGGED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Sets up the log of this process, unless [`headless_app`](crate::headless_app) has done so:
/// warnings and errors go to stderr and are kept for [`count`].
pub fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
        App::new().add_plugins(LogPlugin {
            level: Level::WARN,
            // The renderer would warn on every start that software rendering is slow.
            filter: "wgpu=error,naga=warn,bevy_render::renderer=error".into(),
            custom_layer: |_| Some(Box::new(Listener) as BoxedLayer),
            ..default()
        });
    });
}

/// Number of warnings and errors that contain `part`, in all apps of this process since [`listen`].
pub fn count(part: &str) -> usize {
    let logged = LOGGED.lock().unwrap_or_else(PoisonError::into_inner);
    logged.iter().filter(|line| line.contains(part)).count()
}

struct Listener;

impl<S: Subscriber> Layer<S> for Listener {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if *event.metadata().level() <= Level::WARN {
            let mut message = Message(String::new());
            event.record(&mut message);
            let mut logged = LOGGED.lock().unwrap_or_else(PoisonError::into_inner);
            logged.push(message.0);
        }
    }
}

struct Message(String);

impl Visit for Message {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "message" {
            self.0 = format!("{value:?}");
        }
    }
}
