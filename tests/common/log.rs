//! What is logged, for tests that something is said once.

use std::sync::{Mutex, Once, PoisonError};

use bevy::log::{
    Level,
    tracing::{
        Event, Subscriber,
        field::{Field, Visit},
        subscriber::set_global_default,
    },
    tracing_subscriber::{
        Layer,
        layer::{Context, SubscriberExt},
        registry,
    },
};

static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Collects warnings and errors from now on; call it ahead of the first app, whose own log would
/// take the place.
pub(crate) fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| set_global_default(registry().with(Listener)).unwrap());
}

/// How many warnings and errors hold `part`, in all apps of this process.
pub(crate) fn said(part: &str) -> usize {
    let said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
    said.iter().filter(|line| line.contains(part)).count()
}

struct Listener;

impl<S: Subscriber> Layer<S> for Listener {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if *event.metadata().level() <= Level::WARN {
            let mut message = Message(String::new());
            event.record(&mut message);
            let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
            said.push(message.0);
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
