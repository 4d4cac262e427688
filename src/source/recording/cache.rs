//! A player's frames: loaded in the background, never more than the cache may hold.

use std::sync::Arc;

use bevy::{
    asset::AssetServer,
    prelude::*,
    tasks::{IoTaskPool, Task, futures::check_ready},
};

use super::{
    asset::{FluidRecording, RecordedFrame},
    files,
    frame::{FrameError, ParticleFrame},
    interpolate::in_order_of_ids,
    playhead::Playhead,
};

/// The frames that a [`RecordingPlayer`](super::RecordingPlayer) has loaded, and the one that it
/// shows.
#[derive(Component, Debug, Default)]
pub struct LoadedFrames {
    /// The frames of the whole recording, compared to detect another or a reloaded one.
    recorded: Arc<[RecordedFrame]>,
    slots: Vec<Slot>,
    /// Those that have not turned out to be unreadable, by number.
    pub(super) playable: Vec<usize>,
    /// What should be held, the most urgent first.
    window: Vec<usize>,
    /// What is on screen.
    pub(super) shown: Option<Shown>,
    pub(super) shown_radius: Option<f32>,
    pub(super) shown_number: Option<u32>,
    /// Whether nothing requested has been shown since the last seek.
    pub(super) is_seeking: bool,
    pub(super) is_waiting: bool,
    /// The player's time as we left it: another one is a seek.
    pub(super) left_at: Option<f64>,
}

/// A moment between two frames of a recording, or one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    pub(super) before: usize,
    pub(super) after: usize,
    pub(super) share: f32,
}

#[derive(Debug)]
struct Slot {
    frame: usize,
    content: Content,
}

#[derive(Debug)]
enum Content {
    Loading(Task<Result<ParticleFrame, FrameError>>),
    Ready(ParticleFrame),
}

impl Slot {
    fn is_ready(&self) -> bool {
        matches!(self.content, Content::Ready(_))
    }
}

impl LoadedFrames {
    /// Number of frames in memory, loading ones included.
    pub fn held(&self) -> usize {
        self.slots.len()
    }

    /// Number of frames that are loading.
    pub fn loading(&self) -> usize {
        self.slots.iter().filter(|slot| !slot.is_ready()).count()
    }

    /// The number of the frame shown; under interpolation, of the earlier one.
    pub fn shown(&self) -> Option<u32> {
        self.shown_number
    }

    /// Whether the frames for the player's time are still loading.
    pub fn is_waiting(&self) -> bool {
        self.is_waiting
    }

    /// Number of frames that cannot be read or are missing.
    pub fn skipped(&self) -> usize {
        self.recorded.len() - self.playable.len()
    }

    /// Forgets everything if the recording is another, even if by the same name and length.
    pub(super) fn follow(&mut self, recording: &FluidRecording) {
        if !Arc::ptr_eq(&self.recorded, &recording.frames) {
            *self = Self {
                recorded: recording.frames.clone(),
                playable: (0..recording.frames.len()).collect(),
                is_seeking: true,
                is_waiting: true,
                ..default()
            };
        }
    }

    /// Takes in what has been loaded.
    pub(super) fn collect(&mut self, entity: Entity) {
        let mut at = 0;
        while let Some(slot) = self.slots.get_mut(at) {
            let Content::Loading(task) = &mut slot.content else {
                at += 1;
                continue;
            };
            match check_ready(task) {
                None => at += 1,
                Some(Ok(frame)) => {
                    slot.content = Content::Ready(frame);
                    at += 1;
                }
                Some(Err(error)) => {
                    let frame = self.slots.swap_remove(at).frame;
                    self.playable.retain(|&playable| playable != frame);
                    warn!("fluid {entity} skips a frame of its recording: {error}");
                    if self.playable.is_empty() {
                        warn!("fluid {entity} has no frame of its recording left to play");
                        self.is_waiting = false;
                    }
                }
            }
        }
    }

    pub(super) fn ready(&self, frame: usize) -> Option<&ParticleFrame> {
        self.slots.iter().find_map(|slot| match &slot.content {
            Content::Ready(content) if slot.frame == frame => Some(content),
            _ => None,
        })
    }

    /// The frames that are there.
    pub(super) fn all_ready(&self) -> impl Iterator<Item = usize> {
        let ready = self.slots.iter().filter(|slot| slot.is_ready());
        ready.map(|slot| slot.frame)
    }

    /// Loads the frames that come next, and drops others for them.
    pub(super) fn load(
        &mut self,
        head: &Playhead,
        recording: &FluidRecording,
        server: &AssetServer,
        cache: usize,
    ) {
        self.window.clear();
        let next = head.upcoming(self.playable.len()).take(cache);
        self.window.extend(next.map(|place| self.playable[place]));
        let window = &self.window;
        if self.is_seeking {
            // Frames still loading that are no longer needed.
            self.slots
                .retain(|slot| slot.is_ready() || window.contains(&slot.frame));
        }
        while self.slots.len() > cache {
            let other = self
                .slots
                .iter()
                .position(|slot| !window.contains(&slot.frame));
            self.slots.swap_remove(other.unwrap_or(0));
        }
        for &frame in window {
            if self.slots.iter().any(|slot| slot.frame == frame) {
                continue;
            }
            if self.slots.len() == cache {
                // A frame that is still loading is shown late rather than never: otherwise playback
                // that is faster than its files would show none at all.
                let passed = |slot: &Slot| slot.is_ready() && !window.contains(&slot.frame);
                let Some(passed) = self.slots.iter().position(passed) else {
                    break;
                };
                self.slots.swap_remove(passed);
            }
            let task = load(server.clone(), recording.frames[frame].clone());
            self.slots.push(Slot {
                frame,
                content: Content::Loading(IoTaskPool::get().spawn(task)),
            });
        }
    }
}

async fn load(server: AssetServer, frame: RecordedFrame) -> Result<ParticleFrame, FrameError> {
    let name = frame.path.to_string();
    match files::read(&server, &frame.path).await {
        Ok(bytes) => ParticleFrame::parse(&name, &bytes).map(in_order_of_ids),
        Err(reason) => Err(FrameError::Read { name, reason }),
    }
}
