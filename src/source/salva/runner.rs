//! Ownership of the simulated world: the app between jobs, another thread during one.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
    thread::available_parallelism,
    time::Duration,
};

use bevy::{
    ecs::entity::EntityHashMap,
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, futures::check_ready},
};
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::{
    SalvaError, SalvaMode, SalvaSettings, SalvaStatus,
    gather::{FluidEntry, SolidEntry},
    pace::Pace,
    world::{Command, Frame, Job, Relocation, Report, World},
};
use crate::{relocation::SpeedLimit, settings::Checked};

/// A world that comes back from a job, unless it panicked.
type Finished = Option<(Box<World>, Frame, Report)>;

/// The simulation as the app sees it.
#[derive(Resource, Default)]
pub(crate) struct Simulation {
    /// None while a job has it.
    world: Option<Box<World>>,
    task: Option<Task<Finished>>,
    /// Commands for the world before its next job.
    pub(crate) commands: Vec<Command>,
    /// Number of commands ever given.
    pub(crate) told: u64,
    /// Number of those passed to jobs.
    pub(crate) sent: u64,
    /// Whether salva has panicked: commands are then dropped.
    is_over: bool,
    /// The last two finished states, and one to be filled.
    pub(crate) from: Frame,
    pub(crate) to: Frame,
    spare: Frame,
    /// What has been put elsewhere while a job was in flight, with the number of commands given
    /// until then.
    relocations: Vec<(u64, Relocation)>,
    /// Solids whose surfaces take too many particles, to be logged.
    pub(crate) unsampled: Vec<u64>,
    pub(crate) pace: Pace,
    /// Solids that move faster have jumped, m/s.
    fastest: f32,
    planned: f64,
    /// How much has been simulated in lockstep beyond the app's time, s.
    ahead: f64,
    pub(crate) shown: f64,
    pub(crate) fluids: EntityHashMap<FluidEntry>,
    pub(crate) solids: EntityHashMap<SolidEntry>,
    many_threads: Option<Arc<ThreadPool>>,
    one_thread: Option<Arc<ThreadPool>>,
    /// Called at the beginning of every job, by tests.
    #[cfg(test)]
    pub(crate) before_job: Option<Arc<dyn Fn() + Send + Sync>>,
}

impl Simulation {
    /// Gives the world a command, and returns the number of commands given, this one included.
    pub(crate) fn tell(&mut self, command: Command) -> u64 {
        if !self.is_over {
            command.join(&mut self.commands);
            self.told += 1;
        }
        self.told
    }

    /// Whether nothing has been simulated yet, nor is to be.
    pub(super) fn is_untouched(&self) -> bool {
        self.world.is_none() && self.task.is_none() && self.commands.is_empty()
    }

    /// Keeps for the state that a job in flight will hand over what it does not know.
    pub(super) fn remember(&mut self, told: u64, relocation: Relocation) {
        if self.task.is_some() {
            self.relocations.push((told, relocation));
        }
    }

    fn pool(&mut self, mode: SalvaMode) -> Option<Arc<ThreadPool>> {
        let (pool, threads) = match mode {
            SalvaMode::Lockstep => (&mut self.one_thread, 1),
            SalvaMode::Background => {
                let cores = available_parallelism().map_or(1, usize::from);
                (&mut self.many_threads, cores.saturating_sub(1).max(1))
            }
        };
        if pool.is_none() {
            let builder = ThreadPoolBuilder::new()
                .num_threads(threads)
                .thread_name(|i| format!("salva {i}"));
            *pool = builder.build().ok().map(Arc::new);
        }
        pool.clone()
    }

    fn begin(&mut self, job: Job, mode: SalvaMode, status: &mut SalvaStatus) {
        if self.is_over {
            return;
        }
        for (entity, solid) in &mut self.solids {
            if core::mem::take(&mut solid.is_moved) {
                self.commands
                    .push(Command::Move(entity.to_bits(), solid.at));
            }
        }
        self.sent = self.told;
        let told = self.told;
        let mut world = self.world.take().unwrap_or_default();
        let mut frame = core::mem::take(&mut self.spare);
        let commands = core::mem::take(&mut self.commands);
        let pool = self.pool(mode);
        self.planned = f64::from(job.steps) * f64::from(job.step);
        #[cfg(test)]
        let before_job = self.before_job.clone();
        let work = move || {
            let done = catch_unwind(AssertUnwindSafe(|| {
                #[cfg(test)]
                if let Some(before_job) = before_job {
                    before_job();
                }
                world.apply(commands, told);
                let report = world.advance(&job, &mut frame);
                (world, frame, report)
            }));
            done.ok()
        };
        let work = move || match pool {
            Some(pool) => pool.install(work),
            None => work(),
        };
        match mode {
            SalvaMode::Lockstep => self.finish(work(), status),
            SalvaMode::Background => {
                let pool = AsyncComputeTaskPool::get_or_init(TaskPool::default);
                self.task = Some(pool.spawn(async move { work() }));
            }
        }
    }

