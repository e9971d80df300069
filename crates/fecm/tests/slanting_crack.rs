//! Cracks whose length varies along the face.

mod common;

use common::{TORQUE, gear, pair};
use faer::Mat;
use fecm::condense::{CondensedBody, RichNode, Substructure};
use fecm::element::lagrange::{LagrangeBasis, gauss_rule};
use fecm::face::{FaceBasis, Parity};
use fecm::face_part::FacePart;
use fecm::mesh::blocks::{BlockMesher, Edge, geometric_breaks};
use fecm::mesh::{MeshDensity, PlaneMesh, SectorMesh};
use fecm::statics::{PairModel, PairModelOptions, StaticsRequest};
use fecm::{FaceModel, FecmError, Material};
use gear_geom::{CrackFront, CrackLength, Damage, FlankSide, RootCrack, ToothDamage};
use nalgebra::Point2;

const STRESS: f64 = 1e8;

/// A block `path` by `width` (along the face) by `2 * half_height`, pulled at its ends, with a crack in its middle plane.
struct Plate {
    mesh: PlaneMesh,
    /// Nodes of the middle plane on either side, from the start of the path.
    faces: [Vec<u32>; 2],
    loaded: Vec<(Vec<Vec<u32>>, f64)>,
    springs: Vec<Vec<u32>>,
    width: f64,
}

impl Plate {
    /// `breaks` ascend along the path (m) from 0; nodes are doubled as far as `split`, one of them.
    fn new(order: usize, breaks: &[f64], split: f64, half_height: f64, rows: usize, width: f64) -> Self {
        let mut mesher = BlockMesher::new(order);
        let up = geometric_breaks(rows, 1.6);
        let length = breaks[breaks.len() - 1];
        let cracked: Vec<f64> = breaks.iter().copied().filter(|&b| b <= split * (1.0 + 1e-9)).collect();
        let sound: Vec<f64> = breaks.iter().copied().filter(|&b| b >= split * (1.0 - 1e-9)).collect();
        let starts = [0.0, 0.0].map(|x| mesher.vertex(Point2::new(x, 0.0)));
        let shared = mesher.vertex(Point2::new(split, 0.0));
        let (ends, rest) = if sound.len() < 2 {
            let other = mesher.vertex(Point2::new(split, 0.0));
            ([(shared, shared), (other, other)], None)
        } else {
            let right = mesher.vertex(Point2::new(length, 0.0));
            ([(shared, right); 2], Some(mesher.edge(shared, right, &sound, |t| Point2::new(t, 0.0))))
        };
        let mut faces = Vec::new();
        let (mut loaded, mut springs) = (Vec::new(), Vec::new());
        for ((start, (tip, right)), sign) in starts.into_iter().zip(ends).zip([1.0, -1.0]) {
            let open = mesher.edge(start, tip, &cracked, |t| Point2::new(t, 0.0));
            faces.push(open.nodes().to_vec());
            let near = rest.as_ref().map_or(open.clone(), |rest| open.joined(rest));
            let [left_far, right_far] = [0.0, length].map(|x| mesher.vertex(Point2::new(x, sign * half_height)));
            let far = mesher.edge(left_far, right_far, breaks, |t| Point2::new(t, sign * half_height));
            let left = mesher.edge(start, left_far, &up, |t| Point2::new(0.0, sign * t * half_height));
            let side = mesher.edge(right, right_far, &up, |t| Point2::new(length, sign * t * half_height));
            if sign > 0.0 {
                mesher.block(&near, &far, &left, &side);
            } else {
                mesher.block(&far, &near, &left.reversed(), &side.reversed());
            }
            loaded.push((pieces(order, &far), sign));
            springs.extend(pieces(order, &side));
        }
        let faces = [faces[0].clone(), faces[1].clone()];
        Self { mesh: mesher.finish(), faces, loaded, springs, width }
    }

