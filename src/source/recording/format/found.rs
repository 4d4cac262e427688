//! What a reader finds in a file, and why it finds nothing.

use std::fmt;

use bevy::prelude::*;

use super::{role::Role, scan::shown};
use crate::source::recording::frame::{ParticleFrame, is_radius};

/// More are as good as none to whoever reads the log.
const MOST_NOTES: usize = 16;

/// Why bytes are no particles.
#[derive(Debug)]
pub(in crate::source::recording) enum Fault {
    /// The rules of the format are broken.
    Damaged(String),
    /// It is something else, or of a kind that is not read.
    Unsupported(String),
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let (Self::Damaged(reason) | Self::Unsupported(reason)) = self;
        formatter.write_str(reason)
    }
}

/// Particles, and what was left out of them.
#[derive(Debug, Default)]
pub(in crate::source::recording) struct Found {
    pub(in crate::source::recording) frame: ParticleFrame,
    pub(in crate::source::recording) notes: Vec<Note>,
}

/// A line for the log.
#[derive(Debug)]
pub(in crate::source::recording) struct Note {
    /// What the other files of a series have as well: of the same, one of them tells enough.
    pub(in crate::source::recording) subject: String,
    pub(in crate::source::recording) text: String,
}

impl Found {
    pub(super) fn note(&mut self, subject: &str, text: impl Into<String>) {
        if self.notes.len() < MOST_NOTES {
            let (subject, text) = (subject.into(), text.into());
            self.notes.push(Note { subject, text });
        }
    }

    /// Notes an attribute that cannot be read.
    pub(super) fn leave_out(&mut self, name: &str, reason: impl fmt::Display) {
        let name = shown(name.as_bytes());
        self.note(&name, format!("its {name} is left out: {reason}"));
    }

    /// Particles at these coordinates, in threes.
    pub(super) fn set_positions(&mut self, numbers: &[f64]) {
        self.frame.positions = vectors(numbers);
        let count = self.frame.positions.len();
        let finite = self.frame.positions.iter().filter(|at| at.is_finite());
        let dropped = count - finite.count();
        if dropped > 0 {
            let text = format!("{dropped} of its {count} particles are not drawn: not finite");
            self.note("not finite", text);
        }
    }

    /// An attribute of the particles. Its numbers, so many for each, are asked for if its name is
    /// one that we know; the first of a role counts.
    pub(super) fn attribute(
        &mut self,
        name: &str,
        components: usize,
        numbers: impl FnOnce() -> Result<Vec<f64>, Fault>,
    ) {
        let Some(role) = Role::of(name).filter(|&role| !self.has(role)) else {
            return;
        };
        let expected = role.components();
        let result = if components == expected {
            numbers()
                .map_err(|fault| fault.to_string())
                .and_then(|numbers| self.fill(role, &numbers))
        } else {
            Err(format!(
                "it has {components} components instead of {expected}"
            ))
        };
        if let Err(reason) = result {
            self.leave_out(name, reason);
        }
    }

    fn has(&self, role: Role) -> bool {
        match role {
            Role::Id => !self.frame.ids.is_empty(),
            Role::Velocity => !self.frame.velocities.is_empty(),
            Role::Radius => self.frame.radius.is_some(),
        }
    }

    fn fill(&mut self, role: Role, numbers: &[f64]) -> Result<(), String> {
        if numbers.len() != role.components() * self.frame.positions.len() {
            return Err("there is not one for each particle".into());
        }
        match role {
            Role::Id => {
                let whole =
                    |&number: &f64| (f64::from(number as u32) == number).then_some(number as u32);
                let ids: Option<_> = numbers.iter().map(whole).collect();
                self.frame.ids = ids.ok_or("ids are whole numbers from 0 to 4294967295")?;
            }
            Role::Velocity => self.frame.velocities = vectors(numbers),
            Role::Radius => self.set_radii(numbers),
        }
        Ok(())
    }

    /// The mean of those that are radii.
    fn set_radii(&mut self, numbers: &[f64]) {
        let radii = || {
            numbers
                .iter()
                .map(|&number| number as f32)
                .filter(|&r| is_radius(r))
        };
        let (least, most) = (radii().reduce(f32::min), radii().reduce(f32::max));
        let (Some(least), Some(most)) = (least, most) else {
            return;
        };
        let sum: f64 = radii().map(f64::from).sum();
        let mean = (sum / radii().count() as f64) as f32;
        self.frame.radius = Some(mean);
        if least < most {
            let text = format!("its radii are {least} to {most}: all particles have their mean");
            self.note("radii", text);
        }
    }
}

fn vectors(numbers: &[f64]) -> Vec<Vec3> {
    let (triples, _) = numbers.as_chunks::<3>();
    let vector = |&triple: &[f64; 3]| Vec3::from(triple.map(|number| number as f32));
    triples.iter().map(vector).collect()
}
