//! Files that are not what they are called, and what others make of ours.

use std::{fs, iter, path::Path};

use bevy::{asset::AssetLoader, prelude::*};
use bevy_fluid::recording::{
    FramePattern, ParticleFormat, ParticleFrame, ParticleFrameLoader, RecordingPlayer,
};
use splashsurf_lib::{io, nalgebra::Vector3};

use super::super::{folder, log, open, wait};
use super::refused;

#[test]
fn what_was_fetched_instead_is_named() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 12345\n";
    for extension in ParticleFormat::EXTENSIONS {
        let name = format!("fetched.{extension}");
        refused(&name, pointer, "Git LFS");
        refused(&name, "<!DOCTYPE html>\n<html></html>", "web page");
        refused(&name, b"PK\x03\x04\0\0\0\0\0\0\0\0", "zip archive");
        refused(&name, b"\x28\xb5\x2f\xfd\0\0\0\0", "Zstandard");
    }
    let wide: Vec<u8> = iter::once(0xfeff)
        .chain("ply\n".encode_utf16())
        .flat_map(u16::to_le_bytes)
        .collect();
    refused("wide.ply", wide, "UTF-16");
}

#[test]
fn names_of_what_is_not_read_say_so() {
    for (name, reason) in [("a.vtu", "XML"), ("a.pvd", "XML"), ("a.bgeo.sc", "Blosc")] {
        refused(name, "whatever is in it", reason);
        let error = FramePattern::parse(&name.replace('a', "a_####")).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
    let error = ParticleFrame::parse("a.gz", b"").unwrap_err().to_string();
    assert!(error.contains("no known particle format"), "{error}");
}

#[test]
fn a_player_skips_what_is_not_read_and_says_what_it_is() {
    let folder = folder("not_read");
    fs::write(
        folder.join("kind_0.vtk"),
        "<?xml version=\"1.0\"?><VTKFile/>",
    )
    .unwrap();
    let mut app = super::super::app(&folder);
    let recording = open(&app, "kind_#.vtk");
    app.world_mut().spawn(RecordingPlayer::new(recording));
    wait(&mut app, |_| {
        log::count("kind_0.vtk is not read: no legacy .vtk: it is XML") == 1
    });
}

#[test]
fn every_name_of_a_format_is_an_asset() {
    let known = AssetLoader::extensions(&ParticleFrameLoader);
    for extension in ParticleFormat::EXTENSIONS {
        assert!(known.contains(&extension), "{extension}");
        assert!(
            known.contains(&format!("{extension}.gz").as_str()),
            "{extension}.gz"
        );
    }
}

/// Splashsurf and the crates under it.
#[test]
fn what_we_write_others_read() {
    let folder = folder("others");
    let index = |i: i32| vec3(i as f32, -0.25 * i as f32, 1e-3 * (i * i) as f32);
    let frame = ParticleFrame {
        positions: (0..50).map(index).collect(),
        ids: (0..50).collect(),
        velocities: (0..50).map(|i| index(50 - i)).collect(),
        radius: Some(0.025),
    };
    let expected: Vec<_> = frame
        .positions
        .iter()
        .map(|at| Vector3::from(at.to_array()))
        .collect();
    let file = |name: &str| {
        let path = folder.join(name);
        frame.write(&path).unwrap();
        path
    };
    type Read = fn(&Path) -> Vec<Vector3<f32>>;
    let readers: [(&str, Read); 5] = [
        ("frame.vtk", |path| {
            io::vtk_format::particles_from_vtk(path).unwrap()
        }),
        ("frame.bgeo", |path| {
            io::bgeo_format::particles_from_bgeo(path).unwrap()
        }),
        ("frame.bgeo.gz", |path| {
            io::bgeo_format::particles_from_bgeo(path).unwrap()
        }),
        ("frame.ply", |path| {
            io::ply_format::particles_from_ply(path).unwrap()
        }),
        ("frame.xyz", |path| {
            io::xyz_format::particles_from_xyz(path).unwrap()
        }),
    ];
    for (name, read) in readers {
        assert_eq!(read(&file(name)), expected, "{name}");
    }
}