    /// Strain energy (J) with the faces parted where `open` says, by path coordinate.
    fn energy(&self, order: usize, open: Option<&dyn Fn(f64) -> Option<[f64; 2]>>) -> f64 {
        let basis = FaceBasis::new(FaceModel::Solid { order }, Parity::Both, self.width, &Material::STEEL).unwrap();
        let rich = open.map_or(Vec::new(), |open| self.rich(open));
        // the loads balance; springs of a billionth of the plate's stiffness only keep it from drifting
        let soft = 1e-9 * Material::STEEL.young_modulus / self.width;
        let springs = Some((soft, self.springs.as_slice()));
        let body = Substructure { mesh: &self.mesh, retained: vec![], fixed: vec![], springs, rich: &rich };
        let body = CondensedBody::new(&body, &basis).unwrap();
        let line = LagrangeBasis::new(self.mesh.order);
        let mut shapes = vec![0.0; self.mesh.order + 1];
        let mut loads = Mat::zeros(body.interior_size(), 1);
        for (edges, sign) in &self.loaded {
            for piece in edges {
                let ends = [piece[0], piece[self.mesh.order]].map(|node| self.mesh.nodes[node as usize]);
                let scale = sign * STRESS * 0.5 * (ends[1] - ends[0]).norm() * self.width;
                for (x, weight) in gauss_rule(self.mesh.order + 1) {
                    line.values_into(x, &mut shapes);
                    for (node, shape) in piece.iter().zip(&shapes) {
                        // of the functions along the face only the constant one has a mean
                        loads[(body.interior_row(*node, 1).unwrap(), 0)] += scale * weight * shape;
                    }
                }
            }
        }
        let mut moved = loads.clone();
        body.solve_interior(&mut moved);
        0.5 * (0..loads.nrows()).map(|i| loads[(i, 0)] * moved[(i, 0)]).sum::<f64>()
    }

    /// Nodes of the crack and around it, as in a tooth.
    fn rich(&self, open: &dyn Fn(f64) -> Option<[f64; 2]>) -> Vec<RichNode> {
        let at = |node: u32| self.mesh.nodes[node as usize];
        let pairs = || self.faces[0].iter().zip(&self.faces[1]).filter(|(above, below)| above != below);
        let parts = |node: u32| open(at(node).x).map(|ends| FacePart::within(self.width, ends)).into_iter().collect();
        let near = pairs().map(|(_, &node)| RichNode { node, follows: node, open: parts(node), layer_degrees: 2 });
        let far = pairs().map(|(&node, &follows)| RichNode { node, follows, open: parts(node), layer_degrees: 0 });
        let crack: Vec<RichNode> = near.chain(far).collect();
        let taken: Vec<u32> = crack.iter().map(|rich| rich.node).collect();
        let around =
            (0..self.mesh.nodes.len() as u32).filter(|&n| at(n).y.abs() < 0.25 * self.width && !taken.contains(&n));
        let around = around.map(|node| RichNode { node, follows: node, open: vec![], layer_degrees: 2 }).collect();
        [crack, around].concat()
    }

    /// Energy that the crack adds.
    fn added(&self, order: usize, open: &dyn Fn(f64) -> Option<[f64; 2]>) -> f64 {
        self.energy(order, Some(open)) - self.energy(order, Some(&|_| None))
    }
}

fn pieces(order: usize, edge: &Edge) -> Vec<Vec<u32>> {
    edge.nodes().windows(order + 1).step_by(order).map(<[u32]>::to_vec).collect()
}

fn even(length: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| length * k as f64 / count as f64).collect()
}

/// Energy of the uncracked block under even tension.
fn sound(area: f64, half_height: f64) -> f64 {
    STRESS * STRESS / Material::STEEL.young_modulus * area * half_height
}

const HEIGHT: f64 = 16e-3;

/// Parts that cover the whole face are nodes doubled along a through crack.
#[test]
fn invariant_open_all_along_is_a_through_crack() {
    let plate = Plate::new(3, &even(16e-3, 4), 8e-3, HEIGHT, 3, 12e-3);
    let through = plate.energy(5, None);
    let width = plate.width;
    let rich = plate.energy(5, Some(&|_| Some([-0.5 * width, 0.5 * width])));
    assert!((rich / through - 1.0).abs() < 1e-3 && rich > through * (1.0 - 1e-9), "{rich} {through}");
    // nothing open: even tension
    let closed = plate.energy(5, Some(&|_| None));
    assert!((closed / sound(16e-3 * 12e-3, HEIGHT) - 1.0).abs() < 1e-6, "{closed}");
}

