//! Times and frames: the two frames around a moment, and those that come next.

use super::asset::FluidRecording;

/// Where a player is. Places count the frames that can be played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Playhead {
    /// The frame at or before the moment, or the first.
    pub(super) before: usize,
    /// The one after the moment; the same where the moment is that of a frame, or the end.
    pub(super) after: usize,
    /// How far from the one to the other, from 0 to 1.
    pub(super) share: f32,
    pub(super) is_forward: bool,
    pub(super) repeats: bool,
}

impl Playhead {
    /// Where `time` (in seconds from the recording's first frame) lies among the frames `playable`,
    /// of which there must be one.
    pub(super) fn at(
        time: f64,
        recording: &FluidRecording,
        playable: &[usize],
        is_forward: bool,
        repeats: bool,
    ) -> Self {
        let number = |frame: usize| f64::from(recording.frames[frame].number);
        let sought = number(0) + time * recording.rate;
        let after = playable.partition_point(|&frame| number(frame) <= sought);
        let before = after.saturating_sub(1);
        let after = after.min(playable.len() - 1);
        let [from, to] = [before, after].map(|place| number(playable[place]));
        let share = if sought > from && to > from {
            ((sought - from) / (to - from)) as f32
        } else {
            0.0
        };
        Self {
            before,
            // Exactly at a frame, the next is not needed.
            after: if share > 0.0 { after } else { before },
            share,
            is_forward,
            repeats,
        }
    }

    /// The places in the order in which they are needed, of `count` in all, each once.
    pub(super) fn upcoming(self, count: usize) -> impl Iterator<Item = usize> {
        let start = if self.is_forward {
            self.before
        } else {
            self.after
        };
        let to_end = if self.is_forward {
            count - start
        } else {
            start + 1
        };
        let steps = if self.repeats { count } else { to_end };
        (0..steps).map(move |step| {
            if self.is_forward {
                (start + step) % count
            } else {
                (start + count - step) % count
            }
        })
    }

    /// How many frames one that is shown at `place` lags behind `target`, or `None` where it lies
    /// ahead of it.
    pub(super) fn lag(self, place: usize, target: usize, count: usize) -> Option<usize> {
        let (from, to) = if self.is_forward {
            (place, target)
        } else {
            (target, place)
        };
        if self.repeats {
            Some((to + count - from) % count)
        } else {
            to.checked_sub(from)
        }
    }
}

/// The time `seconds` later, in the recording's range.
pub(super) fn moved_on(time: f64, seconds: f64, recording: &FluidRecording, repeats: bool) -> f64 {
    if !repeats {
        return (time + seconds).clamp(0.0, recording.end());
    }
    let duration = recording.duration();
    let time = (time + seconds).rem_euclid(duration);
    // A little less than nothing is rounded up to a whole round.
    if time < duration { time } else { 0.0 }
}
