//! The parametric housing: what it is made of, faults, convergence with the mesh.

use std::f64::consts::TAU;

use planetary::housing::casing::{Casing, CasingDensity};
use planetary::housing::{Damping, Housing, HousingError, ReductionOptions, SensorAt};

fn default_at(element_size: f64) -> Casing {
    let density = CasingDensity { element_size, through_wall: 1, through_ring: 1 };
    Casing { density, ..Casing::default() }
}

/// The same body at any density: mass, centre, places of ports; and all of it right side out.
#[test]
fn invariant_shape_does_not_depend_on_the_mesh() {
    let (coarse, fine) = (default_at(0.04).housing().unwrap(), default_at(0.012).housing().unwrap());
    assert!(fine.mesh.nodes.len() > 4 * coarse.mesh.nodes.len());
    let (a, b) = (coarse.mesh.inertia().unwrap(), fine.mesh.inertia().unwrap());
    assert!((a.mass / b.mass - 1.0).abs() < 2e-3, "{a:?} {b:?}");
    // swellings follow their shape as closely as elements of 40 mm can
    assert!((0..3).all(|d| (a.centre[d] - b.centre[d]).abs() < 4e-4), "{a:?} {b:?}");
    assert_eq!(coarse.ports, fine.ports);
    for set in ["support_1", "support_2", "restraint"] {
        let reach = |housing: &Housing| -> f64 {
            let angles = housing.mesh.set(set).unwrap().iter().map(|&n| housing.mesh.node(n)).map(|x| x.y.atan2(x.x));
            let (low, high) = angles.fold((f64::MAX, f64::MIN), |(low, high), a| (low.min(a), high.max(a)));
            high - low
        };
        assert!((reach(&coarse) - reach(&fine)).abs() < 1e-12, "{set}");
    }
}

/// Steel ring by Pappus: `pi (R^2 - r^2) h rho`.
#[test]
fn analytic_mass_of_the_ring() {
    let mut mesh = default_at(0.03).housing().unwrap().mesh;
    mesh.elements.retain(|element| element.material == 1);
    let exact = 0.5 * TAU * (0.1483_f64.powi(2) - 0.1419_f64.powi(2)) * 0.0254 * 7800.0;
    let found = mesh.inertia().unwrap().mass;
    assert!((found / exact - 1.0).abs() < 1e-5, "{found} against {exact}");
    let seat = mesh.set("ring_seat").unwrap();
    assert!(seat.iter().all(|&n| (mesh.node(n).xy().norm() - 0.1419).abs() < 1e-12 && mesh.node(n).z.abs() < 0.0128));
}

/// One sensor near the input, one at each tooth that no support covers: 85 of 99.
#[test]
fn invariant_sensors_of_the_default() {
    let casing = Casing::default();
    assert_eq!(casing.sensors.len(), 1 + 85);
    assert_eq!((casing.sensors[0].name.as_str(), casing.sensors[1].name.as_str()), ("input", "tooth_0"));
    let options = ReductionOptions { modes: 0, highest_frequency: 0.0, damping: Damping::Ratio(0.02) };
    let body = Casing { seat_harmonics: 2, ..default_at(0.04) }.housing().unwrap().reduce(&options).unwrap().body;
    for (place, sensor) in casing.sensors.iter().zip(&body.sensors) {
        let [x, y, z] = sensor.position;
        let SensorAt::Wall { angle, .. } = place.at else { panic!("on the wall") };
        assert!(z.abs() < 1e-12 && (y.atan2(x).rem_euclid(TAU) - angle).abs() < 1e-12, "{}", sensor.name);
        // the wall is 156.3 mm wide outside, less what parabolas of 40 mm dip (half a millimetre) beside the swellings, which reach beyond the supports
        let radius = x.hypot(y);
        assert!(radius > 0.1555 && radius < 0.165, "{}: {radius}", sensor.name);
    }
}

#[test]
fn extreme_faults_of_a_casing() {
    let fault = |change: &dyn Fn(&mut Casing)| {
        let mut casing = default_at(0.04);
        change(&mut casing);
        casing.housing().and_then(|housing| housing.mesh.inertia().map(|_| ())).unwrap_err()
    };
    let named = |change: &dyn Fn(&mut Casing)| match fault(change) {
        HousingError::Value { name, .. } => name,
        other => panic!("{other}"),
    };
    assert_eq!(named(&|c| c.wall[3].thickness = 0.0), "wall thickness");
    assert_eq!(named(&|c| c.wall[3].r = f64::NAN), "wall radius");
    assert_eq!(named(&|c| c.wall[4] = c.wall[3]), "length of a wall segment");
    assert_eq!(named(&|c| c.wall.truncate(1)), "wall points");
    assert_eq!(named(&|c| c.mounts[0].segments = [5, 99]), "wall segment");
    assert_eq!(named(&|c| c.density.element_size = 1e-9), "element size");
    assert_eq!(named(&|c| c.density.through_wall = 0), "elements through wall or ring");
    assert_eq!(named(&|c| c.input.as_mut().unwrap().thickness = 0.05), "boss thickness");
    assert_eq!(named(&|c| c.input.as_mut().unwrap().width = 4.0), "input width");
    assert_eq!(named(&|c| c.input.as_mut().unwrap().bearings.reverse()), "bearing span of the input port");
    // a boss that ends inside the wall, a ring larger than the wall
    assert!(matches!(
        fault(&|c| c.input.as_mut().unwrap().bearings.iter_mut().for_each(|b| b.span = b.span.map(|x| x - 0.1))),
        HousingError::InvertedElement { .. }
    ));
    assert!(matches!(fault(&|c| c.ring.as_mut().unwrap().inner_radius = 0.2), HousingError::InvertedElement { .. }));
    // nothing holds it
    let loose = Casing { mounts: Vec::new(), ..default_at(0.04) }.housing().unwrap();
    assert!(matches!(loose.structure().map(|_| ()), Err(HousingError::NotHeld { .. })));
}

/// First 20 frequencies on meshes of 30 and 20 mm against 13 mm: the worst of them is 1.9 % too high on the default mesh, 2.9 % on the coarse one.
#[test]
#[ignore = "slow: 30 s on an idle core"]
fn order_default_housing_converges_with_the_mesh() {
    let frequencies = |size: f64| {
        let options = ReductionOptions { modes: 20, highest_frequency: f64::INFINITY, damping: Damping::Ratio(0.02) };
        let Housing { mesh, mounts, .. } = default_at(size).housing().unwrap();
        Housing { mesh, mounts, ..Housing::default() }.reduce(&options).unwrap().body.frequencies
    };
    let finest = frequencies(0.013);
    let worst = |size: f64| -> f64 {
        frequencies(size).iter().zip(&finest).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
    };
    let (coarse, default) = (worst(0.03), worst(0.02));
    assert!(default < coarse && default < 0.025, "30 mm: {coarse:.2e}, 20 mm (default): {default:.2e}");
    println!("30 mm: {coarse:.2e}, 20 mm (default): {default:.2e} of 13 mm; first {:.2} Hz", finest[0] / TAU);
}