/// A crack from one end of the face to a front along the path, which only functions along the face resolve, against the same crack with the roles of the
/// path and of the face exchanged: a through crack whose tip the mesh resolves.
#[test]
fn peer_front_along_the_path() {
    let (a, z, c) = (12e-3, 16e-3, 6e-3);
    let to_tip: Vec<f64> = geometric_breaks(6, 2.0).iter().rev().map(|b| c * (1.0 - b)).collect();
    let from_tip: Vec<f64> = geometric_breaks(6, 2.0).iter().skip(1).map(|b| c + (z - c) * b).collect();
    let exact = Plate::new(4, &[to_tip, from_tip].concat(), c, HEIGHT, 8, a).energy(4, None) - sound(a * z, HEIGHT);
    let plate = Plate::new(3, &even(a, 3), a, HEIGHT, 3, z);
    let errors = [4, 6, 8].map(|order| {
        (plate.energy(order, Some(&|_| Some([-0.5 * z, -0.5 * z + c]))) - sound(a * z, HEIGHT)) / exact - 1.0
    });
    // more functions along the face: more compliant, and never beyond the exact one
    assert!(errors.windows(2).all(|pair| pair[1] > pair[0]) && errors[2] < 0.0, "{errors:?}");
    assert!(errors[1] > -0.11 && errors[2] > -0.07, "{errors:?}");
}

/// A triangular corner crack, the mesh along one of its sides and functions along the other, and the other way round.
#[test]
fn peer_corner_crack_with_exchanged_roles() {
    let (a, z, on_a, on_z) = (16e-3, 16e-3, 6e-3, 9e-3);
    let added = |path: f64, face: f64, along: f64, across: f64, order: usize| {
        let count = 6;
        let mut breaks = even(along, count);
        breaks.extend(geometric_breaks(3, 1.7).iter().skip(1).map(|b| along + (path - along) * b));
        let plate = Plate::new(3, &breaks, along, HEIGHT, 3, face);
        let places: Vec<f64> = plate.faces[0].iter().map(|&n| plate.mesh.nodes[n as usize].x).collect();
        plate.added(order, &|x| {
            let k = places.iter().position(|&place| place == x).unwrap();
            let reach = across * (1.0 - 0.5 * (x + places[k + 1]) / along);
            Some([-0.5 * face, -0.5 * face + reach])
        })
    };
    for (order, most) in [(4, 0.05), (6, 0.02)] {
        let (one, other) = (added(a, z, on_a, on_z, order), added(z, a, on_z, on_a, order));
        assert!((other / one - 1.0).abs() < most, "order {order}: {one} {other}");
    }
}

const WIDTH: f64 = 16e-3;

fn front(lengths: &[(f64, f64)]) -> RootCrack {
    let (front, longest) = CrackFront::from_lengths(lengths).unwrap();
    RootCrack { front, ..RootCrack::along_chord(FlankSide::Upper, longest) }
}

/// Compliance (m/N) of a tooth's tip at a face position, cuts held.
fn tip_compliance(crack: Option<&RootCrack>, order: usize, density: f64, z: f64) -> f64 {
    let density = MeshDensity { order: 3, density };
    let sector = SectorMesh::with_crack(&gear(25), &density, crack, "gear").unwrap();
    let basis = FaceBasis::new(FaceModel::Solid { order }, Parity::Both, WIDTH, &Material::STEEL).unwrap();
    let body = CondensedBody::new(&sector.substructure(None), &basis).unwrap();
    let tip = *sector.flank(FlankSide::Upper).edges.last().unwrap().last().unwrap();
    // a load across the tooth at the face position, as functions along the face feel it
    let across: Vec<(usize, f64)> = basis
        .dofs()
        .iter()
        .enumerate()
        .filter(|(_, dof)| dof.component == 1)
        .map(|(d, dof)| {
            (body.interior_row(tip, d).unwrap(), if dof.degree < 2 { basis.value(dof.degree, z) } else { 0.0 })
        })
        .collect();
    let mut loads = Mat::zeros(body.interior_size(), 1);
    for &(row, value) in &across {
        loads[(row, 0)] = value;
    }
    body.solve_interior(&mut loads);
    across.iter().map(|&(row, value)| loads[(row, 0)] * value).sum()
}

