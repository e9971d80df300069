//! Writing.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Units;
use crate::housing::mesh::SolidMesh;

/// Values a line.
const PER_LINE: usize = 10;

/// Text of an input file with the mesh, its sets and materials; numbers from 1 in the order of the mesh. Reading it again gives the same
/// mesh but for rounding: CalculiX reads fields of 20 characters, which hold 14 digits.
#[must_use]
pub fn write(mesh: &SolidMesh, units: &Units) -> String {
    let mut text = String::new();
    line(&mut text, format_args!("*NODE, NSET=all"));
    for (k, node) in mesh.nodes.iter().enumerate() {
        let [x, y, z] = node.map(|x| x / units.length);
        line(&mut text, format_args!("{}, {x:.13e}, {y:.13e}, {z:.13e}", k + 1));
    }
    let mut groups: BTreeMap<(usize, &'static str), Vec<usize>> = BTreeMap::new();
    for (k, element) in mesh.elements.iter().enumerate() {
        groups.entry((element.material, element.kind.name())).or_default().push(k);
    }
    for ((material, kind), elements) in groups {
        line(&mut text, format_args!("*ELEMENT, TYPE={kind}, ELSET={}", mesh.materials[material].0));
        for k in elements {
            let numbers = std::iter::once(k + 1).chain(mesh.elements[k].nodes.iter().map(|&node| node as usize + 1));
            list(&mut text, numbers, true);
        }
    }
    for (name, nodes) in &mesh.node_sets {
        line(&mut text, format_args!("*NSET, NSET={name}"));
        list(&mut text, nodes.iter().map(|&node| node as usize + 1), false);
    }
    for (name, material) in &mesh.materials {
        let (modulus, density) = (material.young_modulus / units.stress, material.density / units.density);
        line(&mut text, format_args!("*MATERIAL, NAME={name}\n*ELASTIC\n{modulus:e}, {:e}", material.poisson_ratio));
        line(&mut text, format_args!("*DENSITY\n{density:e}"));
        if mesh.elements.iter().any(|element| mesh.materials[element.material].0 == *name) {
            line(&mut text, format_args!("*SOLID SECTION, ELSET={name}, MATERIAL={name}"));
        }
    }
    text
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    // writing to a string does not fail
    let _ = writeln!(text, "{content}");
}

/// Numbers separated by commas, some a line; `continued` lines end with a comma.
fn list(text: &mut String, numbers: impl Iterator<Item = usize>, continued: bool) {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    let separator = if continued { ",\n" } else { "\n" };
    let lines: Vec<String> = numbers.chunks(PER_LINE).map(|chunk| chunk.join(", ")).collect();
    line(text, format_args!("{}", lines.join(separator)));
}
