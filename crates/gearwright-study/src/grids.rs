//! Meshes, deformed shape and contact pressure as grids for ParaView.

use fecm::FecmError;
use fecm::statics::{PairModel, PositionResult, PressurePatch};
use nalgebra::{Point2, Rotation2, Vector3};

use gearwright_results::vtu::{CellShape, Field, Grid};

/// Layers of hexahedra along the face of a solid.
const LAYERS: usize = 4;

/// One gear at a position: mesh in space, displacement (hub at rest) and its size.
///
/// # Errors
/// Those of the deformation.
pub fn body(model: &PairModel, position: &PositionResult, member: usize) -> Result<Grid, FecmError> {
    let deformation = model.deformation(position, member)?;
    let body = &model.bodies()[member];
    let gear = model.pairing().gear(member);
    let (centre, angle) = placement(model, position.mesh_cycle, position.rotation, member);
    let solid = model.is_solid();
    let layers: Vec<f64> = if solid {
        (0..=LAYERS).map(|k| gear.facewidth() * (k as f64 / LAYERS as f64 - 0.5)).collect()
    } else {
        vec![0.0]
    };
    let (mut points, mut displacements, mut cells) = (Vec::new(), Vec::new(), Vec::new());
    let turn = Rotation2::new(angle);
    for sector in 0..gear.teeth() as usize {
        let mesh = &body.sector(sector as i32).shape.mesh;
        let (first, nodes) = (points.len() / 3, mesh.nodes.len());
        let own = Rotation2::new(angle + body.sector_angle() * sector as f64);
        for &z in &layers {
            for (node, place) in mesh.nodes.iter().enumerate() {
                let in_space = centre + own * place.coords;
                points.extend([in_space.x, in_space.y, z]);
                let u = deformation.at(body, sector, node, z);
                let planar = turn * u.xy();
                displacements.extend([planar.x * 1e6, planar.y * 1e6, u.z * 1e6]);
            }
        }
        let at = |layer: usize, node: u32| (first + layer * nodes) as u32 + node;
        for quad in mesh.elements().flat_map(|element| sub_quads(element, mesh.order)) {
            if solid {
                for layer in 0..LAYERS {
                    cells.extend(quad.map(|n| at(layer, n)));
                    cells.extend(quad.map(|n| at(layer + 1, n)));
                }
            } else {
                cells.extend(quad.map(|n| at(0, n)));
            }
        }
    }
    let shape = if solid { CellShape::Hexahedron } else { CellShape::Quad };
    let field = Field { name: "displacement_um".into(), components: 3, values: displacements };
    Ok(Grid { shape, points, cells, point_fields: vec![field], cell_fields: vec![] })
}

/// Contact pressure on the pinion's flanks at a mesh cycle, in space.
#[must_use]
pub fn pressure(model: &PairModel, mesh_cycle: f64, patches: &[PressurePatch]) -> Grid {
    let pairing = model.pairing();
    let pinion = pairing.gear(0);
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    let (mut pressures, mut pairs) = (Vec::new(), Vec::new());
    for patch in patches {
        let tooth = patch.pair * pairing.tooth_steps()[0];
        let (centre, angle) = placement(model, mesh_cycle, 0.0, 0);
        let own = Rotation2::new(angle + model.bodies()[0].sector_angle() * f64::from(tooth));
        let on_flank = |roll: f64, z: f64| -> Vector3<f64> {
            let p = centre + own * pinion.flank_point(pairing.side(0), roll).coords;
            Vector3::new(p.x, p.y, z)
        };
        let mirrored = model.stats().symmetric;
        let mut signs = vec![1.0];
        if mirrored {
            signs.push(-1.0);
        }
        for (row, &roll) in patch.pinion_roll.iter().enumerate() {
            // a cell's extent in roll distance: arc length over roll angle
            let half_roll = 0.5 * patch.cell[0] * pinion.base_radius() / roll.max(1e-3 * pinion.module());
            for (&z, &value) in patch.face.iter().zip(&patch.pressure[row]) {
                for sign in &signs {
                    let first = (points.len() / 3) as u32;
                    let half = 0.5 * patch.cell[1];
                    for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                        let p = on_flank(roll + s * half_roll, sign * z + t * half);
                        points.extend([p.x, p.y, p.z]);
                    }
                    cells.extend([first, first + 1, first + 2, first + 3]);
                    pressures.push(value * 1e-6);
                    pairs.push(f64::from(patch.pair));
                }
            }
        }
    }
    let cell_fields = vec![
        Field { name: "pressure_mpa".into(), components: 1, values: pressures },
        Field { name: "tooth_pair".into(), components: 1, values: pairs },
    ];
    Grid { shape: CellShape::Quad, points, cells, point_fields: vec![], cell_fields }
}

/// Centre of a gear and angle of its tooth 0 at a mesh cycle and closing rotation of the wheel (rad).
fn placement(model: &PairModel, mesh_cycle: f64, rotation: f64, member: usize) -> (Point2<f64>, f64) {
    let which = if member == 0 { gear_geom::Member::Pinion } else { gear_geom::Member::Wheel };
    let pair = model.pairing().pair();
    let closing = if member == 0 { 0.0 } else { pair.closing_direction() * rotation };
    (pair.centre(which), pair.tooth_angle(which, 0, mesh_cycle) + closing)
}

/// The bilinear quads between the nodes of an element.
fn sub_quads(element: &[u32], order: usize) -> Vec<[u32; 4]> {
    let n = order + 1;
    let mut quads = Vec::new();
    for j in 0..order {
        for i in 0..order {
            let at = |i: usize, j: usize| element[j * n + i];
            quads.push([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    quads
}
