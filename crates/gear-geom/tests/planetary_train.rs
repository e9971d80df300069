//! Planetary trains: the dissertation's numbers, and what must hold for any.

use std::f64::consts::TAU;

use gear_geom::{
    CentralMember, FlankSide, Member, MeshSite, PlanetaryTrain, PlanetaryTrainSpec, TrainError, TrainTooth,
};

use common::train::dissertation_spec;

mod common {
    pub mod train;
}

fn dissertation_train() -> PlanetaryTrain {
    PlanetaryTrain::new(&dissertation_spec()).unwrap()
}

fn whole(value: f64) -> bool {
    (value - value.round()).abs() < 1e-9
}

/// Section 5.2 and 6.3.2: speeds, frequencies, hunting periods, engagements of a damaged tooth. (The printed formula of the carrier's speed has `Z_r` where
/// its number, 347.5 rpm, needs `Z_s`.)
#[test]
fn peer_dissertation_section_5_2() {
    let train = dissertation_train();
    let rpm = TAU / 60.0;
    let sun = 6060.0 * 19.0 / 71.0 * rpm;
    let speeds = train.speeds([(CentralMember::Sun, sun), (CentralMember::Ring, 0.0)]).unwrap();
    let close = |value: f64, printed: f64, digit: f64| assert!((value - printed).abs() < digit, "{value}, {printed}");
    close(speeds.sun / rpm, 1621.7, 0.05);
    close(speeds.carrier / rpm, 347.5, 0.05);
    close(speeds.mesh_frequency, 573.4, 0.05);
    close(speeds.planet_pass_frequency, 17.375, 0.0005);
    assert_eq!((train.hunting_period(), train.sun_ring_period()), (105, 3));
    assert!(MeshSite::ALL.into_iter().all(|site| train.is_in_phase(site)));
    close(train.pair(MeshSite::PlanetRing).working_pressure_angle().to_degrees(), 20.19, 0.005);
    // one planet a planet-pass period meets a ring tooth; 11 planets a carrier turn meet a sun tooth, the first two 0.091 turns apart
    assert_eq!(train.engagements(TrainTooth::Ring(17), 0.0..3.0).unwrap().len(), 9);
    let meetings = train.engagements(TrainTooth::Sun(5), 0.0..3.0).unwrap();
    assert_eq!(meetings.len(), 33);
    meetings.windows(2).for_each(|pair| close(pair[1].carrier_turns - pair[0].carrier_turns, 0.114 - 0.023, 0.0005));
}

