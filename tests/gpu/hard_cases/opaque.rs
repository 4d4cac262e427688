//! h45: opaque things before, in and behind the liquid.

use bevy::prelude::*;
use bevy_fluid::{
    prelude::ScreenSpaceFluid,
    render::{Layers, SearchStatus},
    settings::Refractions,
};

use super::*;

const VIEW: View = View::new(
    64,
    Lens::Orthographic {
        height: 2.2,
        near: 0.0,
        far: 10.0,
    },
);
const TRACED: ScreenSpaceFluid = ScreenSpaceFluid {
    refractions: Refractions::Four,
    ..RAW
};

#[test]
fn h45_opaque_things_hide_or_are_refracted() {
    let center = vec3(0.0, 0.0, -5.0);
    for kernel in [SPRAY, BULK] {
        for msaa in [Msaa::Off, Msaa::Sample4] {
            let mut app = show(&VIEW, TRACED, |world| {
                world.spawn(fluid(&[center], 1.0, kernel));
            });
            look(&mut app, msaa);
            let alone = picture(&mut app);
            // The box's colour; under multisampling edges mix, the middle does not.
            let green = |picture: &RgbaImage, x: u32, y: u32| {
                let [r, g, b, _] = picture.get_pixel(x, y).0;
                g > 60 && g > r && g > b
            };
            let mut show_box = |depth: f32, x: f32, size: f32| {
                let place = Transform::from_xyz(x, 0.0, -depth);
                let thing = spawn_box(app.world_mut(), Vec3::splat(size), place);
                settle(&mut app).unwrap();
                let shown = picture(&mut app);
                let exits = read(&app, Layers::exits);
                app.world_mut().despawn(thing);
                let exit = Exit::at(&VIEW, &exits, 32, 32);
                (shown, exit, exits)
            };
            // Before: the box hides, the liquid's own pixels there are not even traced.
            let (before, exit, _) = show_box(0.8, 0.0, 0.6);
            assert!(green(&before, 32, 32) && exit.is_none());
            assert_eq!(before.get_pixel(32, 12), alone.get_pixel(32, 12));
            // Inside: met behind the front surface, seen through it.
            let (inside, exit, exits) = show_box(5.0, 0.0, 0.6);
            let exit = exit.unwrap();
            assert_eq!(
                (exit.searches[0], exit.interfaces),
                (SearchStatus::Opaque, 1)
            );
            assert!(
                exit.direct && (-exit.position.z - 4.7).abs() < 0.03,
                "{exit:?}"
            );
            assert!(green(&inside, 32, 32));
            // Magnified: its edge at 0.3 m is seen where a straight ray would pass it.
            let straight = 32 + (0.3 / 2.2 * 64.0) as u32;
            assert!(
                green(&inside, straight + 2, 32),
                "refracted to beyond its edge"
            );
            // Rays that pass it on their bent way go on.
            let passing = Exit::at(&VIEW, &exits, straight + 12, 32).unwrap();
            assert_eq!(
                (passing.searches[0], passing.interfaces),
                (SearchStatus::Hit, 2)
            );
            // Behind: through both surfaces, upside down. What is left of the axis is seen right.
            let (behind, exit, _) = show_box(9.0, -0.6, 0.5);
            assert_eq!(exit.unwrap().searches[0], SearchStatus::Hit);
            let found: Vec<_> = (6..58).filter(|&x| green(&behind, x, 32)).collect();
            let mirrored = found.iter().filter(|&&x| x > 34).count();
            assert!(mirrored > 2, "{kernel:?}, {msaa:?}: {found:?}");
        }
    }
}
