//! Reading.

use std::collections::{BTreeMap, BTreeSet};

use fecm::Material;

use super::Units;
use super::lines::{Block, blocks, fault};
use crate::housing::element::Kind;
use crate::housing::error::HousingError;
use crate::housing::mesh::{Element, SolidMesh};

/// What has been read, by the numbers of the file.
#[derive(Default)]
struct Deck {
    nodes: BTreeMap<u64, [f64; 3]>,
    elements: BTreeMap<u64, (usize, Kind, Vec<u64>)>,
    node_sets: BTreeMap<String, BTreeSet<u64>>,
    element_sets: BTreeMap<String, BTreeSet<u64>>,
    materials: Vec<Constants>,
    /// Line, element set and material of the sections.
    sections: Vec<(usize, String, String)>,
}

/// A material as far as it is known.
struct Constants {
    name: String,
    line: usize,
    elastic: Option<[f64; 2]>,
    density: Option<f64>,
}

/// Reads a mesh from the text of an input file.
///
/// # Errors
/// [`HousingError::File`] with the line and what is wrong with it; faults of the mesh as a whole, see [`SolidMesh::validate`].
pub fn read(text: &str, units: &Units) -> Result<SolidMesh, HousingError> {
    let mut deck = Deck::default();
    for block in blocks(text)? {
        deck.take(&block)?;
    }
    deck.mesh(units)
}

impl Deck {
    fn take(&mut self, block: &Block) -> Result<(), HousingError> {
        match block.keyword.as_str() {
            "HEADING" | "PREPRINT" | "SURFACE" => Ok(()),
            "NODE" => self.nodes(block),
            "ELEMENT" => self.elements(block),
            "NSET" => {
                let known = self.nodes.keys().copied().collect();
                members(block, "NSET", &known, &mut self.node_sets)
            }
            "ELSET" => {
                let known = self.elements.keys().copied().collect();
                members(block, "ELSET", &known, &mut self.element_sets)
            }
            "MATERIAL" => {
                block.only(&["NAME"])?;
                let name = block.needed("NAME")?.to_owned();
                self.materials.push(Constants { name, line: block.line, elastic: None, density: None });
                Ok(())
            }
            "ELASTIC" => {
                block.only(&["TYPE"])?;
                if let Some(kind) = block.parameter("TYPE").filter(|kind| !kind.starts_with("iso")) {
                    return block.fault(format!("*ELASTIC of type {kind} is not understood; understood: ISOTROPIC"));
                }
                let values = constants(block, 2)?;
                self.material(block)?.elastic = Some([values[0], values[1]]);
                Ok(())
            }
            "DENSITY" => {
                block.only(&[])?;
                let values = constants(block, 1)?;
                self.material(block)?.density = Some(values[0]);
                Ok(())
            }
            "SOLID SECTION" => {
                block.only(&["ELSET", "MATERIAL", "CONTROLS"])?;
                let part = (block.line, block.needed("ELSET")?.to_owned(), block.needed("MATERIAL")?.to_owned());
                self.sections.push(part);
                Ok(())
            }
            keyword => block.fault(format!(
                "*{keyword} is not understood; understood: HEADING, NODE, ELEMENT, NSET, ELSET, MATERIAL, ELASTIC, DENSITY, SOLID SECTION"
            )),
        }
    }

    fn material(&mut self, block: &Block) -> Result<&mut Constants, HousingError> {
        match self.materials.last_mut() {
            Some(material) => Ok(material),
            None => block.fault(format!("*{} before the first *MATERIAL", block.keyword)),
        }
    }

    fn nodes(&mut self, block: &Block) -> Result<(), HousingError> {
        block.only(&["NSET"])?;
        let mut added = Vec::new();
        for (line, fields) in &block.data {
            if !(2..=4).contains(&fields.len()) {
                return fault(
                    *line,
                    format!("a node needs its number and up to three coordinates, not {} values", fields.len()),
                );
            }
            let id = whole(*line, &fields[0])?;
            let mut place = [0.0; 3];
            for (x, field) in place.iter_mut().zip(&fields[1..]) {
                *x = number(*line, field)?;
            }
            if self.nodes.insert(id, place).is_some() {
                return fault(*line, format!("node {id} is there already"));
            }
            added.push(id);
        }
        if let Some(name) = block.parameter("NSET") {
            self.node_sets.entry(name.to_owned()).or_default().extend(added);
        }
        Ok(())
    }

    fn elements(&mut self, block: &Block) -> Result<(), HousingError> {
        block.only(&["TYPE", "ELSET"])?;
        let name = block.needed("TYPE")?.to_uppercase();
        let kind = Kind::ALL.into_iter().find(|kind| kind.name() == name || (name == "C3D8" && *kind == Kind::Hex8));
        let Some(kind) = kind else {
            let known: Vec<&str> = Kind::ALL.iter().map(|kind| kind.name()).collect();
            return block
                .fault(format!("element type {name} is not understood; understood: C3D8, {}", known.join(", ")));
        };
        let mut added = Vec::new();
        let mut fields = block.data.iter().flat_map(|(line, fields)| fields.iter().map(|field| (*line, field)));
        while let Some((line, field)) = fields.next() {
            let id = whole(line, field)?;
            let nodes = fields
                .by_ref()
                .take(kind.nodes())
                .map(|(line, field)| whole(line, field))
                .collect::<Result<Vec<_>, _>>()?;
            if nodes.len() < kind.nodes() {
                return fault(
                    line,
                    format!("element {id} of type {name} has {} nodes, and needs {}", nodes.len(), kind.nodes()),
                );
            }
            if let Some(missing) = nodes.iter().find(|node| !self.nodes.contains_key(node)) {
                return fault(line, format!("element {id}: there is no node {missing} before it"));
            }
            if self.elements.insert(id, (line, kind, nodes)).is_some() {
                return fault(line, format!("element {id} is there already"));
            }
            added.push(id);
        }
        if let Some(name) = block.parameter("ELSET") {
            self.element_sets.entry(name.to_owned()).or_default().extend(added);
        }
        Ok(())
    }

