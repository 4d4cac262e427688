//! Frames that have been written, and those that still wait.

use std::mem;

use bevy::{
    prelude::*,
    tasks::{Task, block_on, futures::check_ready},
};

use super::job::Job;
use crate::source::recording::frame::FrameError;

/// Counts of the frames that a [`RecordingWriter`](super::RecordingWriter) has written.
#[derive(Component, Debug, Default)]
pub struct WrittenFrames {
    pub(super) pattern: String,
    /// Counts the patterns: frames that still wait for an earlier one do not count.
    pub(super) recording: u32,
    /// Whether its `.fluid.ron` is written or on its way.
    pub(super) is_described: bool,
    /// Recorded time. Unit: s.
    pub(super) elapsed: f64,
    pub(super) last: Option<u32>,
    /// Where the entity was in the last frame.
    pub(super) place: Option<GlobalTransform>,
    pub(super) jobs: Vec<Task<(Job, Result<(), FrameError>)>>,
    /// Their buffers are used again.
    pub(super) spare: Vec<Job>,
    pub(super) written: u32,
    pub(super) dropped: u32,
    pub(super) error: Option<String>,
}

impl WrittenFrames {
    /// Number of frames written.
    pub fn written(&self) -> u32 {
        self.written
    }

    /// Number of frames dropped because too many were waiting.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Number of frames waiting to be written.
    pub fn waiting(&self) -> usize {
        self.jobs.len()
    }

    /// Why the recording has ended, if it has.
    pub fn error(&self) -> Option<&str> {
        self.error.as_deref()
    }

    /// Waits until everything is written: call it at the end of a program, which would otherwise
    /// end the writing too.
    pub fn finish(&mut self) {
        for task in mem::take(&mut self.jobs) {
            let (job, result) = block_on(task);
            self.take_back(job, result);
        }
    }

    pub(super) fn collect(&mut self) {
        let mut at = 0;
        while let Some(task) = self.jobs.get_mut(at) {
            if let Some((job, result)) = check_ready(task) {
                drop(self.jobs.swap_remove(at));
                self.take_back(job, result);
            } else {
                at += 1;
            }
        }
    }

    fn take_back(&mut self, mut job: Job, result: Result<(), FrameError>) {
        let is_ours = job.recording == self.recording;
        if job.description.take().is_some() && is_ours {
            self.is_described = false;
        }
        self.spare.push(job);
        match result {
            Ok(()) if is_ours => self.written += 1,
            Ok(()) => {}
            Err(error) if is_ours => self.fail(&error.to_string()),
            Err(error) => warn!("a frame of an earlier recording is lost: {error}"),
        }
    }

    pub(super) fn fail(&mut self, error: &str) {
        if self.error.is_none() {
            warn!("the recording ends: {error}");
            self.error = Some(error.into());
        }
    }

    pub(super) fn restart(&mut self, pattern: &str) {
        self.pattern = pattern.into();
        self.recording = self.recording.wrapping_add(1);
        self.is_described = false;
        self.elapsed = 0.0;
        self.last = None;
        self.place = None;
        (self.written, self.dropped) = (0, 0);
    }
}

impl Drop for WrittenFrames {
    fn drop(&mut self) {
        // Waiting frames are still written when the fluid is despawned.
        for task in self.jobs.drain(..) {
            task.detach();
        }
    }
}
