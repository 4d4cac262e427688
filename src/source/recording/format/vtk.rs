//! Legacy VTK, by `vtkio`.

use bevy::prelude::*;
use splashsurf_lib::vtkio::{
    IOBuffer, Vtk,
    model::{
        Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, Piece, UnstructuredGridPiece,
        Version, VertexNumbers,
    },
};

use super::{IDS, RADII, VELOCITIES, floats, ids, mean_radius};
use crate::source::recording::ParticleFrame;

pub(super) fn read(bytes: &[u8]) -> Result<ParticleFrame, String> {
    let vtk = Vtk::parse_legacy_be(bytes).map_err(|error| error.to_string())?;
    let (points, data) = match vtk.data {
        DataSet::UnstructuredGrid { pieces, .. } => {
            first(pieces).map(|piece| (piece.points, piece.data))
        }
        DataSet::PolyData { pieces, .. } => first(pieces).map(|piece| (piece.points, piece.data)),
        _ => return Err("it is neither an unstructured grid nor polygonal data".into()),
    }
    .ok_or("it has no data of its own")?;
    let positions = vectors(&points).ok_or("its points are neither float nor double")?;
    Ok(ParticleFrame {
        positions,
        ids: find(&data, &IDS, 1)
            .and_then(IOBuffer::cast_into::<f64>)
            .map_or_else(Vec::new, |numbers| ids(numbers.into_iter())),
        velocities: find(&data, &VELOCITIES, 3)
            .and_then(vectors)
            .unwrap_or_default(),
        radius: find(&data, &RADII, 1)
            .and_then(IOBuffer::cast_into::<f32>)
            .and_then(|radii| mean_radius(radii.into_iter())),
    })
}

fn first<P>(pieces: Vec<Piece<P>>) -> Option<P> {
    pieces.into_iter().find_map(|piece| match piece {
        Piece::Inline(piece) => Some(*piece),
        _ => None,
    })
}

fn vectors(buffer: &IOBuffer) -> Option<Vec<Vec3>> {
    if !matches!(buffer, IOBuffer::F32(_) | IOBuffer::F64(_)) {
        return None;
    }
    let numbers = buffer.cast_into::<f32>()?;
    let (triples, _) = numbers.as_chunks::<3>();
    Some(triples.iter().copied().map(Vec3::from).collect())
}

/// The point data under one of these names, by itself or in a field.
fn find<'a>(data: &'a Attributes, names: &[&str], components: usize) -> Option<&'a IOBuffer> {
    let fits = |name: &str, count| count == components && names.contains(&name);
    data.point.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) => fits(&array.name, array.num_comp()).then_some(&array.data),
        Attribute::Field { data_array, .. } => data_array
            .iter()
            .find(|array| fits(&array.name, array.num_comp()))
            .map(|array| &array.data),
    })
}

pub(super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) -> Result<(), String> {
    let count = u32::try_from(frame.positions.len()).map_err(|error| error.to_string())?;
    let mut point = Vec::new();
    if !frame.ids.is_empty() {
        point.push(Attribute::scalars(IDS[0], 1).with_data(frame.ids.clone()));
    }
    if !frame.velocities.is_empty() {
        point.push(Attribute::vectors(VELOCITIES[0]).with_data(floats(&frame.velocities)));
    }
    if let Some(radius) = frame.radius {
        let radii = vec![radius; frame.positions.len()];
        point.push(Attribute::scalars(RADII[0], 1).with_data(radii));
    }
    let grid = UnstructuredGridPiece {
        points: floats(&frame.positions).into(),
        cells: Cells {
            cell_verts: VertexNumbers::Legacy {
                num_cells: count,
                vertices: (0..count).flat_map(|index| [1, index]).collect(),
            },
            types: vec![CellType::Vertex; frame.positions.len()],
        },
        data: Attributes {
            point,
            cell: Vec::new(),
        },
    };
    let vtk = Vtk {
        version: Version::new_legacy(4, 2),
        title: "particles".into(),
        byte_order: ByteOrder::BigEndian,
        data: DataSet::inline(grid),
        file_path: None,
    };
    vtk.write_legacy(bytes).map_err(|error| error.to_string())
}
