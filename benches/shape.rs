//! b
use bevy::math::Vec3;
use bevy_fluid::shape::*;
use splashsurf_lib::{Aabb3d, nalgebra::Vector3, neighborhood_search::neighborhood_search_spatial_hashing_parallel as search};
use std::time::Instant;
fn block(n: usize, r: f32) -> Vec<Vec3> {
    let k = (n as f64).cbrt().ceil() as usize;
    let mut s = 1u64;
    let mut rnd = || { s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); ((s >> 40) as f32 / (1 << 24) as f32) - 0.5 };
    let mut v: Vec<Vec3> = (0..n).map(|i| Vec3::new((i % k) as f32 + 0.4 * rnd(), (i / k % k) as f32 + 0.4 * rnd(), (i / k / k) as f32 + 0.4 * rnd()) * 2.0 * r).collect();
    if std::env::var("SHUF").is_ok() { for i in (1..n).rev() { let j = (((rnd() + 0.5) * (i as f32 + 1.0)) as usize).min(i); v.swap(i, j); } }
    v
}
fn main() {
    let r = 0.025f32;
    for n in [10_000, 100_000] {
        let p = block(n, r);
        let v: Vec<Vector3<f32>> = p.iter().map(|p| Vector3::new(p.x, p.y, p.z)).collect();
        let dom = Aabb3d::par_from_points(&v);
        let mut ws = ShapeWorkspace::default();
        let mut lists = vec![];
        let (mut g, mut c, mut s, mut a) = (vec![], vec![], vec![], vec![]); let mut out = FluidSplats::default();
        for _ in 0..(if n > 500_000 { 3 } else { 25 }) {
            let t = Instant::now();
            if n < 500_000 && std::env::var("NOS").is_err() { search::<i64, f32>(&dom, &v, 4.0 * r, &mut lists); }
            s.push(t.elapsed().as_secs_f64());
            ws.shape(&p, r, &SurfaceKernel { skip_interior: std::env::var("NOI").is_err(), ..Default::default() }, &mut out).unwrap();
            let t=out.times; g.push(t.grid.as_secs_f64()); c.push(t.classify.as_secs_f64()); a.push(t.anisotropy.as_secs_f64());
        }
        let med = |v: &mut Vec<f64>| { v.sort_by(f64::total_cmp); v[0] / n as f64 * 1e9 };
        println!("{n}: grid {:.1} classify {:.1} aniso {:.1} splash {:.1}  {:?}", med(&mut g), med(&mut c), med(&mut a), med(&mut s), (out.bulk, out.interior, out.spray, out.min, out.max));
    }
}