    fn mesh(self, units: &Units) -> Result<SolidMesh, HousingError> {
        let mut materials = Vec::with_capacity(self.materials.len());
        for Constants { name, line, elastic, density } in &self.materials {
            let (Some([modulus, poisson_ratio]), Some(density)) = (elastic, density) else {
                return fault(*line, format!("material {name} needs *ELASTIC and *DENSITY"));
            };
            let constants = Material {
                young_modulus: modulus * units.stress,
                poisson_ratio: *poisson_ratio,
                density: density * units.density,
            };
            constants.validate().or_else(|reason| fault(*line, format!("material {name}: {reason}")))?;
            materials.push((name.clone(), constants));
        }
        let mut material_of: BTreeMap<u64, usize> = BTreeMap::new();
        for (line, set, material) in &self.sections {
            let Some(index) = materials.iter().position(|(name, _)| name == material) else {
                return fault(*line, format!("there is no material {material}"));
            };
            let Some(members) = self.element_sets.get(set) else {
                return fault(*line, format!("there is no element set {set}"));
            };
            for &element in members {
                if material_of.insert(element, index).is_some_and(|other| other != index) {
                    return fault(*line, format!("element {element} has another material already"));
                }
            }
        }
        let used: BTreeSet<u64> = self.elements.values().flat_map(|(_, _, nodes)| nodes.iter().copied()).collect();
        let numbers: BTreeMap<u64, u32> = used.iter().enumerate().map(|(k, &id)| (id, k as u32)).collect();
        let mut elements = Vec::with_capacity(self.elements.len());
        for (id, (line, kind, nodes)) in &self.elements {
            let Some(&material) = material_of.get(id) else {
                return fault(*line, format!("element {id} is in no *SOLID SECTION"));
            };
            let nodes = nodes.iter().map(|node| numbers[node]).collect();
            elements.push(Element { kind: *kind, material, nodes });
        }
        let set = |members: &BTreeSet<u64>| members.iter().filter_map(|id| numbers.get(id).copied()).collect();
        let mesh = SolidMesh {
            nodes: used.iter().map(|id| self.nodes[id].map(|x| x * units.length)).collect(),
            elements,
            materials,
            node_sets: self.node_sets.iter().map(|(name, members)| (name.clone(), set(members))).collect(),
        };
        mesh.validate()?;
        Ok(mesh)
    }
}

/// Adds the members of a set: numbers, names of other sets, or ranges.
fn members(
    block: &Block,
    parameter: &str,
    known: &BTreeSet<u64>,
    sets: &mut BTreeMap<String, BTreeSet<u64>>,
) -> Result<(), HousingError> {
    block.only(&[parameter, "GENERATE", "UNSORTED"])?;
    let name = block.needed(parameter)?.to_owned();
    let mut added = BTreeSet::new();
    for (line, fields) in &block.data {
        if block.parameter("GENERATE").is_some() {
            let values = fields.iter().map(|field| whole(*line, field)).collect::<Result<Vec<_>, _>>()?;
            let (first, last, step) = match values[..] {
                [first, last] => (first, last, 1),
                [first, last, step] if step > 0 => (first, last, step),
                _ => return fault(*line, "a range needs first, last and, if not 1, a step above 0".to_owned()),
            };
            let inside = known.range(first..=last.max(first)).copied();
            added.extend(inside.filter(|id| (id - first) % step == 0 && *id <= last));
            continue;
        }
        for field in fields {
            match (field.parse::<u64>(), sets.get(&field.to_lowercase())) {
                (Ok(id), _) if known.contains(&id) => {
                    added.insert(id);
                }
                (Ok(id), _) => return fault(*line, format!("set {name}: there is no number {id} before it")),
                (Err(_), Some(other)) => added.extend(other),
                (Err(_), None) => {
                    return fault(*line, format!("set {name}: `{field}` is neither a number nor a set before it"));
                }
            }
        }
    }
    sets.entry(name).or_default().extend(added);
    Ok(())
}

/// The constants of a material on one data line; a second line would be temperature.
fn constants(block: &Block, count: usize) -> Result<Vec<f64>, HousingError> {
    let [(line, fields)] = &block.data[..] else {
        return block.fault(format!("*{} needs one data line (no temperature)", block.keyword));
    };
    // a further value is the temperature that goes with a single line
    if fields.len() < count || fields.len() > count + 1 {
        return fault(*line, format!("*{} needs {count} values, not {}", block.keyword, fields.len()));
    }
    fields[..count].iter().map(|field| number(*line, field)).collect()
}

fn number(line: usize, field: &str) -> Result<f64, HousingError> {
    let plain = field.replace(['d', 'D'], "e");
    match plain.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => fault(line, format!("`{field}` is not a number")),
    }
}

fn whole(line: usize, field: &str) -> Result<u64, HousingError> {
    field.parse().or_else(|_| fault(line, format!("`{field}` is not a whole number")))
}
