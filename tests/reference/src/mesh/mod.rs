//! Depth layers as triangle meshes: the reference of Imai's thesis (2016).
//!
//! A ray through the meshes meets what a perfect search in the layers would find, so a renderer
//! that differs errs in its search or in the order of its interfaces, not in its layers.

mod triangle;

use glam::{DVec3, UVec2};

use crate::{Camera, Crossing, Hit, Image, Ray, Span, Surface, boxes::Boxes, tracer::SKIN};

use triangle::Triangle;

/// One depth image, seen by a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Reverse device depth; `None` where the layer is not there.
    pub depth: Image<Option<f64>>,
    /// Outward normals in world space, of the depths' size. If none are given they are those of
    /// the differences between neighbours; where one is missing, of the triangle.
    pub normals: Option<Image<Option<DVec3>>>,
}

/// Front and back of one class, bulk or spray.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The nearest surface.
    pub front: Sheet,
    /// The farthest.
    pub back: Sheet,
}

impl Layer {
    /// Exact layers with exact normals.
    pub fn from_spans(spans: &Image<Option<Span>>) -> Self {
        let sheet = |side: fn(&Span) -> Hit| Sheet {
            depth: spans.map(|span| span.as_ref().map(|span| side(span).device_depth)),
            normals: Some(spans.map(|span| span.as_ref().map(|span| side(span).normal))),
        };
        Self {
            front: sheet(|span| span.front),
            back: sheet(|span| span.back),
        }
    }
}

/// The meshes of several layers. The body of a crossing is the number of its layer.
///
/// Bodies may overlap: each is entered and left by itself.
pub struct LayerMeshes {
    camera: Camera,
    /// Front and back view depth of each layer, m.
    depths: Vec<Image<Option<[f64; 2]>>>,
    triangles: Vec<Triangle>,
    boxes: Boxes,
}

impl LayerMeshes {
    /// Puts a vertex at the middle of every pixel and joins neighbours to triangles.
    ///
    /// `step`: greatest difference in view depth within a triangle, m; the renderer's own is two
    /// particle radii. Images whose size is not the camera's are cut to what both have.
    pub fn new(camera: &Camera, layers: &[Layer], step: f64) -> Self {
        let mut triangles = Vec::new();
        for (body, layer) in layers.iter().enumerate() {
            for (sheet, front) in [(&layer.front, true), (&layer.back, false)] {
                triangles.extend(triangle::triangulate(camera, sheet, body, step, front));
            }
        }
        let depths = layers.iter().map(|layer| {
            Image::from_fn(camera.size, |pixel| {
                let [front, back] =
                    [&layer.front, &layer.back].map(|s| view_depth(camera, s, pixel));
                Some([front?, back?])
            })
        });
        Self {
            camera: *camera,
            depths: depths.collect(),
            boxes: Boxes::new(triangles.iter().map(Triangle::corners)),
            triangles,
        }
    }

    /// How many triangles there are.
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }
}

fn view_depth(camera: &Camera, sheet: &Sheet, pixel: UVec2) -> Option<f64> {
    let there = pixel.cmplt(sheet.depth.size()).all();
    let device = if there { *sheet.depth.get(pixel) } else { None };
    device.map(|device| camera.view_from_device(device))
}

impl Surface for LayerMeshes {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        let mut met = Vec::new();
        self.boxes
            .met(ray, |index| met.extend(self.triangles[index].crossing(ray)));
        met.sort_by(|a: &Crossing, b| a.t.total_cmp(&b.t));
        // On an edge a ray meets both triangles.
        met.dedup_by(|b, a| b.body == a.body && b.entering == a.entering && b.t - a.t < SKIN);
        out.append(&mut met);
    }

    /// The layer between whose front and back a point lies, at its nearest pixel.
    fn inside(&self, point: DVec3) -> Option<usize> {
        let (on_screen, z) = self.camera.project(point)?;
        let pixel = on_screen.floor();
        let size = self.camera.size.as_dvec2();
        if pixel.min_element() < 0.0 || pixel.cmpge(size).any() {
            return None;
        }
        // A point on the near plane is inside where the front is cut by it.
        let z = z * (1.0 + 1e-9);
        self.depths.iter().position(|depths| {
            depths
                .get(pixel.as_uvec2())
                .is_some_and(|[front, back]| front <= z && z < back)
        })
    }
}
