//! The front door for particle files: whatever is in a file, an answer within bounded memory and
//! time. The corpus is made here, by the formats' own writers and by breaking what they wrote.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use bevy::prelude::*;
use bevy_fluid::recording::ParticleFrame;
use proptest::{prelude::*, sample::Index, test_runner::TestRunner};
use splashsurf_lib::{io, nalgebra::Vector3};

/// For any file of some kilobytes; a header that is believed asks for gigabytes.
const MOST_MEMORY: u64 = 256 << 20;
const MOST_TIME: Duration = Duration::from_secs(2);

fn folder() -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz_files");
    fs::create_dir_all(&path).unwrap();
    path
}

fn points() -> Vec<Vec3> {
    let point = |i: i32| vec3(i as f32, 0.5 * (i % 7) as f32, -0.25 * i as f32);
    (0..60).map(point).collect()
}

/// A good file of every format, text and binary, plain and zipped.
fn corpus() -> Vec<(&'static str, Vec<u8>)> {
    let points = points();
    let vectors: Vec<_> = points.iter().map(|p| Vector3::from(p.to_array())).collect();
    let path = folder().join("good");
    let written = |write: &dyn Fn(&Path)| {
        write(&path);
        fs::read(&path).unwrap()
    };
    let bgeo = |zipped| {
        written(&|path| io::bgeo_format::particles_to_bgeo(&vectors, path, zipped).unwrap())
    };
    let vtk = written(&|path| io::vtk_format::particles_to_vtk(&vectors, path).unwrap());
    let bytes = |of: fn(f32) -> [u8; 4]| -> Vec<u8> {
        points
            .iter()
            .flat_map(Vec3::to_array)
            .flat_map(of)
            .collect()
    };
    let header = |format: &str| {
        let properties = "property float x\nproperty float y\nproperty float z\n";
        format!("ply\nformat {format} 1.0\nelement vertex 60\n{properties}end_header\n")
    };
    let lines: String = points
        .iter()
        .map(|p| format!("{} {} {}\n", p.x, p.y, p.z))
        .collect();
    let text_vtk = format!(
        "# vtk DataFile Version 4.1\nparticles\nASCII\nDATASET POLYDATA\nPOINTS 60 float\n{lines}\
         POINT_DATA 60\nSCALARS id int 1\nLOOKUP_TABLE default\n{}\n",
        "7 ".repeat(60)
    );
    vec![
        ("bgeo", bgeo(false)),
        ("bgeo", bgeo(true)),
        ("vtk", vtk),
        ("vtk", text_vtk.into_bytes()),
        ("ply", (header("ascii") + &lines).into_bytes()),
        (
            "ply",
            [
                header("binary_little_endian").into_bytes(),
                bytes(f32::to_le_bytes),
            ]
            .concat(),
        ),
        ("xyz", bytes(f32::to_le_bytes)),
        ("xyz", lines.into_bytes()),
    ]
}

/// Reads a file of these bytes: an error that names it, or no more points than it can hold.
fn read(extension: &str, bytes: &[u8]) -> Option<Vec<Vec3>> {
    let path = folder().join(format!("fuzzed.{extension}"));
    fs::write(&path, bytes).unwrap();
    let began = Instant::now();
    let result = ParticleFrame::read(&path);
    assert!(
        began.elapsed() < MOST_TIME,
        "{extension}: {:?}",
        began.elapsed()
    );
    match result {
        Ok(frame) => {
            let points = frame.positions;
            let fits = |attribute: usize| [0, points.len()].contains(&attribute);
            assert!(fits(frame.ids.len()) && fits(frame.velocities.len()));
            // Zipped, a point can be as short as nothing at all.
            let zipped = bytes.starts_with(&[0x1f, 0x8b]);
            assert!(zipped || points.len() <= bytes.len() / 3);
            Some(points)
        }
        Err(error) => {
            let message = error.to_string();
            assert!(
                message.contains("fuzzed") && !message.contains('\n'),
                "{message}"
            );
            None
        }
    }
}

