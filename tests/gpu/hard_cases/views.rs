//! h39 and h41: sizes and samples of the picture.

use bevy::{
    prelude::*,
    render::{
        render_resource::TextureFormat,
        renderer::{RenderAdapter, RenderDevice},
    },
};
use bevy_fluid::{prelude::*, render::Layers};
use fluid_stage::{resize, step};

use super::*;

fn particles() -> Vec<Vec3> {
    let block = lattice(7, 0.2, 0.2);
    let shifted = block.iter().map(|p| p + vec3(-0.7, -0.9, -5.7));
    shifted.chain([vec3(0.5, 0.8, -4.5)]).collect()
}

fn view(size: UVec2) -> View {
    View {
        size,
        ..View::new(64, PERSPECTIVE)
    }
}

fn show_at(size: UVec2) -> App {
    show(&view(size), ScreenSpaceFluid::default(), |world| {
        walls(world);
        world.spawn(fluid(&particles(), 0.1, SurfaceKernel::default()));
    })
}

/// What the device's allocator has handed out, in bytes.
fn gpu_memory(app: &App) -> u64 {
    let device = app.world().resource::<RenderDevice>();
    let report = device.wgpu_device().generate_allocator_report();
    report
        .expect("Vulkan's allocator reports")
        .total_allocated_bytes
}

#[test]
fn h39_every_frame_another_size() {
    let start = uvec2(64, 48);
    let mut app = show_at(start);
    let first = picture(&mut app);
    let sizes = [
        uvec2(1, 1),
        uvec2(63, 47),
        uvec2(1, 97),
        uvec2(101, 1),
        uvec2(2, 3),
        uvec2(128, 96),
        uvec2(33, 65),
    ];
    let round = |app: &mut App| {
        for size in sizes {
            resize(app, size).unwrap();
            step(app, 1);
            let shown = picture(app);
            assert_eq!(shown.dimensions(), size.into());
        }
    };
    round(&mut app);
    round(&mut app);
    let before = gpu_memory(&app);
    for _ in 0..6 {
        round(&mut app);
    }
    let after = gpu_memory(&app);
    // Textures of sizes no longer asked for are kept for three frames, then dropped.
    assert!(
        after <= before + before / 50,
        "{before} bytes grow to {after}"
    );
    for size in [uvec2(1, 1), uvec2(33, 65), start] {
        resize(&mut app, size).unwrap();
        step(&mut app, 1);
        let fresh = if size == start {
            first.clone()
        } else {
            picture(&mut show_at(size))
        };
        assert!(picture(&mut app) == fresh, "{size}");
    }
}

#[test]
fn h41_no_number_of_samples_averages_depths() {
    let view = View::new(64, PERSPECTIVE);
    let mut app = show(&view, RAW, |world| {
        world.spawn(fluid(&particles(), 0.1, SurfaceKernel::default()));
        // Before the left half, with a slanting edge.
        let place = Transform::from_xyz(-2.1, 0.0, -3.0).with_rotation(Quat::from_rotation_z(0.2));
        spawn_box(world, vec3(4.0, 9.0, 0.2), place);
    });
    let layers = |app: &App| [Layers::bulk, Layers::spray].map(|of| read(app, of));
    let single = layers(&app);
    let adapter = app.world().resource::<RenderAdapter>().clone();
    let device = app.world().resource::<RenderDevice>().clone();
    let can = |samples: u32| {
        use bevy::render::render_resource::WgpuFeatures;
        let any = device
            .features()
            .contains(WgpuFeatures::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);
        let formats = [TextureFormat::Rgba16Float, TextureFormat::Depth32Float];
        let flags = formats.map(|format| adapter.get_texture_format_features(format).flags);
        samples == 4
            || any
                && flags
                    .iter()
                    .all(|flags| flags.sample_count_supported(samples))
    };
    let mut tried = 0;
    for msaa in [Msaa::Sample2, Msaa::Sample4, Msaa::Sample8] {
        if !can(msaa.samples()) {
            println!("this adapter has no {msaa:?}");
            continue;
        }
        tried += 1;
        look(&mut app, msaa);
        assert_sound(&app);
        let mut edge = 0;
        for (single, multi) in single.iter().zip(&layers(&app)) {
            for pixel in pixels(view.size) {
                let [a, b] = [single, multi].map(|l| l.f32x2(pixel.x, pixel.y));
                assert_eq!(a[1], b[1], "{msaa:?}, {pixel}: backs");
                // A front is the liquid's own, or hidden; with several samples it is hidden only
                // where all of them are. Nothing in between is made up.
                if a[0] != b[0] {
                    edge += 1;
                    assert_eq!(a[0], NOTHING[0], "{msaa:?}, {pixel}: {a:?} {b:?}");
                }
            }
        }
        assert!(
            (5..130).contains(&edge),
            "{msaa:?}: {edge} pixels are at the edge"
        );
        look(&mut app, ScreenSpaceFluid::default());
        assert_sound(&app);
        look(&mut app, RAW);
    }
    assert!(tried > 0);
}
