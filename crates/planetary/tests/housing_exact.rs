//! Solids with known answers: thick-walled tube, clamped beam, free ring, clamped plate.

use std::f64::consts::{PI, TAU};

use faer::Mat;
use fecm::Material;
use fecm::modes::krylov::{Pencil, lowest};
use nalgebra::Vector3;
use planetary::housing::assembly::{NodeSpring, Structure};
use planetary::housing::block::block;
use planetary::housing::element::{Kind, Shape};
use planetary::housing::mesh::SolidMesh;

const MATERIAL: Material = Material { young_modulus: 70e9, poisson_ratio: 0.3, density: 2700.0 };

fn ring(kind: Kind, cells: [usize; 3], radii: [f64; 2], height: f64) -> SolidMesh {
    // radius, angle, height; right-handed
    block(kind, cells, MATERIAL, |[a, b, c]| {
        let (r, t) = (radii[0] + a * (radii[1] - radii[0]), TAU * b);
        [r * t.cos(), r * t.sin(), height * c]
    })
}

/// Springs too soft to matter, at all nodes.
fn afloat(mesh: &SolidMesh, stiffness: f64) -> Vec<NodeSpring> {
    let share = stiffness / mesh.nodes.len() as f64;
    let spring = |node| NodeSpring { node, stiffness: share * nalgebra::Matrix3::identity() };
    (0..mesh.nodes.len() as u32).map(spring).collect()
}

/// Slope of the logarithm of errors over that of a number of elements, by least squares.
fn order(points: &[(usize, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|&(n, error)| ((n as f64).ln(), error.ln())).collect();
    let n = logs.len() as f64;
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    -mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2))
}

/// Work of the pressure in Lame's tube with free ends: `u(a) = p a / E ((b^2 + a^2) / (b^2 - a^2) + nu)`.
#[test]
fn order_of_a_tube_under_pressure() {
    let (a, b, height, pressure) = (0.05, 0.08, 0.01, 1e6);
    let exact = pressure * a / MATERIAL.young_modulus * ((b * b + a * a) / (b * b - a * a) + MATERIAL.poisson_ratio);
    for (kind, expected) in
        [(Kind::Hex20R, 3.5), (Kind::Hex20, 3.5), (Kind::Wedge15, 3.0), (Kind::Tet10, 2.7), (Kind::Hex8, 1.8)]
    {
        let errors: Vec<(usize, f64)> = [1, 2, 3, 4]
            .iter()
            .map(|&n| {
                let mesh = ring(kind, [n, 8 * n, 1], [a, b], height);
                let structure = Structure::new(&mesh, &afloat(&mesh, 1e3), &[]).unwrap();
                let mut forces = Mat::zeros(structure.size(), 1);
                for face in
                    mesh.outer_faces().iter().filter(|f| f.iter().all(|&n| mesh.node(n).xy().norm() < a * 1.000001))
                {
                    add_pressure(&mesh, face, pressure, &mut forces);
                }
                let field = structure.solve(forces.clone());
                let work = fecm::linalg::product(forces.transpose(), field.as_ref())[(0, 0)];
                (n, (work / (exact * pressure * TAU * a * height) - 1.0).abs())
            })
            .collect();
        let order = order(&errors);
        assert!(order > expected, "{kind:?}: order {order:.2}, {errors:?}");
        assert!(errors[3].1 < 2e-2, "{kind:?}: {errors:?}");
    }
}

fn add_pressure(mesh: &SolidMesh, face: &[u32], pressure: f64, forces: &mut Mat<f64>) {
    let shape = Shape::of_face(face.len()).unwrap();
    let line = fecm::element::lagrange::gauss_rule(4);
    for &(x, wx) in &line {
        for &(y, wy) in &line {
            let (at, weight) = if face.len() % 3 == 0 {
                let (x, y) = (0.5 * (1.0 + x), 0.5 * (1.0 + y));
                ([x * (1.0 - y), y, 0.0], 0.25 * wx * wy * (1.0 - y))
            } else {
                ([x, y, 0.0], wx * wy)
            };
            let gradients = shape.gradients(at);
            let tangent =
                |d: usize| -> Vector3<f64> { face.iter().zip(&gradients).map(|(&n, g)| g[d] * mesh.node(n)).sum() };
            let normal = tangent(0).cross(&tangent(1));
            for (&node, value) in face.iter().zip(shape.values(at)) {
                for d in 0..3 {
                    forces[(3 * node as usize + d, 0)] -= pressure * weight * value * normal[d];
                }
            }
        }
    }
}

