//! What the messages since the last reading say.

use bevy::{
    ecs::{entity::EntityHashMap, message::MessageCursor, system::SystemParam},
    math::DVec3,
    prelude::*,
};

use super::messages::{Teleport, TeleportSettings, WorldShift};
use crate::settings::Checked;

/// What is to be put elsewhere now.
#[derive(Resource, Default)]
pub(crate) struct Relocated {
    shifts: MessageCursor<WorldShift>,
    teleports: MessageCursor<Teleport>,
    /// The way that the world is moved now. Unit: m.
    pub(crate) shift: Vec3,
    /// The sum of all ways: where the origin of the unshifted world is. Unit: m.
    pub(crate) total: DVec3,
    teleported: EntityHashMap<Option<Isometry3d>>,
}

/// Reads what has been written since it was read last, wherever in the frame.
pub(super) fn read(
    shifts: Res<Messages<WorldShift>>,
    teleports: Res<Messages<Teleport>>,
    mut news: ResMut<Relocated>,
) {
    let news = &mut *news;
    news.shift = Vec3::ZERO;
    for &WorldShift(way) in news.shifts.read(&shifts) {
        if way.is_finite() {
            news.shift += way;
        } else {
            bevy::utils::once!(warn!(
                "`WorldShift` is {way}; it must be finite and is ignored"
            ));
        }
    }
    news.total += news.shift.as_dvec3();
    news.teleported.clear();
    for teleport in news.teleports.read(&teleports) {
        let way = teleport.particles.filter(|way| {
            let is_finite = way.translation.is_finite() && way.rotation.is_finite();
            if !is_finite {
                bevy::utils::once!(warn!(
                    "`Teleport::particles` of entity {} is {way:?}; it must be finite and is ignored",
                    teleport.entity
                ));
            }
            is_finite
        });
        let known = news.teleported.entry(teleport.entity).or_default();
        *known = match (*known, way) {
            (Some(first), Some(then)) => Some(then * first),
            (first, then) => first.or(then),
        };
    }
}

pub(super) fn is_shifted(news: Res<Relocated>) -> bool {
    news.shift != Vec3::ZERO
}

pub(super) fn is_teleported(news: Res<Relocated>) -> bool {
    !news.teleported.is_empty()
}

/// What has been teleported, itself or with what it hangs on.
#[derive(SystemParam)]
pub(crate) struct Teleports<'w, 's> {
    news: Res<'w, Relocated>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl Teleports<'_, '_> {
    /// Whether an entity has been teleported, and the way that its particles come along.
    pub(crate) fn of(&self, entity: Entity) -> Option<Option<Isometry3d>> {
        let ancestors = self.parents.iter_ancestors(entity);
        core::iter::once(entity)
            .chain(ancestors)
            .find_map(|entity| self.news.teleported.get(&entity).copied())
    }
}

/// The speed from which on a move is a jump.
#[derive(SystemParam)]
pub(crate) struct SpeedLimit<'w, 's>(Option<Single<'w, 's, &'static Checked<TeleportSettings>>>);

impl SpeedLimit<'_, '_> {
    /// Unit: m/s.
    pub(crate) fn get(&self) -> f32 {
        let settings = self.0.as_ref();
        settings.map_or(TeleportSettings::default().speed, |it| it.speed)
    }
}
