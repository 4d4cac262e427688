//! The particle component, and the system that shapes fluids.

use bevy::prelude::*;

use crate::{
    material::FluidMaterial,
    relocation::{self, Relocated, Teleports},
    schedule::FluidSystems,
    settings::Checked,
    shape::{FluidSplats, RADIUS, ShapeTimes, ShapeWorkspace, SurfaceKernel},
};

/// A fluid: particles of one radius, as columns. What is known of particle i is item i of each.
///
/// A column other than the positions is empty where nothing is known; one of another length than
/// the positions is ignored, which is logged once.
///
/// A fluid is shaped again only when this component, or the [`SurfaceKernel`] on its entity,
/// changes, and a camera sees it; an unchanged or unseen fluid costs nothing. Unseen is what is
/// hidden, on no render layer of an active camera with [`ScreenSpaceFluid`](crate::settings::ScreenSpaceFluid),
/// or out of their views.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default, Clone)]
#[require(FluidMaterial, SurfaceKernel, ShapedFluid, Transform, Visibility)]
pub struct FluidParticles {
    /// Centres. Unit: m, default: none. Particles that are not finite are dropped and counted in
    /// [`ShapedFluid::dropped`].
    pub positions: Vec<Vec3>,
    /// Velocities. Unit: m/s, default: none. For motion vectors of particles without ids.
    pub velocities: Vec<Vec3>,
    /// Ids, each of one particle for as long as it lives, by which it is found again in another
    /// frame. Default: none. Motion vectors follow them.
    pub ids: Vec<u32>,
    /// The space of the positions, the velocities and the radius. Default: [`ParticleSpace::Local`].
    pub space: ParticleSpace,
    /// Radius of every particle, half the distance between neighbours at rest. Unit: m, range
    /// 1e-9..=1e9, default 0, valid only without particles. Particles of an invalid radius are not
    /// drawn; that is logged once.
    #[reflect(@RADIUS)]
    pub radius: f32,
}

impl FluidParticles {
    /// A fluid of particles at `positions`, each of `radius`.
    pub fn new(positions: Vec<Vec3>, radius: f32) -> Self {
        Self {
            positions,
            radius,
            ..default()
        }
    }

    /// The transform from the particles' space to the world, for an entity at `entity`.
    pub fn world_from_particles(&self, entity: &GlobalTransform) -> GlobalTransform {
        match self.space {
            ParticleSpace::Local => *entity,
            ParticleSpace::World => GlobalTransform::IDENTITY,
        }
    }

    /// Moves particles that are in the world's space.
    fn carry(&mut self, way: &Isometry3d) {
        for position in &mut self.positions {
            *position = *way * *position;
        }
        for velocity in &mut self.velocities {
            *velocity = way.rotation * *velocity;
        }
    }

    /// The velocities, if there is one for each particle.
    pub(crate) fn whole_velocities(&self) -> &[Vec3] {
        self.whole(&self.velocities)
    }

    /// The ids, if there is one for each particle.
    pub(crate) fn whole_ids(&self) -> &[u32] {
        self.whole(&self.ids)
    }

    fn whole<'a, T>(&self, column: &'a [T]) -> &'a [T] {
        let is_whole = column.len() == self.positions.len();
        if is_whole { column } else { &[] }
    }

    /// The first column of a wrong length, by its name and its length.
    fn misfit(&self) -> Option<(&'static str, usize)> {
        [
            ("velocities", self.velocities.len()),
            ("ids", self.ids.len()),
        ]
        .into_iter()
        .find(|&(_, len)| len != 0 && len != self.positions.len())
    }
}

/// The space in which a fluid's particles are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum ParticleSpace {
    /// The space of their entity: its transform moves, turns and scales them.
    #[default]
    Local,
    /// The world: the transform of their entity leaves them where they are. They come along with a
    /// [`WorldShift`](crate::relocation::WorldShift).
    World,
}

/// The result of shaping a fluid, when a camera saw it last. The splats themselves go to the render
/// world.
#[derive(Component, Clone, Debug, Default)]
pub struct ShapedFluid {
    pub(crate) splats: FluidSplats,
    fresh: bool,
    /// Whether the particles or the kernel have changed since.
    is_stale: bool,
    /// Whether no camera sees it: it need not be shaped.
    is_unseen: bool,
    generation: u64,
    /// Why the fluid is not drawn; logged when it changes.
    error: Option<String>,
    /// The column that is ignored; logged when it becomes another.
    misfit: Option<&'static str>,
}