/// Lowest frequencies (Hz).
fn frequencies(mesh: &SolidMesh, springs: &[NodeSpring], fixed: &[u32], count: usize) -> Vec<f64> {
    let structure = Structure::new(mesh, springs, fixed).unwrap();
    let found = lowest(&structure, count, 8, "test").unwrap();
    let momenta = structure.mass(&found.vectors);
    let gram = fecm::linalg::product(found.vectors.transpose(), momenta.as_ref());
    for i in 0..count {
        for j in 0..count {
            assert!((gram[(i, j)] - f64::from(i == j)).abs() < 1e-9, "modes {i}, {j}: {}", gram[(i, j)]);
        }
    }
    found.values.iter().map(|value| value.sqrt() / TAU).collect()
}

/// Slender clamped beam (Bernoulli-Euler; slenderness 1/50, shear and rotary inertia take some 0.1 to 1 %): `beta L = 1.875, 4.694`.
#[test]
fn analytic_frequencies_of_a_clamped_beam() {
    let (length, width, height) = (1.0, 0.03, 0.02);
    for (kind, cells) in [
        (Kind::Hex20R, [10, 2, 2]),
        (Kind::Hex20, [12, 1, 1]),
        (Kind::Hex8, [40, 1, 2]),
        (Kind::Wedge15, [12, 1, 1]),
        (Kind::Tet10, [30, 1, 1]),
    ] {
        let mut mesh = block(kind, cells, MATERIAL, |[a, b, c]| [length * a, width * b, height * c]);
        mesh.name_set("root", |x| x[0] == 0.0);
        let found = frequencies(&mesh, &[], mesh.set("root").unwrap(), 3);
        let exact = |beta: f64, depth: f64| {
            beta.powi(2) / TAU * (MATERIAL.young_modulus / MATERIAL.density / 12.0).sqrt() * depth / length.powi(2)
        };
        let expected = [exact(1.875_104, height), exact(1.875_104, width), exact(4.694_091, height)];
        for (found, exact) in found.iter().zip(expected) {
            assert!((found / exact - 1.0).abs() < 0.015, "{kind:?}: {found} against {exact}");
        }
    }
}

/// Love's free ring in its plane, `omega_n = n (n^2 - 1) / sqrt(n^2 + 1) sqrt(E I / (rho A R^4))`; at `h / R = 1/40` the thickness takes
/// less than half a percent up to `n = 4`.
#[test]
fn analytic_frequencies_of_a_free_ring() {
    let (radius, depth, height) = (0.2, 0.005, 0.02);
    let mesh = ring(Kind::Hex20, [1, 96, 1], [radius - 0.5 * depth, radius + 0.5 * depth], height);
    let found = frequencies(&mesh, &afloat(&mesh, 1.0), &[], 22);
    let slow: Vec<&f64> = found.iter().filter(|&&f| f < 5.0).collect();
    assert_eq!(slow.len(), 6, "rigid motions: {slow:?}");
    for n in [2.0, 3.0, 4.0_f64] {
        let speed = (MATERIAL.young_modulus / MATERIAL.density / 12.0).sqrt() * depth / radius.powi(2);
        let exact = n * (n * n - 1.0) / (n * n + 1.0).sqrt() * speed / TAU;
        let close: Vec<&f64> = found.iter().filter(|&f| (f / exact - 1.0).abs() < 0.006).collect();
        assert_eq!(close.len(), 2, "n = {n}: {exact} in {found:?}");
        assert!((close[0] / close[1] - 1.0).abs() < 1e-6, "a pair: {close:?}");
    }
}

/// Clamped square plate: `omega a^2 sqrt(rho h / D) = 35.985, 73.39 (twice), 108.2` (Leissa 1973); 1/100 thick.
#[test]
fn peer_leissa_clamped_square_plate() {
    let (side, depth) = (1.0, 0.01);
    let mut mesh = block(Kind::Hex20R, [20, 20, 1], MATERIAL, |[a, b, c]| [side * a, side * b, depth * c]);
    mesh.name_set("edge", |x| [x[0], x[1]].iter().any(|x| *x == 0.0 || (x - side).abs() < 1e-12));
    let found = frequencies(&mesh, &[], mesh.set("edge").unwrap(), 4);
    let rigidity = MATERIAL.young_modulus * depth.powi(3) / (12.0 * (1.0 - MATERIAL.poisson_ratio.powi(2)));
    let unit = (rigidity / (MATERIAL.density * depth)).sqrt() / side.powi(2);
    for (found, exact) in found.iter().zip([35.985, 73.39, 73.39, 108.2]) {
        let found = found * 2.0 * PI / unit;
        assert!((found / exact - 1.0).abs() < 0.01, "{found} against {exact}");
    }
}