/// Compliance is twice the energy at unit load: it grows with every part of the faces that opens, lies between those of through cracks as short and as long
/// as the crack is anywhere, and does not know left from right.
#[test]
fn invariant_longer_anywhere_is_softer() {
    let at = |crack: Option<&RootCrack>| tip_compliance(crack, 5, 0.7, 6e-3);
    let through = |fraction: f64| at(Some(&RootCrack::along_chord(FlankSide::Upper, fraction)));
    let sound = at(None);
    let by_length =
        [[0.0, 0.2], [0.0, 0.5], [0.2, 0.5], [0.4, 0.5]].map(|[a, b]| at(Some(&front(&[(-8e-3, a), (8e-3, b)]))));
    assert!(by_length[0] > 1.01 * sound, "{sound} {by_length:?}");
    assert!(by_length.windows(2).all(|pair| pair[1] > 1.01 * pair[0]), "{by_length:?}");
    assert!(through(0.4) < by_length[3] && by_length[3] < through(0.5), "{by_length:?}");
    assert!(by_length[1] < through(0.5) && through(0.2) < by_length[2], "{by_length:?}");
    // longest in the middle, and at both ends
    let hump = at(Some(&front(&[(-8e-3, 0.0), (0.0, 0.5), (8e-3, 0.0)])));
    let valley = at(Some(&front(&[(-8e-3, 0.5), (0.0, 0.0), (8e-3, 0.5)])));
    assert!(sound < hump && hump < through(0.5) && sound < valley && valley < through(0.5), "{hump} {valley}");
    let mirrored = tip_compliance(Some(&front(&[(-8e-3, 0.5), (8e-3, 0.0)])), 5, 0.7, -6e-3);
    assert!((mirrored / by_length[1] - 1.0).abs() < 1e-8, "{mirrored} {by_length:?}");
}

/// A front all but level is that of a through crack; what differs is the mesh, and what more the field can do.
#[test]
fn invariant_level_front_is_a_through_crack() {
    let at = |crack: RootCrack| tip_compliance(Some(&crack), 5, 0.7, 6e-3);
    let level = at(front(&[(-8e-3, 0.5 - 1e-12), (8e-3, 0.5)]));
    let through = at(RootCrack::along_chord(FlankSide::Upper, 0.5));
    assert!((level / through - 1.0).abs() < 5e-3, "{level} {through}");
}

#[test]
fn invariant_transmission_error_of_a_corner_crack() {
    let mut options = PairModelOptions { face: FaceModel::Solid { order: 5 }, ..PairModelOptions::default() };
    options.contact.face_cells = 16;
    let healthy = PairModel::new(&pair(25, 31), &options).unwrap();
    let with = |crack: RootCrack| {
        let damage = ToothDamage { tooth: 0, damage: Damage::Crack(crack) };
        healthy.with_damage(&[vec![damage], vec![]])
    };
    let solve = |model: &PairModel, torques: &[f64]| {
        let request = StaticsRequest::new([0.0, 0.3], torques.to_vec());
        model.solve(&request, &()).unwrap().results
    };
    let ste =
        |model: &PairModel| solve(model, &[TORQUE])[0].iter().map(|r| r.static_transmission_error).collect::<Vec<_>>();
    let sound = ste(&healthy);
    let through = ste(&with(RootCrack::along_chord(FlankSide::Upper, 0.5)).unwrap());
    let corner = with(front(&[(-8e-3, 0.0), (8e-3, 0.5)])).unwrap();
    let mirrored = ste(&with(front(&[(-8e-3, 0.5), (8e-3, 0.0)])).unwrap());
    let none = with(RootCrack { length: CrackLength::Chord(0.0), ..front(&[(-8e-3, 0.0), (8e-3, 0.5)]) }).unwrap();
    assert_eq!(ste(&none), sound, "no length is no crack, to the bit");
    let one = ste(&corner);
    for k in 0..2 {
        assert!(1.01 * sound[k] < one[k] && one[k] < through[k], "{} {} {}", sound[k], one[k], through[k]);
        assert!((one[k] / mirrored[k] - 1.0).abs() < 1e-6, "{} {}", one[k], mirrored[k]);
    }
    // a plane model has no face along which a crack could vary
    let plane =
        PairModel::new(&pair(25, 31), &PairModelOptions { face: FaceModel::PlaneStrain, ..options.clone() }).unwrap();
    let damage = ToothDamage { tooth: 0, damage: Damage::Crack(front(&[(-8e-3, 0.0), (8e-3, 0.5)])) };
    assert!(matches!(plane.with_damage(&[vec![damage], vec![]]), Err(FecmError::Crack { .. })));
}
