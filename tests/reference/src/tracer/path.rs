//! The one path that the renderer follows: through each interface, or back where it reflects all.

use glam::DVec3;

use super::{Next, Tracer};
use crate::Ray;

/// A point where a path meets an interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Where, m.
    pub position: DVec3,
    /// Unit normal out of the liquid.
    pub normal: DVec3,
    /// Which body.
    pub body: usize,
    /// Whether the path comes into the liquid or would leave it.
    pub entering: bool,
    /// Whether all light was reflected.
    pub totally_reflected: bool,
}

/// Why a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It meets nothing more.
    Sky,
    /// It meets something opaque.
    Opaque,
    /// It has met as many interfaces as it may.
    Budget,
}

/// A path through the liquid.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The interfaces that it meets, in order.
    pub vertices: Vec<Vertex>,
    /// What is left for the background: from the last interface on; if something opaque ends the
    /// path, from there.
    pub exit: Ray,
    /// The fraction of the background's light that comes back.
    pub transmission: DVec3,
    /// Why it ends.
    pub end: End,
}

impl Tracer<'_> {
    /// Follows a ray. What is reflected on the way only takes its part from the transmission.
    pub fn path(&self, ray: Ray) -> Path {
        let mut state = self.start(ray);
        let mut vertices = Vec::new();
        let mut transmission = DVec3::ONE;
        let end = loop {
            if state.budget == 0 {
                break End::Budget;
            }
            let crossing = match self.next(&state) {
                Next::Interface(crossing) => crossing,
                Next::Opaque(t, _) => {
                    transmission *= self.left_after(&state, t);
                    state.ray.origin = state.ray.at(t);
                    break End::Opaque;
                }
                Next::Nothing => break End::Sky,
            };
            let at = self.meet(&state, &crossing);
            transmission *= self.left_after(&state, crossing.t);
            vertices.push(Vertex {
                position: state.ray.at(crossing.t),
                normal: crossing.normal,
                body: crossing.body,
                entering: crossing.entering,
                totally_reflected: at.refracted.is_none(),
            });
            state = match at.refracted {
                Some(direction) => {
                    transmission *= 1.0 - at.reflectance;
                    self.refracted(&state, &crossing, direction)
                }
                None => self.reflected(&state, &crossing, at.reflected),
            };
        };
        Path {
            vertices,
            exit: state.ray,
            transmission,
            end,
        }
    }
}
