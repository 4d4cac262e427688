//! Light through a liquid, exactly.
//!
//! Two ways to treat what an interface reflects tell errors of the renderer's model from errors
//! of its layers: [`Reflections::Traced`] is the truth; [`Reflections::Sky`] does as the renderer
//! does, with exact surfaces in place of its layers.

mod fresnel;
mod object;
mod path;
mod render;
mod world;

use glam::DVec3;

use crate::{Crossing, Ray};

pub use fresnel::{Meeting, meet};
pub use object::{Object, checker};
pub use path::{End, Path, Vertex};
pub use render::Picture;
pub use world::{Optics, Sky, World};

/// A ray does not meet again the surface that it starts on: crossings nearer than this (m) do
/// not count.
pub const SKIN: f64 = 1e-9;

/// What becomes of the light that an interface reflects, unless it reflects all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reflections {
    /// It is followed like the light that goes on.
    Traced,
    /// It comes from the sky, whatever is in its way.
    Sky,
}

/// Follows light backwards from the eye.
#[derive(Clone, Copy)]
pub struct Tracer<'a> {
    /// What light meets.
    pub world: World<'a>,
    /// What the liquid does to it.
    pub optics: Optics,
    /// How many interfaces a path meets before it sees the background through all that follow.
    pub interfaces: u32,
    /// What becomes of reflected light.
    pub reflections: Reflections,
    /// Whether a body that was left is not entered again, as with the renderer's layers, of
    /// which each has one front. Bodies are numbered below 64.
    pub each_body_once: bool,
    /// Branches with less than this part of the pixel's light see the background instead of a
    /// surface.
    pub faintest: f64,
}

/// A ray on its way.
#[derive(Clone, Copy)]
struct State {
    ray: Ray,
    /// The body that it is in.
    within: Option<usize>,
    /// Interfaces to go.
    budget: u32,
    /// Bit by bit the bodies that are not entered any more.
    barred: u64,
}

/// What a ray meets next.
enum Next<'a> {
    Interface(Crossing),
    Opaque(f64, &'a Object),
    Nothing,
}

impl<'a> Tracer<'a> {
    /// All reflections, up to 16 interfaces deep.
    pub fn truth(world: World<'a>, optics: Optics) -> Self {
        Self {
            world,
            optics,
            interfaces: 16,
            reflections: Reflections::Traced,
            each_body_once: false,
            faintest: 1e-5,
        }
    }

    /// What the renderer computes where its layers are perfect: four interfaces, reflections of
    /// the sky.
    pub fn renderer(world: World<'a>, optics: Optics) -> Self {
        Self {
            interfaces: 4,
            reflections: Reflections::Sky,
            faintest: 0.0,
            ..Self::truth(world, optics)
        }
    }

    /// Light that comes back along a ray.
    pub fn radiance(&self, ray: Ray) -> DVec3 {
        self.light(self.start(ray), 1.0)
    }

    fn start(&self, ray: Ray) -> State {
        State {
            ray,
            within: self.world.surface.inside(ray.origin),
            budget: self.interfaces,
            barred: 0,
        }
    }

    fn light(&self, state: State, weight: f64) -> DVec3 {
        if state.budget == 0 || weight < self.faintest {
            return self.background(&state.ray);
        }
        let crossing = match self.next(&state) {
            Next::Interface(crossing) => crossing,
            Next::Opaque(t, object) => {
                return self.left_after(&state, t) * (object.color)(state.ray.at(t));
            }
            Next::Nothing => return (self.world.sky)(state.ray.direction),
        };
        let at = self.meet(&state, &crossing);
        let left = self.left_after(&state, crossing.t);
        let weight = weight * left.max_element();
        let sky_only = self.reflections == Reflections::Sky;
        let followed = if at.refracted.is_none() {
            // Inside, the renderer follows total reflection too.
            state.within.is_some() || !sky_only
        } else {
            !sky_only
        };
        let reflected = if followed {
            let state = self.reflected(&state, &crossing, at.reflected);
            self.light(state, weight * at.reflectance)
        } else {
            (self.world.sky)(at.reflected)
        };
        let Some(direction) = at.refracted else {
            return left * reflected;
        };
        let passes = 1.0 - at.reflectance;
        let refracted = self.light(
            self.refracted(&state, &crossing, direction),
            weight * passes,
        );
        left * (at.reflectance * reflected + passes * refracted)
    }

    /// The nearest opaque thing, or the sky, through all liquid.
    fn background(&self, ray: &Ray) -> DVec3 {
        match self.opaque(ray) {
            Some((t, object)) => (object.color)(ray.at(t)),
            None => (self.world.sky)(ray.direction),
        }
    }

    fn opaque(&self, ray: &Ray) -> Option<(f64, &'a Object)> {
        let objects = self.world.objects.iter();
        let met = objects.filter_map(|object| Some((object.meets(ray)?, object)));
        met.min_by(|(a, _), (b, _)| a.total_cmp(b))
    }

    fn next(&self, state: &State) -> Next<'a> {
        let mut crossings = Vec::new();
        self.world.surface.crossings(&state.ray, &mut crossings);
        let wanted = |crossing: &&Crossing| {
            crossing.t > SKIN
                && match state.within {
                    Some(body) => !crossing.entering && crossing.body == body,
                    None => crossing.entering && state.barred >> crossing.body & 1 == 0,
                }
        };
        let crossing = crossings.iter().find(wanted);
        match (crossing, self.opaque(&state.ray)) {
            (Some(crossing), Some((t, object))) if t < crossing.t => Next::Opaque(t, object),
            (Some(crossing), _) => Next::Interface(*crossing),
            (None, Some((t, object))) => Next::Opaque(t, object),
            (None, None) => Next::Nothing,
        }
    }

    fn meet(&self, state: &State, crossing: &Crossing) -> Meeting {
        let n = self.optics.refractive_index;
        let (normal, eta) = match state.within {
            Some(_) => (-crossing.normal, n),
            None => (crossing.normal, 1.0 / n),
        };
        meet(state.ray.direction, normal, eta)
    }

    fn left_after(&self, state: &State, t: f64) -> DVec3 {
        match state.within {
            Some(_) => self.optics.transmitted(t),
            None => DVec3::ONE,
        }
    }

    fn reflected(&self, state: &State, crossing: &Crossing, direction: DVec3) -> State {
        State {
            ray: Ray::new(state.ray.at(crossing.t), direction),
            budget: state.budget - 1,
            ..*state
        }
    }

    fn refracted(&self, state: &State, crossing: &Crossing, direction: DVec3) -> State {
        let leaves = state.within.is_some();
        let barred = u64::from(leaves && self.each_body_once) << crossing.body;
        State {
            within: (!leaves).then_some(crossing.body),
            barred: state.barred | barred,
            ..self.reflected(state, crossing, direction)
        }
    }
}
