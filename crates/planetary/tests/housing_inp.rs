//! Meshes from and to text.

use fecm::Material;
use planetary::housing::block::block;
use planetary::housing::element::Kind;
use planetary::housing::inp::{Units, read, write};
use planetary::housing::{Casing, HousingError};

const MATERIAL: Material = Material { young_modulus: 70e9, poisson_ratio: 0.3, density: 2700.0 };

const TETRAHEDRON: &str = "\
*Heading
 two tetrahedra
** a comment
*NODE, NSET=corners
1, 0., 0., 0.
2, 10., 0., 0.
3, 0., 1.D1, 0.
7, 0., 0., 10.
*NODE
8, 10.0, 10.0, 10.0
99, 5., 5., 5.
*Element, type=c3d4,
 elset=Body
4, 1, 2, 3,
7
5, 2, 8, 3, 7
*NSET, NSET=some, GENERATE
1, 99, 2
*NSET, NSET=Both
some, 8
*MATERIAL, NAME=Alu
*ELASTIC
70000., 0.3
*DENSITY
2.7e-9,
*SOLID SECTION, ELSET=BODY, MATERIAL=alu
*STEP
*STATIC
*END STEP
";

#[test]
fn analytic_small_file() {
    let mesh = read(TETRAHEDRON, &Units::MILLIMETRE).unwrap();
    assert_eq!(mesh.nodes.len(), 5, "node 99 is in no element");
    assert_eq!(mesh.nodes[2], [0.0, 0.01, 0.0]);
    assert_eq!(mesh.elements[0].nodes, [0, 1, 2, 3]);
    assert_eq!(mesh.elements[1].nodes, [1, 4, 2, 3]);
    assert_eq!(mesh.set("corners").unwrap(), [0, 1, 2, 3]);
    assert_eq!(mesh.set("both").unwrap(), [0, 2, 3, 4]);
    let material = mesh.materials[0].1;
    assert!((material.young_modulus - 70e9).abs() < 1.0 && (material.density - 2700.0).abs() < 1e-9);
    // 1/6 and 1/3 of the cube of 10 mm
    assert!((mesh.inertia().unwrap().mass - 0.5 * 2700.0 * 1e-6).abs() < 1e-15);
}

#[test]
fn invariant_written_meshes_are_read_back() {
    let casing = {
        let mut casing = Casing::default();
        casing.density.element_size = 0.08;
        casing.housing().unwrap().mesh
    };
    let blocks = Kind::ALL.map(|kind| block(kind, [2, 1, 2], MATERIAL, |x| x.map(|x| 0.1 * x + 0.01 / 3.0)));
    for mesh in blocks.iter().chain([&casing]) {
        for units in [Units::SI, Units::MILLIMETRE] {
            let text = write(mesh, &units);
            let mut back = read(&text, &units).unwrap();
            assert_eq!(back.node_sets.remove("all").unwrap().len(), mesh.nodes.len());
            assert_eq!((&back.elements, &back.node_sets), (&mesh.elements, &mesh.node_sets));
            for (a, b) in back.nodes.iter().zip(&mesh.nodes) {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-13 * b.abs().max(1e-6)), "{a:?} {b:?}");
            }
            for ((name, a), (other, b)) in back.materials.iter().zip(&mesh.materials) {
                assert_eq!(name, other);
                assert!(
                    (a.young_modulus / b.young_modulus - 1.0).abs() < 1e-13
                        && (a.density / b.density - 1.0).abs() < 1e-13
                );
            }
            let numbers = text.lines().filter(|line| !line.starts_with('*')).flat_map(|line| line.split(','));
            assert!(numbers.map(|field| field.trim().len()).all(|width| width <= 20), "fields of CalculiX");
        }
    }
}

/// Each fault is told with its line and what is not understood.
#[test]
fn extreme_faults_name_line_and_word() {
    let faults = [
        ("8, 10.0, 10.0, 10.0", "8, 10.0, ten, 10.0", 10, "`ten` is not a number"),
        ("8, 10.0, 10.0, 10.0", "7, 10.0, 10.0, 10.0", 10, "node 7 is there already"),
        ("type=c3d4", "type=s4", 12, "element type S4 is not understood"),
        ("5, 2, 8, 3, 7", "5, 2, 8, 3", 16, "has 3 nodes, and needs 4"),
        ("5, 2, 8, 3, 7", "5, 2, 8, 3, 77", 16, "no node 77"),
        ("some, 8", "sum, 8", 20, "`sum` is neither"),
        ("some, 8", "some, 80", 20, "no number 80"),
        ("1, 99, 2", "1, 99, 0", 18, "step above 0"),
        ("*ELASTIC", "*ELASTIC, TYPE=ORTHO", 22, "type ortho"),
        ("*ELASTIC", "*PLASTIC", 22, "*PLASTIC is not understood"),
        ("70000., 0.3", "70000., 0.5", 21, "material alu: poisson_ratio"),
        ("2.7e-9,", "", 24, "*DENSITY needs one data line"),
        ("ELSET=BODY, MATERIAL=alu", "ELSET=BODY, MATERIAL=steel", 26, "no material steel"),
        ("ELSET=BODY, MATERIAL=alu", "ELSET=corners, MATERIAL=alu", 26, "no element set corners"),
        ("*SOLID SECTION, ELSET=BODY, MATERIAL=alu", "", 14, "element 4 is in no *SOLID SECTION"),
        ("*Heading", "1, 2", 1, "before the first keyword"),
        ("*NODE, NSET=corners", "*NODE, SYSTEM=C", 4, "parameter SYSTEM of *NODE"),
        ("*ELASTIC", "*BOUNDARY", 22, "*BOUNDARY is not understood"),
    ];
    for (from, to, line, part) in faults {
        let text = TETRAHEDRON.replacen(from, to, 1);
        assert_ne!(text, TETRAHEDRON);
        match read(&text, &Units::SI) {
            Err(HousingError::File { line: found, message }) => {
                assert!(message.contains(part), "{message}");
                assert_eq!(found, line, "{message}");
            }
            other => panic!("{from} -> {to}: {other:?}"),
        }
    }
}
