//! A reduced housing against the structure it comes from: rigid motion, statics, response to harmonic loads, threads.

use std::f64::consts::TAU;

use faer::Mat;
use fecm::linalg::product;
use fecm::modes::krylov::Pencil;
use nalgebra::Vector3;
use planetary::elastic::ElasticBody;
use planetary::housing::reading::Reading;
use planetary::housing::surface::Surface;
use planetary::housing::{Casing, Damping, Housing, ReducedHousing, ReductionOptions};

/// The default housing on few elements, with few harmonics.
fn coarse() -> Housing {
    let mut casing = Casing { seat_harmonics: 4, ..Casing::default() };
    casing.density.element_size = 0.06;
    casing.sensors.truncate(12);
    casing.housing().unwrap()
}

fn reduced(modes: usize) -> ReducedHousing {
    let options = ReductionOptions { modes, highest_frequency: f64::INFINITY, damping: Damping::Ratio(0.02) };
    coarse().reduce(&options).unwrap()
}

/// Readings of ports and seat, in this order.
fn readings(housing: &Housing) -> Vec<Reading> {
    let surface = Surface::new(&housing.mesh);
    let port = |p: &planetary::housing::PortPlace| {
        Reading::frame(&housing.mesh, &surface, &p.name, p.position.unwrap()).unwrap()
    };
    let mut all: Vec<Reading> = housing.ports.iter().map(port).collect();
    let seat = housing.seat.as_ref().unwrap();
    all.push(Reading::harmonics(&housing.mesh, &surface, &seat.set, seat.harmonics).unwrap().0);
    all
}

/// Rows of ports, seat and sensors of a body.
fn rows(body: &ElasticBody) -> Mat<f64> {
    let seat = &body.ring_seat.as_ref().unwrap().shapes;
    let parts: Vec<&Mat<f64>> = body.ports.iter().map(|port| &port.shapes).chain([seat]).collect();
    let sensors = body.sensors.iter().map(|sensor| sensor.shape.clone());
    let all: Vec<Vec<f64>> = parts
        .iter()
        .flat_map(|part| (0..part.nrows()).map(|i| (0..part.ncols()).map(|k| part[(i, k)]).collect()))
        .chain(sensors)
        .collect();
    Mat::from_fn(all.len(), body.frequencies.len(), |i, k| all[i][k])
}

#[test]
fn invariant_rigid_motion_is_read_exactly() {
    let mut housing = coarse();
    // no set symmetric, no two heights alike
    let seat = housing.mesh.node_sets.get_mut("ring_seat").unwrap();
    *seat = seat.iter().enumerate().filter(|(k, _)| k % 7 != 3).map(|(_, &node)| node).collect();
    let (shift, turn) = (Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.4, 0.3, -0.8));
    let moved = |x: Vector3<f64>| shift + turn.cross(&x);
    let values = |reading: &Reading| -> Vec<f64> {
        let row = |row: &Vec<(u32, Vector3<f64>)>| row.iter().map(|(n, w)| w.dot(&moved(housing.mesh.node(*n)))).sum();
        reading.rows.iter().map(row).collect()
    };
    let all = readings(&housing);
    for (reading, port) in all.iter().zip(&housing.ports) {
        let found = values(reading);
        let at = moved(Vector3::from(port.position.unwrap()));
        for d in 0..3 {
            assert!((found[d] - at[d]).abs() < 1e-10, "{}: {found:?}", port.name);
            assert!((found[3 + d] - turn[d]).abs() < 1e-9, "{}: {found:?}", port.name);
        }
    }
    let surface = Surface::new(&housing.mesh);
    let (reading, circle) = Reading::harmonics(&housing.mesh, &surface, "ring_seat", 4).unwrap();
    assert!((circle.radius - 0.1419).abs() < 1e-9);
    // centre of the seat, then u_r = d_x cos + d_y sin, u_t = -d_x sin + d_y cos + R w_z, u_z = d_z + R (w_x sin - w_y cos)
    let (d, radius) = (moved(Vector3::new(0.0, 0.0, circle.z)), circle.radius);
    let expected =
        [vec![0.0, d.x, d.y], vec![radius * turn.z, d.y, -d.x], vec![d.z, -radius * turn.y, radius * turn.x]];
    let found = values(&reading);
    for (direction, expected) in expected.iter().enumerate() {
        for k in 0..9 {
            let exact = expected.get(k).copied().unwrap_or(0.0);
            assert!((found[9 * direction + k] - exact).abs() < 1e-9, "direction {direction}, {k}: {found:?}");
        }
    }
    // a sensor feels its own point
    let point = surface.outermost(&housing.mesh, 1.2, 0.003).unwrap();
    let direction = Vector3::new(0.6, 0.0, 0.8);
    let found = values(&Reading::sensor(&point, direction))[0];
    assert!((found - direction.dot(&moved(Vector3::from(point.position)))).abs() < 1e-10);
    assert!(
        (point.position[1].atan2(point.position[0]) - 1.2).abs() < 1e-12 && (point.position[2] - 0.003).abs() < 1e-12
    );
}