    fn finish(&mut self, finished: Finished, status: &mut SalvaStatus) {
        let Some((world, mut frame, report)) = finished else {
            error!("the simulation panicked; fluids and bodies stay where they are");
            status.stopped = true;
            self.is_over = true;
            self.commands = Vec::new();
            return;
        };
        self.world = Some(world);
        for (told, relocation) in self.relocations.drain(..) {
            if told > frame.applied {
                relocation.apply(&mut frame);
            }
        }
        self.spare = core::mem::replace(&mut self.from, core::mem::replace(&mut self.to, frame));
        let simulated = f64::from(report.simulated);
        let took = report.took.as_secs_f64();
        self.pace.done(simulated, self.planned, took);
        if report.broken > 0 && status.broken == 0 {
            warn!(
                "{} particles were not finite or faster than `SalvaSettings::max_speed` and are \
                 removed; further ones are counted in `SalvaStatus::broken`",
                report.broken
            );
        }
        status.broken += report.broken as u64;
        status.step_time = report.took / report.steps.max(1);
        status.simulated = self.to.time;
        status.particles = self.to.liquids.iter().map(|it| it.ids.len()).sum();
        self.unsampled.extend(report.unsampled);
        for id in report.unmade {
            if let Some(solid) = self.solids.get_mut(&Entity::from_bits(id))
                && solid.made <= self.to.applied
            {
                solid.refused = Some(SalvaError::Mesh);
            }
        }
    }
}

/// Whether there is a simulation, which ends with a panic of salva.
pub(crate) fn goes_on(simulation: Res<Simulation>) -> bool {
    !simulation.is_over
}

/// Takes a finished job's results.
pub(crate) fn collect(
    mut simulation: ResMut<Simulation>,
    settings: Res<SalvaSettings>,
    mut status: ResMut<SalvaStatus>,
) {
    let Some(task) = &mut simulation.task else {
        return;
    };
    let finished = match settings.mode {
        SalvaMode::Background => check_ready(task),
        SalvaMode::Lockstep => Some(block_on(task)),
    };
    if let Some(finished) = finished {
        simulation.task = None;
        simulation.finish(finished, &mut status);
    }
}

/// Begins a job if one is due, and advances the time shown.
pub(crate) fn advance(
    mut simulation: ResMut<Simulation>,
    settings: Single<&Checked<SalvaSettings>>,
    mut status: ResMut<SalvaStatus>,
    fastest: SpeedLimit,
    time: Res<Time>,
) {
    simulation.fastest = fastest.get();
    let delta = if settings.paused {
        0.0
    } else {
        time.delta_secs_f64()
    };
    let is_idle = simulation.fluids.is_empty() && simulation.solids.is_empty();
    // What has been despawned is still to be removed.
    if !(is_idle && simulation.commands.is_empty()) {
        match settings.mode {
            SalvaMode::Lockstep => simulation.lockstep(delta, &settings, &mut status),
            SalvaMode::Background => simulation.background(delta, &settings, &mut status),
        }
    }
    let simulation = &*simulation;
    status.speed = simulation.pace.speed as f32;
    status.shown = simulation.shown;
    status.in_flight = simulation.task.is_some();
}

impl Simulation {
    /// All of the update's time, in steps of equal length. Pressure that had to act within far
    /// shorter ones would throw particles apart: in slow motion a whole step is done ahead, and
    /// shown bit by bit.
    fn lockstep(&mut self, delta: f64, settings: &SalvaSettings, status: &mut SalvaStatus) {
        let whole = f64::from(settings.step);
        let due = delta - self.ahead;
        if delta > 0.0 && due > 1e-6 * whole {
            let time = if due < 0.499 * whole { whole } else { due };
            let steps = (time / whole - 1e-3).ceil().max(1.0);
            self.pace = Pace::default();
            let job = self.job(settings, steps as u32, (time / steps) as f32, None);
            self.begin(job, settings.mode, status);
            self.ahead = time - due;
        } else {
            self.ahead = (-due).max(0.0);
        }
        let shown = self.to.time - self.ahead;
        self.shown = shown.clamp(self.from.time, self.to.time);
    }

    fn background(&mut self, delta: f64, settings: &SalvaSettings, status: &mut SalvaStatus) {
        self.ahead = 0.0;
        let budget = settings.budget.as_secs_f64();
        self.pace.tick(delta, budget, self.task.is_some());
        if self.task.is_none() && delta > 0.0 {
            let steps = self.pace.due(f64::from(settings.step), settings.max_steps);
            if steps > 0 {
                let budget = Some(Duration::from_secs_f64(budget));
                let job = self.job(settings, steps, settings.step, budget);
                self.begin(job, settings.mode, status);
            }
        }
        let moved = self.shown + delta * self.pace.rate;
        self.shown = moved.clamp(self.from.time, self.to.time);
    }

    /// The interpolation factor of the state shown, from the last state but one to the last, 0..1.
    pub(crate) fn share(&self) -> f32 {
        let whole = self.to.time - self.from.time;
        if whole > 0.0 {
            ((self.shown - self.from.time) / whole) as f32
        } else {
            1.0
        }
    }

    fn job(
        &self,
        settings: &SalvaSettings,
        steps: u32,
        step: f32,
        budget: Option<Duration>,
    ) -> Job {
        Job {
            steps,
            step,
            budget,
            max_substeps: settings.max_substeps,
            gravity: settings.gravity,
            max_speed: settings.max_speed,
            jump_speed: self.fastest.min(settings.max_speed),
            bounds: [settings.low, settings.high],
        }
    }
}