/// The most address space this process has ever asked for, touched or not.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmPeak"))
        .unwrap();
    1024 * line
        .split_whitespace()
        .nth(1)
        .unwrap()
        .parse::<u64>()
        .unwrap()
}

/// The numbers in a text's lines up to the payload, each in place of another.
fn lying_texts(bytes: &[u8]) -> Vec<Vec<u8>> {
    let digits = |at: usize| bytes[at].is_ascii_digit();
    let starts = (1..bytes.len().min(260)).filter(|&at| digits(at) && !digits(at - 1));
    let mut lies = Vec::new();
    for start in starts {
        let end = (start..bytes.len())
            .find(|&at| !digits(at))
            .unwrap_or(bytes.len());
        for lie in [
            "2147483648",
            "4294967295",
            "-1",
            "99999999999999999999",
            "61",
            "0",
            "x",
        ] {
            lies.push([&bytes[..start], lie.as_bytes(), &bytes[end..]].concat());
        }
    }
    lies
}

/// Big and little endian numbers that a header may lie with, at every place in it.
fn lying_words(bytes: &[u8]) -> Vec<Vec<u8>> {
    let lies = [i32::MAX, i32::MIN, -1, 61, 0, 1 << 24];
    let places = 0..bytes.len().min(64) - 4;
    let written = places.flat_map(|at| lies.map(|lie| (at, lie)));
    let mut broken = Vec::new();
    for (at, lie) in written {
        for word in [lie.to_be_bytes(), lie.to_le_bytes()] {
            let mut bytes = bytes.to_vec();
            bytes[at..at + 4].copy_from_slice(&word);
            broken.push(bytes);
        }
    }
    broken
}

/// One test, so that the peak of its memory is its own.
#[test]
fn whatever_is_in_a_file_there_is_an_answer() {
    let corpus = corpus();
    for (extension, good) in &corpus {
        assert_eq!(read(extension, good), Some(points()), "{extension}");
    }
    let before = peak_memory();

    let mut refused = 0;
    let mut files = 0;
    let mut attempt = |extension: &str, bytes: &[u8]| {
        files += 1;
        refused += usize::from(read(extension, bytes).is_none());
    };
    for (extension, good) in &corpus {
        for length in (0..good.len()).step_by(1 + good.len() / 90) {
            attempt(extension, &good[..length]);
        }
        for broken in lying_texts(good).into_iter().chain(lying_words(good)) {
            attempt(extension, &broken);
        }
    }
    // Elements of nothing, of which any number fits.
    for count in ["4294967295", "60"] {
        let text = format!("ply\nformat ascii 1.0\nelement vertex {count}\nend_header\n");
        attempt("ply", text.as_bytes());
    }
    // A file of one format that says it is another.
    for (_, good) in &corpus {
        for extension in ["bgeo", "vtk", "ply", "xyz"] {
            attempt(extension, good);
        }
    }

    let mut runner = TestRunner::new(ProptestConfig {
        cases: 1500,
        failure_persistence: None,
        ..default()
    });
    let flips = prop::collection::vec((any::<Index>(), 0..8_u8), 1..12);
    let noise = prop::collection::vec(any::<u8>(), 0..200);
    let change = (any::<Index>(), flips, any::<Index>(), noise, any::<bool>());
    runner
        .run(&change, |(file, flips, cut, noise, insert)| {
            let (extension, good) = file.get(&corpus);
            let mut bytes = good.clone();
            for (at, bit) in flips {
                *at.get_mut(&mut bytes) ^= 1 << bit;
            }
            if insert {
                let at = cut.index(bytes.len());
                bytes.splice(at..at, noise);
            }
            read(extension, &bytes);
            Ok(())
        })
        .unwrap();

    let grown = peak_memory() - before;
    println!(
        "{refused} of {files} broken files are refused; memory grows by {} MiB",
        grown >> 20
    );
    assert!(grown < MOST_MEMORY, "{grown} bytes");
    assert!(refused > files / 2, "{refused} of {files}");
}