/// Static response to any load on ports and seat, read anywhere, is that of the whole structure, with many modes or none.
#[test]
fn invariant_statics_are_exact_with_any_number_of_modes() {
    let housing = coarse();
    let structure = housing.structure().unwrap();
    let all = readings(&housing);
    let mut loads = Mat::zeros(structure.size(), 0);
    for reading in &all {
        fecm::modes::krylov::append(&mut loads, &reading.loads(&structure));
    }
    let statics = structure.solve(loads.clone());
    let exact = product(loads.transpose(), statics.as_ref());
    for modes in [0, 15] {
        let ReducedHousing { body, .. } = reduced(modes);
        let shapes = rows(&body);
        let count = loads.ncols();
        let found = Mat::from_fn(count, count, |i, j| {
            (0..body.frequencies.len())
                .map(|k| shapes[(i, k)] * shapes[(j, k)] / body.frequencies[k].powi(2))
                .sum::<f64>()
        });
        for i in 0..count {
            for j in 0..count {
                let scale = (exact[(i, i)] * exact[(j, j)]).sqrt();
                assert!((found[(i, j)] - exact[(i, j)]).abs() < 1e-9 * scale, "{modes} modes: {i}, {j}");
                // reciprocity
                assert!((exact[(i, j)] - exact[(j, i)]).abs() < 1e-10 * scale);
            }
        }
        // sensors: displacement of the whole structure under port loads
        for (s, sensor) in body.sensors.iter().enumerate() {
            let surface = Surface::new(&housing.mesh);
            let angle = sensor.position[1].atan2(sensor.position[0]);
            let point = surface.outermost(&housing.mesh, angle, sensor.position[2]).unwrap();
            let reading = Reading::sensor(&point, Vector3::from(sensor.direction));
            let exact = reading.of(&structure, &statics);
            let largest = (0..6).map(|j| exact[(0, j)].abs()).fold(0.0, f64::max);
            for j in 0..6 {
                let found: f64 = (0..body.frequencies.len())
                    .map(|k| shapes[(count + s, k)] * shapes[(j, k)] / body.frequencies[k].powi(2))
                    .sum();
                assert!((found - exact[(0, j)]).abs() < 1e-8 * largest, "{}: {found}", sensor.name);
            }
        }
    }
}

#[test]
fn invariant_coordinates_have_unit_modal_mass_and_do_not_couple() {
    let housing = coarse();
    let structure = housing.structure().unwrap();
    let ReducedHousing { body, shapes, stats } = reduced(20);
    assert_eq!(stats.modes, 20);
    // every node of the housing is free
    let momenta = structure.mass(&shapes);
    let gram = product(shapes.transpose(), momenta.as_ref());
    // stiffness through its inverse: (M phi)^T K^-1 (M phi) = 1 / omega^2 for modes only
    for i in 0..gram.nrows() {
        assert!(i == 0 || body.frequencies[i - 1] <= body.frequencies[i]);
        for j in 0..gram.ncols() {
            assert!((gram[(i, j)] - f64::from(i == j)).abs() < 1e-7, "{i}, {j}: {}", gram[(i, j)]);
        }
    }
    let flexed = structure.solve(momenta.subcols(0, 20).to_owned());
    let inverse = product(momenta.as_ref().subcols(0, 20).transpose(), flexed.as_ref());
    for i in 0..20 {
        for j in 0..20 {
            let exact = if i == j { body.frequencies[i].powi(-2) } else { 0.0 };
            assert!((inverse[(i, j)] - exact).abs() < 1e-9 * body.frequencies[0].powi(-2), "{i}, {j}");
        }
    }
}

/// Undamped response at a port to a harmonic load on the seat, between resonances: the error falls with the number of modes.
#[test]
fn order_response_converges_with_modes() {
    let response = |body: &ElasticBody, frequency: f64| -> Vec<f64> {
        let shapes = rows(body);
        let (seat, port) = (6 * body.ports.len() + 3, 0..6 * body.ports.len());
        let omega = TAU * frequency;
        let of = |i: usize| {
            let term = |k: usize| shapes[(i, k)] * shapes[(seat, k)] / (body.frequencies[k].powi(2) - omega.powi(2));
            (0..body.frequencies.len()).map(term).sum()
        };
        port.map(of).collect()
    };
    let reference = reduced(80).body;
    let resonances: Vec<f64> = reference.frequencies.iter().map(|f| f / TAU).collect();
    // 60 % of the way from one resonance to the next
    let frequency = 0.4 * resonances[9] + 0.6 * resonances[10];
    let exact = response(&reference, frequency);
    let largest = exact.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let errors: Vec<f64> = [12, 20, 32, 50]
        .map(|modes| {
            let found = response(&reduced(modes).body, frequency);
            found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
        })
        .to_vec();
    assert!(errors.windows(2).all(|w| w[1] < w[0]), "{errors:?}");
    assert!(errors[2] < 1e-3 && errors[3] < 1e-4, "{errors:?}");
}

#[test]
fn invariant_threads_do_not_matter() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| reduced(12).body)
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.frequencies, three.frequencies);
    assert!(rows(&one) == rows(&three));
}
