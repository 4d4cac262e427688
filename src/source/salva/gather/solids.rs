//! Boundaries and bodies: new ones, changed ones, and those that have moved.

use bevy::{
    ecs::message::MessageCursor, math::Vec3A, prelude::*, transform::helper::TransformHelper,
};

use crate::{
    settings::Checked,
    source::salva::{
        SalvaBody, SalvaBoundary, SalvaError, SalvaLoad, SalvaShape,
        error::Warned,
        runner::Simulation,
        shape::{recipe, split},
        world::{Command, Contact, Motion, Traits},
    },
};

/// State of a solid that is simulated or refused.
pub(crate) struct SolidEntry {
    form: Form,
    traits: Traits,
    /// Where a boundary was last, or where a body was written to be.
    pub(crate) at: Isometry3d,
    /// Number of commands that the world must have applied to have it there.
    pub(crate) told: u64,
    /// The same for its shape.
    pub(crate) made: u64,
    /// Whether a boundary's place is to be sent with the next job.
    pub(crate) is_moved: bool,
    /// Whether it has been inserted again.
    is_anew: bool,
    /// Whether it has been put elsewhere.
    pub(crate) jumps: bool,
    /// By how much its place may differ by rounding since the world was shifted, m.
    slack: f32,
    /// Why its form was refused: it is not tried again.
    pub(crate) refused: Option<SalvaError>,
}

impl SolidEntry {
    /// The world is shifted.
    pub(crate) fn shift(&mut self, by: Vec3) {
        let size = Vec3::from(self.at.translation).abs() + by.abs();
        self.at.translation += Vec3A::from(by);
        self.slack += 4.0 * f32::EPSILON * size.max_element();
    }

    /// Whether `at` is another place than it is known at. Several shifts may have been summed up in
    /// another order than the transform's.
    fn is_moved_to(&mut self, at: Isometry3d) -> bool {
        let slack = core::mem::take(&mut self.slack);
        let is_turned = self.at.rotation != at.rotation;
        is_turned || self.at.translation.distance(at.translation) > slack
    }
}

/// What a solid's shape is made of.
#[derive(Clone, Copy)]
struct Form {
    shape: SalvaShape,
    mesh: Option<AssetId<Mesh>>,
    scale: Mat3,
    is_body: bool,
}

impl Form {
    fn is_like(&self, other: &Self) -> bool {
        self.shape == other.shape
            && self.mesh == other.mesh
            && self.is_body == other.is_body
            && self.scale.abs_diff_eq(other.scale, 1e-4)
    }
}

/// Restarts a solid that is inserted again, unlike one that is merely changed.
pub(crate) fn start_anew<T: Component>(
    inserted: On<Insert, T>,
    mut simulation: ResMut<Simulation>,
) {
    if let Some(known) = simulation.solids.get_mut(&inserted.entity) {
        known.is_anew = true;
    }
}

type Solids<'w, 's, T, F = ()> = Query<
    'w,
    's,
    (
        Entity,
        &'static Checked<T>,
        Option<&'static Mesh3d>,
        Has<SalvaLoad>,
    ),
    F,
>;

/// Sends new, changed, moved and removed boundaries and bodies to the simulation.
pub(crate) fn gather_solids(
    mut simulation: ResMut<Simulation>,
    boundaries: Solids<SalvaBoundary, Without<SalvaBody>>,
    bodies: Solids<SalvaBody>,
    mut gone: RemovedComponents<SalvaBoundary>,
    mut gone_bodies: RemovedComponents<SalvaBody>,
    meshes: Option<Res<Assets<Mesh>>>,
    changes: Option<Res<Messages<AssetEvent<Mesh>>>>,
    mut cursor: Local<MessageCursor<AssetEvent<Mesh>>>,
    transforms: TransformHelper,
    mut warned: Local<Warned>,
    mut warned_surfaces: Local<Warned>,
) {
    for entity in gone.read().chain(gone_bodies.read()) {
        warned.forget(entity);
        warned_surfaces.forget(entity);
        if simulation.solids.remove(&entity).is_some() {
            simulation.tell(Command::RemoveSolid(entity.to_bits()));
        }
    }
    for id in core::mem::take(&mut simulation.unsampled) {
        let entity = Entity::from_bits(id);
        if let Some(error) = warned_surfaces.news(entity, Err(SalvaError::Surface)) {
            warn!("boundary {entity}: {error}");
        }
    }
    if let Some(changes) = changes {
        for change in cursor.read(&changes) {
            if let AssetEvent::Modified { id } = change {
                simulation.try_again(*id);
            }
        }
    }
    let meshes = meshes.as_deref();
    for (entity, boundary, mesh, feels) in &boundaries {
        let traits = Traits {
            motion: Motion::Kinematic,
            contact: Contact {
                friction: boundary.friction,
                restitution: boundary.restitution,
            },
            feels,
        };
        let taken =
            simulation.take_solid(entity, boundary.shape, traits, mesh, meshes, &transforms);
        if let Some(error) = warned.news(entity, taken) {
            warn!("boundary {entity} is not simulated: {error}");
        }
    }
    for (entity, body, mesh, feels) in &bodies {
        let traits = Traits {
            motion: Motion::Dynamic {
                density: body.density,
                velocity: body.velocity,
                angular_velocity: body.angular_velocity,
            },
            contact: Contact {
                friction: body.friction,
                restitution: body.restitution,
            },
            feels,
        };
        let taken = simulation.take_solid(entity, body.shape, traits, mesh, meshes, &transforms);
        if let Some(error) = warned.news(entity, taken) {
            warn!("body {entity} is not simulated: {error}");
        }
    }
}

