//! Records a running app: one numbered file for each frame, written in the background.

mod job;
mod written;

use std::path::Path;

use bevy::{prelude::*, tasks::IoTaskPool, transform::helper::TransformHelper};

use self::job::description;
pub use self::written::WrittenFrames;
use super::{
    error::RecordingError,
    frame::{ParticleFrame, is_radius},
    pattern::FramePattern,
};
use crate::{
    settings::{Checked, SettingRange, Settings},
    source::particles::{FluidParticles, ParticleSpace},
};

/// Frames of the clock may be a little short.
const TOLERANCE: f64 = 1e-3;

/// Writes the [`FluidParticles`] on its entity to numbered files, in the format of their extension,
/// with velocities and ids where they are known, and a `.fluid.ron` for playing them.
///
/// Files are in the entity's space. Of particles in the [world](ParticleSpace::World), velocities
/// are left out of a frame in which the entity's place in it is not that of the frame before:
/// players then move them on lines.
///
/// Frame n is the state in the first frame of the app at or after n / `rate`, counted from the
/// frame in which the component is added. Everything is written in the background; if files are
/// slower than the app, frames are dropped (and counted), and the others keep their numbers and
/// times. A file that cannot be written is logged once, with its path, and ends the recording until
/// the component changes. [`WrittenFrames`] has the counts.
///
/// Values out of range are logged once and clamped.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(FluidParticles, WrittenFrames, Checked<Self>)]
pub struct RecordingWriter {
    /// Names of the files, see [`FramePattern`]: a file system path with one number. Missing
    /// folders are created, and existing files are replaced. Another pattern starts a new
    /// recording.
    pub frames: String,
    /// Frames per second of the app's [`Time`]. Unit: 1/s, range 0.001..=10,000, default 30.
    #[reflect(@SettingRange::new(0.1, 1e4).unit("1/s").logarithmic().valid(1e-3, 1e4))]
    pub rate: f32,
    /// Whether writing and the recording's clock are paused. Default: false.
    pub paused: bool,
    /// Maximum number of frames waiting to be written. Range ≥ 1, default 4. Higher: fewer frames
    /// are lost while the disk is slow, for more memory.
    #[reflect(@SettingRange::new(1.0, 256.0).unit("frames").logarithmic().open())]
    pub queue: usize,
}

impl Settings for RecordingWriter {}

impl Default for RecordingWriter {
    fn default() -> Self {
        Self {
            frames: "recording/frame_####.vtk".into(),
            rate: 30.0,
            paused: false,
            queue: 4,
        }
    }
}

impl RecordingWriter {
    /// Writes 30 frames a second to files of this name.
    pub fn new(frames: impl Into<String>) -> Self {
        Self {
            frames: frames.into(),
            ..default()
        }
    }
}

pub(in crate::source::recording) fn record(
    mut writers: Query<(
        Entity,
        Ref<RecordingWriter>,
        &Checked<RecordingWriter>,
        &mut WrittenFrames,
        &FluidParticles,
    )>,
    transforms: TransformHelper,
    time: Res<Time>,
) {
    for (entity, set, writer, mut written, particles) in &mut writers {
        let written = &mut *written;
        written.collect();
        if set.is_changed() {
            written.error = None;
            if written.pattern != writer.frames {
                written.restart(&writer.frames);
            }
        }
        if writer.paused || written.error.is_some() {
            continue;
        }
        if written.last.is_some() {
            written.elapsed += time.delta_secs_f64();
        }
        let result = frame_due(writer, written).and_then(|due| {
            let Some((number, pattern)) = due else {
                return Ok(());
            };
            if written.jobs.len() >= writer.queue {
                if written.dropped == 0 {
                    let frames = &writer.frames;
                    warn!("{frames} is written too slowly: frames are left out");
                }
                written.dropped += 1;
                return Ok(());
            }
            let place = transforms.compute_global_transform(entity);
            let place = place.unwrap_or_default();
            start(number, &pattern, writer, written, particles, &place)
        });
        if let Err(error) = result {
            written.fail(&error.to_string());
        }
    }
}

/// The number of the frame that is due, if any.
fn frame_due(
    writer: &RecordingWriter,
    written: &mut WrittenFrames,
) -> Result<Option<(u32, FramePattern)>, RecordingError> {
    let refuse = |reason| RecordingError::Pattern {
        pattern: writer.frames.clone(),
        reason,
    };
    let number = (written.elapsed * f64::from(writer.rate) + TOLERANCE) as u32;
    if written.last.is_some_and(|last| number <= last) {
        return Ok(None);
    }
    written.last = Some(number);
    let pattern = FramePattern::parse(&writer.frames)?;
    if !pattern.is_numbered() {
        return Err(refuse("it has no number (`####`)"));
    }
    Ok(Some((number, pattern)))
}

fn start(
    number: u32,
    pattern: &FramePattern,
    writer: &RecordingWriter,
    written: &mut WrittenFrames,
    particles: &FluidParticles,
    place: &GlobalTransform,
) -> Result<(), RecordingError> {
    let mut job = written.spare.pop().unwrap_or_default();
    let frame = &mut job.frame;
    let last = written.place.replace(*place);
    write(
        frame,
        particles,
        place,
        last.is_none_or(|last| last == *place),
    );
    let folder = Path::new(pattern.folder());
    job.path = folder.join(pattern.file_name(number));
    // With the first frame that is not left out.
    job.description = (!written.is_described)
        .then(|| description(pattern, writer, frame.radius))
        .transpose()?
        .map(|text| (folder.join(format!("{}.fluid.ron", pattern.stem())), text));
    job.recording = written.recording;
    written.is_described = true;
    written.jobs.push(IoTaskPool::get().spawn(async move {
        let result = job.run();
        (job, result)
    }));
    Ok(())
}

/// Writes particles to a frame in the space of their entity, at `place`, which may have moved.
fn write(
    frame: &mut ParticleFrame,
    particles: &FluidParticles,
    place: &GlobalTransform,
    stays: bool,
) {
    frame.positions.clone_from(&particles.positions);
    frame.velocities.clear();
    frame
        .velocities
        .extend_from_slice(particles.whole_velocities());
    frame.ids.clear();
    frame.ids.extend_from_slice(particles.whole_ids());
    let mut radius = particles.radius;
    let to_entity = place.affine().inverse();
    if particles.space == ParticleSpace::World && to_entity.is_finite() {
        if !stays {
            frame.velocities.clear();
        }
        for position in &mut frame.positions {
            *position = to_entity.transform_point3(*position);
        }
        for velocity in &mut frame.velocities {
            *velocity = to_entity.transform_vector3(*velocity);
        }
        radius *= to_entity.matrix3.determinant().abs().cbrt();
    }
    frame.radius = Some(radius).filter(|&radius| is_radius(radius));
}
