//! Playback: advances the clock, shows loaded frames, loads the rest.

use bevy::{asset::AssetServer, prelude::*};

use super::{
    asset::FluidRecording,
    cache::{LoadedFrames, Shown},
    interpolate::Between,
    player::{Interpolation, RecordingPlayer},
    playhead::{Playhead, moved_on},
};
use crate::{settings::Checked, source::particles::FluidParticles};

pub(super) fn play(
    mut players: Query<(
        Entity,
        &mut RecordingPlayer,
        &Checked<RecordingPlayer>,
        &mut LoadedFrames,
        &mut FluidParticles,
    )>,
    recordings: Res<Assets<FluidRecording>>,
    server: Res<AssetServer>,
    time: Res<Time>,
) {
    for (entity, mut player, checked, mut frames, mut particles) in &mut players {
        let Some(recording) = recordings.get(&player.recording) else {
            continue;
        };
        let frames = &mut *frames;
        frames.follow(recording);
        frames.collect(entity);
        if frames.playable.is_empty() {
            continue;
        }
        let now = moved(
            player.time,
            checked,
            frames,
            recording,
            time.delta_secs_f64(),
        );
        if player.time != now {
            player.time = now;
        }
        let is_forward = checked.rate >= 0.0;
        let head = Playhead::at(now, recording, &frames.playable, is_forward, checked.repeat);
        if let Some(moment) = choose(frames, &head, checked.interpolation) {
            show(
                moment,
                frames,
                recording,
                checked.interpolation,
                checked.rate,
                &mut particles,
            );
        }
        let radius = frames.shown_radius.or(checked.radius).or(recording.radius);
        if let Some(radius) = radius.filter(|&radius| radius != particles.radius)
            && frames.shown.is_some()
        {
            particles.radius = radius;
        }
        frames.load(&head, recording, &server, checked.cache);
    }
}

/// Logs, once, that players have nothing to read from.
pub(super) fn miss_assets(players: Query<(), Added<RecordingPlayer>>) {
    if !players.is_empty() {
        bevy::utils::once!(error!(
            "a `RecordingPlayer` plays nothing: it needs `AssetPlugin`, part of `DefaultPlugins`"
        ));
    }
}

/// The player's time now, in range.
fn moved(
    time: f64,
    player: &RecordingPlayer,
    frames: &mut LoadedFrames,
    recording: &FluidRecording,
    delta: f64,
) -> f64 {
    let is_sought = frames.left_at.is_some_and(|left_at| left_at != time);
    frames.is_seeking |= is_sought;
    // The target of a seek is shown before the clock moves on, and so is the start.
    let stands = is_sought || player.paused || frames.shown.is_none();
    let seconds = if stands {
        0.0
    } else {
        delta * f64::from(player.rate)
    };
    // It may have been set since it was checked.
    let time = if time.is_finite() { time } else { player.time };
    let now = moved_on(time, seconds, recording, player.repeat);
    frames.left_at = Some(now);
    now
}

/// What to show: the moment itself if it is loaded, else the latest frame passed.
fn choose(
    frames: &mut LoadedFrames,
    head: &Playhead,
    interpolation: Interpolation,
) -> Option<Shown> {
    let [before, after] = [head.before, head.after].map(|place| frames.playable[place]);
    let one = |frame| Shown {
        before: frame,
        after: frame,
        share: 0.0,
    };
    let mut target = head.before;
    frames.is_waiting = frames.ready(before).is_none();
    if interpolation != Interpolation::None {
        let ends = (frames.ready(before), frames.ready(after));
        if let (Some(from), Some(to)) = ends
            && head.share > 0.0
            && !(from.ids.is_empty() && to.ids.is_empty())
            && [from, to]
                .into_iter()
                .all(|end| end.ids.len() == end.positions.len())
        {
            frames.is_seeking = false;
            return Some(Shown {
                before,
                after,
                share: head.share,
            });
        }
        frames.is_waiting = ends.0.is_none() || ends.1.is_none();
        if head.share >= 0.5 {
            target = head.after;
        }
    }
    if frames.ready(frames.playable[target]).is_some() {
        frames.is_seeking = false;
        return Some(one(frames.playable[target]));
    }
    if frames.is_seeking {
        return None;
    }
    let count = frames.playable.len();
    let lag = |frame: usize| {
        let place = frames.playable.binary_search(&frame).ok()?;
        head.lag(place, target, count)
    };
    let shown = lag(frames.shown?.before)?;
    let late = frames
        .all_ready()
        .filter_map(|frame| Some((lag(frame)?, frame)));
    let (least, frame) = late.min()?;
    (least < shown).then(|| one(frame))
}

/// Writes the particles, unless they are there already.
fn show(
    moment: Shown,
    frames: &mut LoadedFrames,
    recording: &FluidRecording,
    interpolation: Interpolation,
    rate: f32,
    particles: &mut Mut<FluidParticles>,
) {
    if frames.shown == Some(moment) {
        return;
    }
    let (Some(before), Some(after)) = (frames.ready(moment.before), frames.ready(moment.after))
    else {
        return;
    };
    let particles = &mut **particles;
    if moment.before == moment.after {
        particles.positions.clone_from(&before.positions);
        particles.ids.clone_from(&before.ids);
        particles.velocities.clear();
        let velocities = before.velocities.iter().map(|&velocity| velocity * rate);
        particles.velocities.extend(velocities);
    } else {
        let number = |frame: usize| f64::from(recording.frames[frame].number);
        let frames = number(moment.after) - number(moment.before);
        Between {
            before,
            after,
            share: moment.share,
            seconds: (frames / recording.rate) as f32,
            by_velocity: interpolation == Interpolation::Velocity,
            rate,
        }
        .write(particles);
    }
    let radius = before.radius.or(after.radius);
    frames.shown_radius = radius;
    frames.shown_number = Some(recording.frames[moment.before].number);
    frames.shown = Some(moment);
}