/// Teeth placed by angles alone: where a pair touches on the line of action, both flanks are at the contact point, for the driving flanks of all meshes, at any
/// time; the planet's teeth are the same for both meshes.
#[test]
fn invariant_flanks_touch_where_the_phases_say() {
    let spec = PlanetaryTrainSpec {
        planet_angles: [0.3, 0.3 + TAU * 40.0 / 126.0, 0.3 - TAU * 43.0 / 126.0].into(),
        ring_tooth_angle: 0.7,
        sun_tooth_angle: 2.0,
        ..dissertation_spec()
    };
    let train = PlanetaryTrain::new(&spec).unwrap();
    assert!(!train.is_in_phase(MeshSite::SunPlanet) && !train.is_in_phase(MeshSite::PlanetRing));
    assert!((train.sun_tooth_angle() - 2.0).abs() <= TAU / 54.0 + 1e-12);
    for (planet, psi) in spec.planet_angles.iter().enumerate() {
        let sun_offset = train.mesh_offset(MeshSite::SunPlanet, planet).unwrap();
        let ring_offset = train.mesh_offset(MeshSite::PlanetRing, planet).unwrap();
        for turns in [0.0, 0.123, 1.7, -0.4] {
            let travelled = 99.0 * turns;
            let psi = psi + TAU * turns;
            let (m_s, m_r) = (sun_offset + travelled, ring_offset + travelled);
            for (pair_s, pair_r) in [(m_s.round() as i32, m_r.round() as i32), (m_s.ceil() as i32, m_r.floor() as i32)]
            {
                let sun_pair = train.pair(MeshSite::SunPlanet);
                let ring_pair = train.pair(MeshSite::PlanetRing);
                let [sun_tooth, planet_tooth] =
                    train.teeth_of_pair(MeshSite::SunPlanet, planet, i64::from(pair_s)).unwrap();
                let [other_planet_tooth, ring_tooth] =
                    train.teeth_of_pair(MeshSite::PlanetRing, planet, i64::from(pair_r)).unwrap();
                // sun: turned since rest by the travelled pitches and with the carrier
                let sun = train.sun_tooth_angle() + TAU * (f64::from(sun_tooth) + travelled) / 27.0 + TAU * turns;
                let of_pair = sun_pair.tooth_angle(Member::Pinion, pair_s, m_s) + psi;
                assert!(whole((sun - of_pair) / TAU), "sun {sun} {of_pair}");
                // ring: at rest, in the mirrored frame of its pair
                let ring = spec.ring_tooth_angle + TAU * f64::from(ring_tooth) / 99.0;
                let of_pair = psi - ring_pair.tooth_angle(Member::Wheel, pair_r, m_r);
                assert!(whole((ring - of_pair) / TAU), "ring {ring} {of_pair}");
                // planet tooth 0, by the sun and by the ring
                let by_sun = sun_pair.tooth_angle(Member::Wheel, pair_s, m_s) - TAU * f64::from(planet_tooth) / 35.0;
                let by_ring =
                    -ring_pair.tooth_angle(Member::Pinion, pair_r, m_r) - TAU * f64::from(other_planet_tooth) / 35.0;
                assert!(whole((by_sun - by_ring) / TAU), "planet {by_sun} {by_ring}");
                if turns == 0.0 {
                    // tooth 0 points away from the axis to half a pitch
                    assert!((by_ring + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0 <= 0.5001 * TAU / 35.0);
                }
            }
        }
    }
}

/// Engagements are where the tooth's own pair touches at the pitch point, and numbers of pairs and teeth are each other's inverse.
#[test]
fn invariant_engagements() {
    let train = dissertation_train();
    for tooth in [TrainTooth::Sun(26), TrainTooth::Planet(1, 34), TrainTooth::Ring(98), TrainTooth::Planet(2, 0)] {
        let meetings = train.engagements(tooth, -1.0..2.0).unwrap();
        assert!(!meetings.is_empty());
        for meeting in &meetings {
            let offset = train.mesh_offset(meeting.site, meeting.planet).unwrap();
            assert!((99.0 * meeting.carrier_turns + offset - meeting.pair as f64).abs() < 1e-9);
            assert!((-1.0..2.0).contains(&meeting.carrier_turns));
            let [first, second] = train.teeth_of_pair(meeting.site, meeting.planet, meeting.pair).unwrap();
            let expected = match (meeting.site, tooth) {
                (MeshSite::SunPlanet, TrainTooth::Sun(own)) => (first, own),
                (MeshSite::SunPlanet, TrainTooth::Planet(_, own)) => (second, own),
                (MeshSite::PlanetRing, TrainTooth::Planet(_, own)) => (first, own),
                (MeshSite::PlanetRing, TrainTooth::Ring(own)) => (second, own),
                other => panic!("{other:?}"),
            };
            assert_eq!(expected.0, expected.1);
        }
    }
    // 99/35 turns of a planet against the carrier, each flank meets its gear once a turn
    let planet = train.engagements(TrainTooth::Planet(0, 3), 0.0..35.0).unwrap();
    assert_eq!(planet.len(), 2 * 99);
    assert_eq!(MeshSite::PlanetRing.side_in_pair(FlankSide::Upper), FlankSide::Lower);
}

/// Speeds from any two parts agree; pitch points have one speed.
#[test]
fn invariant_speeds() {
    use CentralMember::{Carrier, Ring, Sun};
    let train = dissertation_train();
    let speeds = train.speeds([(Sun, 170.0), (Ring, -12.0)]).unwrap();
    for given in [[(Sun, speeds.sun), (Carrier, speeds.carrier)], [(Ring, speeds.ring), (Carrier, speeds.carrier)]] {
        let again = train.speeds(given).unwrap();
        for (a, b) in [(again.sun, 170.0), (again.ring, -12.0), (again.planet, speeds.planet)] {
            assert!((a - b).abs() < 1e-10, "{a} {b}");
        }
    }
    let pair = train.pair(MeshSite::SunPlanet);
    let (r_s, r_p) = (pair.working_pitch_radius(Member::Pinion), pair.working_pitch_radius(Member::Wheel));
    let a = pair.centre_distance();
    assert!((speeds.sun * r_s - (speeds.carrier * a - speeds.planet * r_p)).abs() < 1e-12);
    let pair = train.pair(MeshSite::PlanetRing);
    let (r_p, r_r) = (pair.working_pitch_radius(Member::Pinion), pair.working_pitch_radius(Member::Wheel));
    assert!((speeds.ring * r_r - (speeds.carrier * a + speeds.planet * r_p)).abs() < 1e-12);
}

#[test]
fn extreme_trains_are_refused() {
    let spec = dissertation_spec();
    let refused = |change: &dyn Fn(&mut PlanetaryTrainSpec)| {
        let mut changed = spec.clone();
        change(&mut changed);
        PlanetaryTrain::new(&changed).unwrap_err()
    };
    assert_eq!(refused(&|spec| spec.planet_angles.clear()), TrainError::NoPlanet);
    let off = refused(&|spec| spec.planet_angles[1] += 0.02);
    assert!(matches!(off, TrainError::Assembly { planet: 1, nearest, .. } if whole(nearest * 126.0 / TAU)), "{off}");
    let close = refused(&|spec| spec.planet_angles = vec![0.0, TAU * 20.0 / 126.0]);
    assert!(matches!(close, TrainError::Collision { first: 0, second: 1, overlap } if overlap > 0.0), "{close}");
    assert!(matches!(refused(&|spec| spec.planet_angles[0] = f64::NAN), TrainError::NotFinite { .. }));
    assert!(matches!(refused(&|spec| spec.centre_distance = 95e-3), TrainError::Pair { .. }));
    assert!(matches!(refused(&|spec| spec.ring = spec.planet.clone()), TrainError::Kind { gear: "ring", .. }));
    let train = dissertation_train();
    let twice = train.speeds([(CentralMember::Sun, 1.0), (CentralMember::Sun, 1.0)]);
    assert_eq!(twice.unwrap_err(), TrainError::SpeedsUndetermined(CentralMember::Sun));
    assert!(matches!(train.mesh_offset(MeshSite::SunPlanet, 3), Err(TrainError::NoSuch { number: 3, count: 3, .. })));
    assert!(matches!(train.engagements(TrainTooth::Ring(0), 0.0..1e9), Err(TrainError::TooManyEngagements { .. })));
    assert!(matches!(train.engagements(TrainTooth::Ring(0), 0.0..f64::NAN), Err(TrainError::NotFinite { .. })));
    assert!(matches!(train.engagements(TrainTooth::Ring(99), 0.0..1.0), Err(TrainError::NoSuch { count: 99, .. })));
}
