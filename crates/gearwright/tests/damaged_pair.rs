//! Damage in case files: what a run leaves, and what is said of damage that cannot be.

#[macro_use]
mod common;

use std::path::Path;
use std::process::Output;

use common::{Scratch, gearwright};

const PAIR: &str = spur_pair!(
    "",
    r#"
[analysis]
positions_per_cycle = 8
mesh_cycle_from = -1.0
mesh_cycle_to = 1.0
model = "MODEL"

[numerics]
face_cells = 16
face_order = 4

"#
);

fn run(scratch: &Scratch, model: &str, damage: &str) -> Output {
    scratch.write("case.toml", &(PAIR.replace("MODEL", model) + damage));
    gearwright(scratch.path(), &["run", "case.toml"])
}

fn column(file: &Path, name: &str) -> Vec<f64> {
    let mut table = csv::Reader::from_path(file).unwrap();
    let index = table.headers().unwrap().iter().position(|header| header == name).unwrap();
    table.records().map(|record| record.unwrap()[index].parse().unwrap()).collect()
}

#[test]
fn crack_on_the_coast_side_closes_and_is_felt_less() {
    let scratch = Scratch::new();
    let increase_with = |keys: &str| {
        let damage = format!("[[damage]]\non = \"pinion\"\ncrack.length_percent = [30.0, 60.0]\n{keys}");
        let output = run(&scratch, "plane-strain", &damage);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let folder = scratch.path().join("out/case");
        (column(&folder.join("damage.csv"), "ste_increase_max_percent"), folder)
    };
    let (opening, _) = increase_with("");
    let (closing, folder) = increase_with("crack.side = \"coast\"\n");
    assert!(
        closing.iter().zip(&opening).all(|(closed, open)| 0.0 < *closed && *closed < 0.5 * open),
        "{closing:?} {opening:?}"
    );
    let forces = column(&folder.join("series_damage_2.csv"), "pinion_tooth_0_crack_face_force_n");
    assert!(forces.iter().all(|&force| force >= 0.0) && forces.iter().any(|&force| force > 100.0), "{forces:?}");
    assert!(column(&folder.join("damage.csv"), "crack_face_force_max_n")[1] > 100.0);
}