impl Simulation {
    /// Retries what was refused for a mesh that has changed.
    fn try_again(&mut self, mesh: AssetId<Mesh>) {
        for known in self.solids.values_mut() {
            known.is_anew |= known.refused.is_some() && known.form.mesh == Some(mesh);
        }
    }

    fn take_solid(
        &mut self,
        entity: Entity,
        shape: SalvaShape,
        traits: Traits,
        mesh: Option<&Mesh3d>,
        meshes: Option<&Assets<Mesh>>,
        transforms: &TransformHelper,
    ) -> Result<(), SalvaError> {
        let transform = transforms.compute_global_transform(entity);
        let place = transform.map_err(|_| SalvaError::Transform);
        let (at, scale) = match place.and_then(|place| split(&place)) {
            Ok(place) => place,
            Err(error) => {
                // What has no place or no extent is not where it was either.
                if self.solids.remove(&entity).is_some() {
                    self.tell(Command::RemoveSolid(entity.to_bits()));
                }
                return Err(error);
            }
        };
        let is_mesh = shape == SalvaShape::Mesh;
        let form = Form {
            shape,
            mesh: mesh.filter(|_| is_mesh).map(|mesh| mesh.0.id()),
            scale,
            is_body: traits.motion != Motion::Kinematic,
        };
        let known = self.solids.get(&entity).filter(|known| !known.is_anew);
        if known.is_some_and(|known| known.form.is_like(&form)) {
            return self.go_on(entity, traits, at);
        }
        let data = form.mesh.and_then(|id| meshes?.get(id));
        if form.mesh.is_some() && data.is_none() {
            // It may still be loading.
            return Ok(());
        }
        // A body of another shape or size keeps its motion, unless it is put elsewhere too.
        let goes_on = known.filter(|known| {
            let is_there = known.refused.is_none() && known.told <= self.sent;
            is_there && form.is_body && is_near(known.at, at)
        });
        let told_before = goes_on.map(|known| known.told);
        self.make(entity, form, data, traits, at, told_before)
    }

    /// A solid whose form has not changed.
    fn go_on(&mut self, entity: Entity, traits: Traits, at: Isometry3d) -> Result<(), SalvaError> {
        let id = entity.to_bits();
        let Some(known) = self.solids.get_mut(&entity) else {
            return Ok(());
        };
        if let Some(error) = known.refused {
            return Err(error);
        }
        let jumps = core::mem::take(&mut known.jumps);
        let is_moved = known.is_moved_to(at);
        known.at = at;
        known.is_moved |= is_moved && !known.form.is_body;
        let jumps = is_moved && (known.form.is_body || jumps);
        if core::mem::replace(&mut known.traits, traits) != traits {
            self.tell(Command::Alter(id, traits));
        }
        if jumps {
            let told = self.tell(Command::Jump(id, at));
            if let Some(known) = self.solids.get_mut(&entity) {
                known.told = told;
            }
        }
        Ok(())
    }

    /// Sends a solid of a new form. `told_before` is the number of commands up to its place, if it
    /// goes on.
    fn make(
        &mut self,
        entity: Entity,
        form: Form,
        mesh: Option<&Mesh>,
        traits: Traits,
        at: Isometry3d,
        told_before: Option<u64>,
    ) -> Result<(), SalvaError> {
        let id = entity.to_bits();
        let recipe = recipe(form.shape, form.scale, mesh, form.is_body);
        let refused = recipe.as_ref().err().copied();
        let command = match recipe {
            Ok(recipe) => Some(Command::Solid {
                id,
                recipe,
                traits,
                at,
                goes_on: told_before.is_some(),
            }),
            // There may be an older form of it.
            Err(_) => self
                .solids
                .get(&entity)
                .filter(|known| known.refused.is_none())
                .map(|_| Command::RemoveSolid(id)),
        };
        let made = command.map_or(self.told, |command| self.tell(command));
        let entry = SolidEntry {
            form,
            traits,
            at,
            told: told_before.unwrap_or(made),
            made,
            is_moved: false,
            is_anew: false,
            jumps: false,
            slack: 0.0,
            refused,
        };
        self.solids.insert(entity, entry);
        refused.map_or(Ok(()), Err)
    }
}

/// Two places that are the same but for rounding when a scale is taken out.
fn is_near(a: Isometry3d, b: Isometry3d) -> bool {
    a.translation == b.translation && a.rotation.abs_diff_eq(b.rotation, 1e-4)
}
