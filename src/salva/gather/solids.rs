//! Boundaries and bodies: new ones, changed ones, and those that have moved.

use bevy::{prelude::*, transform::helper::TransformHelper};

use crate::{
    complaints::Complaints,
    salva::{
        SalvaBody, SalvaBoundary, SalvaError, SalvaLoad, SalvaShape,
        runner::Simulation,
        shape::{geometry, split},
        world::{Command, Contact, Motion},
    },
};

/// What is known of a solid that is simulated.
pub(crate) struct SolidEntry {
    mesh: Option<AssetId<Mesh>>,
    scale: Mat3,
    /// Where a boundary was last, or where a body was written to be.
    pub(crate) at: Isometry3d,
    /// How many things the world must have been told to know it there.
    pub(crate) told: u64,
}

type Solids<'w, 's, T> = Query<
    'w,
    's,
    (
        Entity,
        Ref<'static, T>,
        Option<&'static Mesh3d>,
        Has<SalvaLoad>,
    ),
>;

/// Tells of boundaries and bodies that are new, other than they were, elsewhere, or gone.
pub(crate) fn gather_solids(
    mut simulation: ResMut<Simulation>,
    boundaries: Solids<SalvaBoundary>,
    bodies: Solids<SalvaBody>,
    mut gone: RemovedComponents<SalvaBoundary>,
    mut gone_bodies: RemovedComponents<SalvaBody>,
    meshes: Option<Res<Assets<Mesh>>>,
    transforms: TransformHelper,
    mut complaints: Local<Complaints>,
    mut settings_complaints: Local<Complaints>,
) {
    for entity in gone.read().chain(gone_bodies.read()) {
        complaints.forget(entity);
        settings_complaints.forget(entity);
        if simulation.solids.remove(&entity).is_some() {
            simulation.tell(Command::RemoveSolid(entity.to_bits()));
        }
    }
    for id in core::mem::take(&mut simulation.unsampled) {
        let entity = Entity::from_bits(id);
        if let Some(error) = settings_complaints.of(entity, Err(SalvaError::Surface)) {
            warn!("boundary {entity}: {error}");
        }
    }
    let meshes = meshes.as_deref();
    for (entity, boundary, mesh, feels) in &boundaries {
        if boundary.is_changed()
            && let Some(error) = settings_complaints.of(entity, boundary.validate())
        {
            warn!("boundary {entity}: {error}; it is simulated with the nearest that makes sense");
        }
        let own = boundary.clamped();
        let solid = NewSolid {
            shape: own.shape,
            motion: Motion::Kinematic,
            contact: Contact {
                friction: own.friction,
                restitution: own.restitution,
            },
            feels,
            is_new: boundary.is_changed(),
        };
        let checked = simulation.take_solid(entity, solid, mesh, meshes, &transforms);
        if let Some(error) = complaints.of(entity, checked) {
            warn!("boundary {entity} is not simulated: {error}");
        }
    }
    for (entity, body, mesh, feels) in &bodies {
        if body.is_changed()
            && let Some(error) = settings_complaints.of(entity, body.validate())
        {
            warn!("body {entity}: {error}; it is simulated with the nearest that makes sense");
        }
        let own = body.clamped();
        let solid = NewSolid {
            shape: own.shape,
            motion: Motion::Dynamic {
                density: own.density,
                velocity: own.velocity,
                angular_velocity: own.angular_velocity,
            },
            contact: Contact {
                friction: own.friction,
                restitution: own.restitution,
            },
            feels,
            is_new: body.is_changed(),
        };
        let checked = simulation.take_solid(entity, solid, mesh, meshes, &transforms);
        if let Some(error) = complaints.of(entity, checked) {
            warn!("body {entity} is not simulated: {error}");
        }
    }
}

struct NewSolid {
    shape: SalvaShape,
    motion: Motion,
    contact: Contact,
    feels: bool,
    is_new: bool,
}

impl Simulation {
    fn take_solid(
        &mut self,
        entity: Entity,
        new: NewSolid,
        mesh: Option<&Mesh3d>,
        meshes: Option<&Assets<Mesh>>,
        transforms: &TransformHelper,
    ) -> Result<(), SalvaError> {
        let id = entity.to_bits();
        let transform = transforms.compute_global_transform(entity);
        let (at, scale) = split(&transform.map_err(|_| SalvaError::Transform)?)?;
        let is_mesh = new.shape == SalvaShape::Mesh;
        let mesh_id = mesh.filter(|_| is_mesh).map(|mesh| mesh.0.id());
        if let Some(known) = self.solids.get_mut(&entity)
            && !new.is_new
            && known.mesh == mesh_id
            && known.scale.abs_diff_eq(scale, 1e-4)
        {
            if known.at == at {
                return Ok(());
            }
            known.at = at;
            if matches!(new.motion, Motion::Kinematic) {
                self.tell(Command::Move(id, at));
            } else {
                let told = self.tell(Command::Jump(id, at));
                if let Some(known) = self.solids.get_mut(&entity) {
                    known.told = told;
                }
            }
            return Ok(());
        }
        let data = mesh_id.and_then(|id| meshes?.get(id));
        if mesh_id.is_some() && data.is_none() {
            // It may still be loading.
            return Ok(());
        }
        let is_body = !matches!(new.motion, Motion::Kinematic);
        let geometry = geometry(new.shape, scale, data, is_body);
        let geometry = geometry.inspect_err(|_| {
            if self.solids.remove(&entity).is_some() {
                self.tell(Command::RemoveSolid(id));
            }
        })?;
        let told = self.tell(Command::Solid {
            id,
            geometry,
            motion: new.motion,
            contact: new.contact,
            at,
            feels: new.feels,
        });
        let entry = SolidEntry {
            mesh: mesh_id,
            scale,
            at,
            told,
        };
        self.solids.insert(entity, entry);
        Ok(())
    }
}
