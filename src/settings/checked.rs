//! Checked copies of components and resources, and the system that keeps them.

use core::marker::PhantomData;

use bevy::{ecs::resource::IsResource, prelude::*};

use super::Settings;
use crate::schedule::{self, Relocations};

/// A valid copy of the settings `C` on the same entity: what draws and simulates reads this.
#[derive(Component, Clone, Debug, Default, Deref)]
pub struct Checked<C: Settings> {
    #[deref]
    settings: C,
    /// The setting named by the last warning: it is not named again until all are valid, as a value
    /// that is animated out of range would be named in every frame.
    warned: Option<String>,
}

impl<C: Settings> Checked<C> {
    /// Copies `settings`. Only valid settings that differ from those before count as a change.
    fn update(mut checked: Mut<Self>, settings: &C, owner: impl FnOnce() -> String) {
        let mut copy = settings.clone();
        let error = copy.clamp().err();
        if error.as_ref().map(|error| &error.name) != checked.warned.as_ref() {
            if let Some(error) = &error {
                warn!("{}{error}; a valid value is taken instead", owner());
            }
            checked.bypass_change_detection().warned = error.map(|error| error.name);
        }
        if checked.settings != copy {
            checked.settings = copy;
        }
    }
}

/// Keeps the [`Checked`] copy of `C`, in `FluidSystems::Check`. `C` must require it.
pub(crate) fn check<C: Settings + Component>(app: &mut App) {
    if !app.is_plugin_added::<CheckPlugin<C>>() {
        app.add_plugins(CheckPlugin::<C>(PhantomData));
    }
}

struct CheckPlugin<C>(PhantomData<fn() -> C>);

impl<C: Settings + Component> Plugin for CheckPlugin<C> {
    fn build(&self, app: &mut App) {
        schedule::order(app);
        app.add_observer(check_inserted::<C>)
            .add_observer(forget_removed::<C>)
            .add_systems(PostUpdate, check_changed::<C>.in_set(Relocations::Checked));
    }
}

type Checking<'a, C> = (Entity, &'a C, &'a mut Checked<C>, Has<IsResource>);

fn check_one<C: Settings + Component>(
    (entity, settings, checked, is_resource): (Entity, &C, Mut<Checked<C>>, bool),
) {
    Checked::update(checked, settings, || {
        if is_resource {
            String::new()
        } else {
            format!("entity {entity}: ")
        }
    });
}

fn check_changed<C: Settings + Component>(mut changed: Query<Checking<'static, C>, Changed<C>>) {
    changed.iter_mut().for_each(check_one);
}

/// Settings that are inserted after the system has run are drawn in the same frame.
fn check_inserted<C: Settings + Component>(
    inserted: On<Insert, C>,
    mut all: Query<Checking<'static, C>>,
) {
    if let Ok(one) = all.get_mut(inserted.entity) {
        check_one(one);
    }
}

fn forget_removed<C: Settings + Component>(removed: On<Remove, C>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<Checked<C>>();
}
