//! scratch
use fecm::statics::*;
use gear_geom::*;
fn main() {
    let config = std::env::args().nth(1).unwrap();
    let case = gearwright::case::load_spur_pair(std::path::Path::new(&config)).unwrap();
    let t = std::time::Instant::now();
    let m = PairModel::new(&case.pair, &case.options).unwrap();
    println!("healthy model {:?}", t.elapsed());
    let cycles: Vec<f64> = (0..100).map(|k| -1.0 + f64::from(k) / 50.0).collect();
    let solve = |m: &PairModel| {
        m.solve(
            &StaticsRequest {
                mesh_cycles: cycles.clone(),
                torques: vec![424.0],
                stiffness_difference: false,
                keep_pressure: false,
            },
            &(),
        )
        .unwrap()
    };
    let h = solve(&m);
    println!(
        "healthy {:?} max {}",
        h.time,
        h.results[0].iter().map(|r| r.static_transmission_error).fold(0.0, f64::max) * 1e6
    );
    for f in [0.2, 0.5, 0.8] {
        let d = [
            vec![ToothDamage { tooth: 0, damage: Damage::Crack(RootCrack::along_chord(FlankSide::Upper, f)) }],
            vec![],
        ];
        let t = std::time::Instant::now();
        let c = m.with_damage(&d).unwrap();
        println!("crack {f}: model {:?}", t.elapsed());
        let r = solve(&c);
        let (mx, at) = r.results[0]
            .iter()
            .map(|r| (r.static_transmission_error, r.mesh_cycle))
            .fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
        println!("  contact {:?} max {} at {at}", r.time, mx * 1e6);
        for c in [-0.35, 0.03, -0.03] {
            let k = cycles.iter().position(|x| (x - c).abs() < 0.0101).unwrap();
            println!(
                "   {} +{:.2} %  ka {:.2} from {:.2}",
                cycles[k],
                100.0 * (r.results[0][k].static_transmission_error / h.results[0][k].static_transmission_error - 1.0),
                r.results[0][k].stiffness_average_slope.unwrap() * 1e-6,
                h.results[0][k].stiffness_average_slope.unwrap() * 1e-6
            );
        }
        let affected = r.results[0]
            .iter()
            .zip(&h.results[0])
            .filter(|(a, b)| a.static_transmission_error > 1.01 * b.static_transmission_error)
            .count() as f64
            / 50.0;
        println!("   affected {affected}");
    }
    let roll = case.pair.pitch_roll();
    for (w, hgt) in [(12.7e-3, 2.76e-3)] {
        let d = [vec![ToothDamage { tooth: 0, damage: Damage::Pit(Pit::ellipse(0.0, roll, w, hgt)) }], vec![]];
        let c = m.with_damage(&d).unwrap();
        let r = solve(&c);
        let worst = r.results[0]
            .iter()
            .zip(&h.results[0])
            .map(|(a, b)| (a.static_transmission_error / b.static_transmission_error - 1.0, a.mesh_cycle))
            .fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
        println!("pit: {:?} worst +{:.2} % at {}", r.time, worst.0 * 100.0, worst.1);
    }
}
