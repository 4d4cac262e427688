//! The geometry of a solid: its surface for the liquid, and a collider for other solids.

use bevy::prelude::*;
use salva3d::rapier::{
    geometry::SharedShape,
    math::Pose,
    parry::shape::{Ball, Capsule, Cuboid, Cylinder, TriMesh, TriMeshFlags},
};

use super::{
    convert::{RigidVector, from_rigid, rigid},
    sampling::Triangle,
};

/// Segments around a sphere whose surface is sampled.
const SEGMENTS: u32 = 32;
/// Thickness of a tank's walls for bodies, over its largest side.
const TANK_WALLS: f32 = 0.25;
/// Hulls thinner than this, over their size, have no volume beyond rounding.
const THINNEST: f32 = 1e-5;

/// The shape of a solid in its own frame, scaled.
#[derive(Clone)]
pub(crate) struct Geometry {
    pub(crate) surface: Surface,
    /// What no particle passes.
    pub(crate) shell: SharedShape,
    /// What bodies meet.
    pub(crate) collider: SharedShape,
}

/// What a geometry is made of. Meshes may take long: they become one in a job.
pub(crate) enum Recipe {
    Made(Geometry),
    /// A surface with liquid on its front side.
    Mesh(Vec<Triangle>),
    /// Triangles within the convex hull.
    Hull(Vec<Triangle>),
}

impl Recipe {
    /// None where a mesh has no face, or a hull no volume.
    pub(crate) fn make(self) -> Option<Geometry> {
        match self {
            Self::Made(geometry) => Some(geometry),
            Self::Mesh(faces) => Geometry::mesh(faces),
            Self::Hull(faces) => Geometry::hull(&faces),
        }
    }
}

/// The surface to sample.
#[derive(Clone)]
pub(crate) enum Surface {
    /// Faces with their front side towards the liquid.
    Triangles(Vec<Triangle>),
    /// All of y = 0, seen from above.
    Plane,
}

impl Geometry {
    /// A block, solid, about the origin.
    pub(crate) fn cuboid(half: Vec3) -> Self {
        let shape = SharedShape::cuboid(half.x, half.y, half.z);
        Self {
            surface: Surface::Triangles(box_faces(half)),
            shell: shape.clone(),
            collider: shape,
        }
    }

    /// A box about the origin with the liquid inside, without a lid.
    pub(crate) fn tank(half: Vec3) -> Option<Self> {
        // Seen from within; the lid is the only side whose corners are all above.
        let faces: Vec<Triangle> = box_faces(half)
            .into_iter()
            .filter(|face| face.iter().any(|corner| corner.y < 0.0))
            .map(|[a, b, c]| [a, c, b])
            .collect();
        let thick = TANK_WALLS * half.max_element();
        let sides = [Vec3::NEG_Y, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z];
        let walls = sides.map(|side| {
            let reach = half + thick;
            let size = Vec3::select(side.cmpeq(Vec3::ZERO), reach, Vec3::splat(0.5 * thick));
            let at = side * (half + 0.5 * thick);
            let pose = Pose::from_translation(rigid(at));
            (pose, SharedShape::cuboid(size.x, size.y, size.z))
        });
        Some(Self {
            shell: shell(&faces)?,
            surface: Surface::Triangles(faces),
            collider: SharedShape::compound(walls.into()),
        })
    }

    /// A ball about the origin.
    pub(crate) fn sphere(radius: f32) -> Self {
        let shape = SharedShape::ball(radius);
        Self {
            surface: from_mesh(Ball::new(radius).to_trimesh(SEGMENTS, SEGMENTS / 2)),
            shell: shape.clone(),
            collider: shape,
        }
    }

    /// A capsule along y about the origin; `half_length` without its caps.
    pub(crate) fn capsule(radius: f32, half_length: f32) -> Self {
        let capsule = Capsule::new_y(half_length, radius);
        let shape = SharedShape::new(capsule);
        Self {
            surface: from_mesh(capsule.to_trimesh(SEGMENTS, SEGMENTS / 2)),
            shell: shape.clone(),
            collider: shape,
        }
    }

    /// A cylinder along y about the origin. Its shell is of triangles: parry's rays meet those more
    /// exactly.
    pub(crate) fn cylinder(radius: f32, half_height: f32) -> Option<Self> {
        let faces = triangles(Cylinder::new(half_height, radius).to_trimesh(SEGMENTS));
        Some(Self {
            shell: shell(&faces)?,
            surface: Surface::Triangles(faces),
            collider: SharedShape::cylinder(half_height, radius),
        })
    }

    /// All below y = 0.
    pub(crate) fn plane() -> Self {
        let shape = SharedShape::halfspace(RigidVector::Y);
        Self {
            surface: Surface::Plane,
            shell: shape.clone(),
            collider: shape,
        }
    }

    /// A surface with liquid on its front side. None where there is no face.
    fn mesh(faces: Vec<Triangle>) -> Option<Self> {
        let shell = shell(&faces)?;
        Some(Self {
            surface: Surface::Triangles(faces),
            collider: shell.clone(),
            shell,
        })
    }

    /// The convex hull of a surface. None where that has no volume.
    fn hull(faces: &[Triangle]) -> Option<Self> {
        let points: Vec<_> = faces.iter().flatten().copied().map(rigid).collect();
        if points.len() < 4 || points.iter().any(|point| !point.is_finite()) {
            return None;
        }
        let shape = SharedShape::convex_hull(&points)?;
        let hull = triangles(shape.as_convex_polyhedron()?.to_trimesh());
        // Of points in a plane it has two sides, but nothing between.
        if !has_volume(&hull) {
            return None;
        }
        Some(Self {
            surface: Surface::Triangles(hull),
            shell: shape.clone(),
            collider: shape,
        })
    }

    /// How near `place` is to the surface, 0 inside of what is solid.
    pub(crate) fn distance(&self, place: Vec3) -> f32 {
        self.collider.distance_to_local_point(rigid(place), true)
    }
}

fn box_faces(half: Vec3) -> Vec<Triangle> {
    triangles(Cuboid::new(rigid(half)).to_trimesh())
}

fn from_mesh(mesh: (Vec<RigidVector>, Vec<[u32; 3]>)) -> Surface {
    Surface::Triangles(triangles(mesh))
}

fn triangles((corners, faces): (Vec<RigidVector>, Vec<[u32; 3]>)) -> Vec<Triangle> {
    let corner = |index: u32| from_rigid(corners[index as usize]);
    faces.into_iter().map(|face| face.map(corner)).collect()
}

fn has_volume(closed: &[Triangle]) -> bool {
    let Some([origin, ..]) = closed.first() else {
        return false;
    };
    let (mut volume, mut area, mut size) = (0.0, 0.0, 0.0_f32);
    for [a, b, c] in closed {
        let [a, b, c] = [a, b, c].map(|corner| corner - origin);
        volume += a.dot(b.cross(c)) / 6.0;
        area += 0.5 * (b - a).cross(c - a).length();
        size = size.max(a.length());
    }
    volume.abs() > THINNEST * size * area
}

fn shell(faces: &[Triangle]) -> Option<SharedShape> {
    let corners: Vec<_> = faces.iter().flatten().copied().map(rigid).collect();
    if corners.iter().any(|corner| !corner.is_finite()) {
        return None;
    }
    let indices = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let flags = TriMeshFlags::MERGE_DUPLICATE_VERTICES | TriMeshFlags::DELETE_DEGENERATE_TRIANGLES;
    let mesh = TriMesh::with_flags(corners, indices.collect(), flags).ok()?;
    Some(SharedShape::new(mesh))
}