impl ShapedFluid {
    /// Number of bulk particles near a surface.
    pub fn bulk(&self) -> u32 {
        self.splats.bulk
    }

    /// Number of bulk particles that no visible surface passes through.
    pub fn interior(&self) -> u32 {
        self.splats.interior
    }

    /// Number of spray particles.
    pub fn spray(&self) -> u32 {
        self.splats.spray
    }

    /// Number of particles dropped because their position is not finite.
    pub fn dropped(&self) -> u32 {
        self.splats.dropped
    }

    /// How long the last shaping took.
    pub fn times(&self) -> ShapeTimes {
        self.splats.times
    }

    /// How many times the fluid has been shaped.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Whether the splats are older than the particles.
    pub(crate) fn is_stale(&self) -> bool {
        self.is_stale
    }

    /// Tells whether no camera sees the fluid.
    pub(crate) fn set_unseen(&mut self, is_unseen: bool) {
        self.is_unseen = is_unseen;
    }

    /// Whether the splats are new since the last call.
    pub(crate) fn take_fresh(&mut self) -> bool {
        core::mem::take(&mut self.fresh)
    }
}

/// Shapes every fluid in sight whose particles or kernel have changed since it was shaped last.
pub(crate) fn shape_fluids(
    mut fluids: Query<(
        Entity,
        Ref<FluidParticles>,
        Ref<Checked<SurfaceKernel>>,
        &mut ShapedFluid,
    )>,
    mut workspace: Local<ShapeWorkspace>,
) {
    for (entity, particles, kernel, mut shaped) in &mut fluids {
        let known = shaped.bypass_change_detection();
        known.is_stale |= particles.is_changed() || kernel.is_changed();
        if !known.is_stale || known.is_unseen {
            continue;
        }
        let misfit = particles.misfit();
        if let Some((column, len)) = misfit.filter(|&(column, _)| shaped.misfit != Some(column)) {
            let count = particles.positions.len();
            warn!("fluid {entity}: {count} particles and {len} {column}, which are ignored");
        }
        shaped.misfit = misfit.map(|(column, _)| column);
        let splats = &mut shaped.splats;
        let result = workspace.shape(&particles.positions, particles.radius, &kernel, splats);
        let error = result.err().map(|error| error.to_string());
        if let Some(error) = error.as_ref().filter(|_| error != shaped.error) {
            warn!("fluid {entity} is not drawn: {error}");
        }
        shaped.error = error;
        shaped.is_stale = false;
        shaped.fresh = true;
        shaped.generation += 1;
    }
}

/// Moves a fluid's particles, if they are in the world's space. For those who watch for particles
/// that others have written, this is no change.
fn carry(particles: &mut Mut<FluidParticles>, shaped: &mut Mut<ShapedFluid>, way: &Isometry3d) {
    if particles.space == ParticleSpace::World && !particles.positions.is_empty() {
        particles.bypass_change_detection().carry(way);
        shaped.bypass_change_detection().is_stale = true;
    }
}

fn shift(mut fluids: Query<(&mut FluidParticles, &mut ShapedFluid)>, relocated: Res<Relocated>) {
    let way = Isometry3d::from_translation(relocated.shift);
    for (mut particles, mut shaped) in &mut fluids {
        carry(&mut particles, &mut shaped, &way);
    }
}

fn teleport(
    mut fluids: Query<(Entity, &mut FluidParticles, &mut ShapedFluid)>,
    teleports: Teleports,
) {
    for (entity, mut particles, mut shaped) in &mut fluids {
        if let Some(Some(way)) = teleports.of(entity) {
            carry(&mut particles, &mut shaped, &way);
        }
    }
}

/// Takes particles along when they or the world are put elsewhere.
struct CarryPlugin;

impl Plugin for CarryPlugin {
    fn build(&self, app: &mut App) {
        relocation::on_shift(app, shift);
        relocation::on_teleport(app, teleport);
    }
}

/// Adds the systems that take particles along. Each plugin that keeps some in the world does so, as
/// it may be the only one.
pub(crate) fn carried(app: &mut App) {
    if !app.is_plugin_added::<CarryPlugin>() {
        app.add_plugins(CarryPlugin);
    }
}

pub(crate) fn plugin(app: &mut App) {
    carried(app);
    app.add_systems(PostUpdate, shape_fluids.in_set(FluidSystems::Shape));
}
