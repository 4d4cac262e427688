//! The picture that replaces the window, and the record of the GPU's validation errors.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::{
    camera::RenderTarget,
    image::Image,
    prelude::*,
    render::{
        render_resource::{Extent3d, TextureFormat, TextureUsages},
        renderer::RenderDevice,
    },
    window::WindowRef,
};

/// The longest side that every adapter Bevy runs on can render.
pub(crate) const MAX_SIDE: u32 = 8192;

pub(crate) fn is_valid_size(size: UVec2) -> bool {
    size.min_element() > 0 && size.max_element() <= MAX_SIDE
}

/// The picture of a stage without a window. Cameras that would render to the primary window render
/// here.
#[derive(Resource, Debug, Clone)]
pub struct Stage {
    /// `Rgba8UnormSrgb`; copied out with [`capture`](crate::capture).
    pub image: Handle<Image>,
    /// Width and height in pixels; changed with [`resize`](crate::resize).
    pub size: UVec2,
}

impl Stage {
    /// Whether a window can be opened: on Linux, whether `DISPLAY` or `WAYLAND_DISPLAY` is set.
    pub fn has_display() -> bool {
        let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
        !cfg!(target_os = "linux") || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
    }
}

/// All errors that wgpu's validation has reported so far, in order.
#[derive(Resource, Clone, Default)]
pub(crate) struct GpuErrors(Arc<Mutex<Vec<String>>>);

impl GpuErrors {
    pub(crate) fn all(&self) -> Vec<String> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    fn listen_to(&self, device: &RenderDevice) {
        let errors = self.clone();
        device
            .wgpu_device()
            .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
                error!("{error}");
                let mut errors = errors.0.lock().unwrap_or_else(PoisonError::into_inner);
                errors.push(error.to_string());
            }));
    }
}

/// Sets up the [`Stage`], points cameras at it and records the GPU's errors.
pub(crate) struct StagePlugin {
    pub(crate) size: UVec2,
}

impl Plugin for StagePlugin {
    fn build(&self, app: &mut App) {
        let mut image = Image::new_target_texture(1, 1, TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.label = Some("stage");
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        image.texture_descriptor.size = extent(self.size);
        // Only ever drawn to: without data nothing is uploaded, here and on every resize.
        image.data = None;
        image.copy_on_resize = false;
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        app.insert_resource(Stage {
            image,
            size: self.size,
        })
        .init_resource::<GpuErrors>()
        .add_observer(render_to_the_stage);
    }

    /// Replaces the handler that Bevy has installed by now, which stops rendering on the first
    /// error but does not report it.
    fn finish(&self, app: &mut App) {
        let world = app.world();
        if let Some(device) = world.get_resource::<RenderDevice>() {
            world.resource::<GpuErrors>().listen_to(device);
        }
    }
}

/// An observer rather than a system, so that a camera never has a frame without a target.
fn render_to_the_stage(
    inserted: On<Insert, RenderTarget>,
    stage: Res<Stage>,
    mut targets: Query<&mut RenderTarget>,
) {
    if let Ok(mut target) = targets.get_mut(inserted.entity)
        && matches!(*target, RenderTarget::Window(WindowRef::Primary))
    {
        *target = stage.image.clone().into();
    }
}

pub(crate) fn extent(size: UVec2) -> Extent3d {
    Extent3d {
        width: size.x,
        height: size.y,
        depth_or_array_layers: 1,
    }
}