#[test]
fn sweep_of_cracks_and_pits_leaves_tables_plots_and_grids() {
    for (model, damage, files) in [
        ("plane-strain", "[[damage]]\non = \"pinion\"\ncrack.length_percent = [0.0, 20.0, 60.0]\n", 3),
        ("3d", "[[damage]]\non = \"gear\"\npit.width_mm = [2.0, 8.0]\npit.height_mm = [1.0, 3.0]\n", 2),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\nwear.depth_um = [4.0, 8.0]\n[[damage]]\non = \"pinion\"\nbroken_corner.length_mm = 4.0\nbroken_corner.height_mm = [1.0, 2.0]\n",
            2,
        ),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ncrack.length_mm = 3.0\n[[damage]]\non = \"gear\"\npit.at = \"hpstc\"\npit.width_mm = 4.0\npit.height_mm = 2.0\n",
            1,
        ),
    ] {
        let scratch = Scratch::new();
        let output = run(&scratch, model, &format!("{damage}[output]\nroot_stress = true\n"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let folder = scratch.path().join("out/case");
        let increase = column(&folder.join("damage.csv"), "ste_increase_max_percent");
        assert_eq!(increase.len(), files);
        assert!(increase.windows(2).all(|pair| pair[0] < pair[1]), "{increase:?}");
        assert!(increase.last().unwrap() > &1.0, "{increase:?}");
        let healthy = column(&folder.join("series.csv"), "ste_um");
        for k in 1..=files {
            let damaged = column(&folder.join(format!("series_damage_{k}.csv")), "ste_um");
            assert_eq!(damaged.len(), healthy.len());
            assert!(damaged.iter().zip(&healthy).all(|(d, h)| d > &(0.999 * h)));
        }
        let tensions = column(&folder.join("series.csv"), "pair_0_pinion_root_tension_mpa");
        assert!(tensions.iter().all(|&t| t >= 0.0) && tensions.iter().any(|&t| t > 10.0), "{tensions:?}");
        if damage.contains("0.0, 20.0") {
            let opening = |k: u32| {
                let column = column(&folder.join(format!("series_damage_{k}.csv")), "pinion_tooth_0_k_one_mpa_sqrt_m");
                column.into_iter().fold(0.0, f64::max)
            };
            assert!(opening(2) > 0.1 && opening(3) > opening(2), "{} {}", opening(2), opening(3));
            assert_eq!(column(&folder.join("crack_front_3.csv"), "tooth"), vec![0.0; healthy.len()]);
            assert!(!folder.join("crack_front_1.csv").exists() && folder.join("damage_stress_intensity.png").exists());
            assert_eq!(healthy, column(&folder.join("series_damage_1.csv"), "ste_um"), "no crack is healthy");
        }
        for name in ["damage_stress_intensity_by_length.svg", "damage_root_stress_by_length.png"] {
            assert_eq!(folder.join(name).exists(), damage.contains("0.0, 20.0"), "{name}: only for sweeps of cracks");
        }
        for name in [
            "damage_transmission_error.png",
            "damage_mesh_stiffness.svg",
            "damage_pinion.vtu",
            "damage_flank_pressure.png",
        ] {
            assert!(folder.join(name).metadata().unwrap().len() > 100, "{name}");
        }
    }
}

#[test]
fn impossible_damage_is_explained_at_its_line() {
    for (model, damage, wanted) in [
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ntooth = 25\ncrack.length_percent = 10.0\n",
            &["case.toml:39", "tooth", "25", "0 to 24"][..],
        ),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ncrack.length_percent = 120.0\n",
            &["case.toml:39", "crack.length_percent", "97"],
        ),
        (
            "plane-strain",
            "[[damage]]\non = \"pinion\"\ncrack.length_percent = 20.0\ncrack.front_percent = [0.0, 100.0]\n",
            &["front_percent", "3d"],
        ),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ncrack.length_percent = 20.0\ncrack.front_percent = [0.0, 50.0, 100.0]\n",
            &["front_percent", "two values"],
        ),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ncrack.length_percent = 20.0\ncrack.front_percent = [0.0, 120.0]\n",
            &["front_percent", "0 to 100", "120"],
        ),
        ("3d", "[[damage]]\non = \"pinion\"\ncrack.length_mm = 50.0\n", &["case.toml:39", "crack", "chord"]),
        ("3d", "[[damage]]\non = \"pinion\"\ncrack.length_mm = 2.0\ncrack.start_tangent_deg = 1.0\n", &["tangent"]),
        ("3d", "[[damage]]\non = \"pinion\"\ncrack.length_mm = 2.0\ncrack.start_radius_mm = 1.0\n", &["radius"]),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ncrack.length_mm = 2.0\ncrack.path_across_mm = [1.0, 2.0]\n",
            &["path_across_mm", "2 and 0 values"],
        ),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\ncrack.length_mm = 2.0\ncrack.path_across_mm = [1.0, 2.0]\ncrack.path_inward_mm = [0.2, 0.6]\ncrack.direction_deg = 60.0\n",
            &["direction_deg", "path_across_mm"],
        ),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\npit.roll_distance_mm = 99.0\npit.width_mm = 1.0\npit.height_mm = 1.0\n",
            &["pit", "active flank"],
        ),
        ("plane-strain", "[[damage]]\non = \"pinion\"\npit.width_mm = 1.0\npit.height_mm = 1.0\n", &["pit", "3d"]),
        ("3d", "[[damage]]\non = \"pinion\"\n", &["case.toml:37", "a crack or a pit or wear or a broken corner"]),
        ("3d", "[[damage]]\non = \"wheel\"\ncrack.length_mm = 1.0\n", &["case.toml:38", "wheel", "gear"]),
        ("3d", "[[damage]]\non = \"gear\"\ncrack.lenght_mm = 1.0\n", &["case.toml:39", "lenght_mm", "length_mm"]),
        ("3d", "[[damage]]\non = \"gear\"\nwear.depth_um = -1.0\n", &["case.toml:39", "wear.depth_um", "0 to 100000"]),
        ("3d", "[[damage]]\non = \"gear\"\nwear.scale = 2.0\n", &["case.toml:39", "depth_um or table"]),
        ("3d", "[[damage]]\non = \"gear\"\nwear.table = \"nothing.csv\"\n", &["case.toml:39", "cannot be read"]),
        (
            "3d",
            "[[damage]]\non = \"gear\"\nbroken_corner.length_mm = 20.0\nbroken_corner.height_mm = 2.0\n",
            &["case.toml:39", "0 to 16", "facewidth"],
        ),
        (
            "plane-strain",
            "[[damage]]\non = \"gear\"\nbroken_corner.length_mm = 2.0\nbroken_corner.height_mm = 2.0\n",
            &["broken corner", "3d"],
        ),
        ("3d", "[damage]\non = \"gear\"\n", &["case.toml:37", "[[damage]]"]),
        (
            "3d",
            "[[damage]]\non = \"pinion\"\npit.width_mm = [1.0, 2.0]\npit.height_mm = [1.0, 2.0, 3.0]\n",
            &["case.toml:39", "same length", "3"],
        ),
    ] {
        let scratch = Scratch::new();
        let output = run(&scratch, model, damage);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success(), "{damage} was accepted");
        for word in wanted {
            assert!(message.contains(word), "{damage:?}: \"{word}\" is missing in: {message}");
        }
        assert!(!message.contains("panicked") && !scratch.path().join("out").exists(), "{message}");
    }
}
