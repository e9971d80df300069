//! A mesh of solid elements, and its outer surface.

use std::collections::BTreeMap;

use fecm::Material;
use nalgebra::Vector3;

use super::element::{Kind, RulePoint, Shape};
use super::error::HousingError;

/// An element.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its kind.
    pub kind: Kind,
    /// Index of its material.
    pub material: usize,
    /// Its nodes, in the order of the kind.
    pub nodes: Vec<u32>,
}

/// Elements, nodes and named sets of nodes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SolidMesh {
    /// Coordinates of the nodes (m).
    pub nodes: Vec<[f64; 3]>,
    /// Elements.
    pub elements: Vec<Element>,
    /// Names and constants of the materials.
    pub materials: Vec<(String, Material)>,
    /// Named sets of nodes, each sorted, without repetition.
    pub node_sets: BTreeMap<String, Vec<u32>>,
}

/// Total mass and its moments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass (m).
    pub centre: [f64; 3],
    /// Moments of inertia about axes through the origin, `int (|x|^2 1 - x x^T) rho dV` (kg m^2).
    pub about_origin: [[f64; 3]; 3],
}

impl SolidMesh {
    /// Checks that elements point to nodes and materials that exist, sets to nodes, and that constants are in range.
    ///
    /// # Errors
    /// [`HousingError::Dangling`], [`HousingError::Value`], [`HousingError::Algebra`].
    pub fn validate(&self) -> Result<(), HousingError> {
        for (element, Element { kind, material, nodes }) in self.elements.iter().enumerate() {
            let dangling = |what, index| Err(HousingError::Dangling { element, what, index });
            if nodes.len() != kind.nodes() {
                return dangling("the number of nodes", nodes.len());
            }
            if *material >= self.materials.len() {
                return dangling("material", *material);
            }
            if let Some(&node) = nodes.iter().find(|&&node| node as usize >= self.nodes.len()) {
                return dangling("node", node as usize);
            }
        }
        for (_, material) in &self.materials {
            material.validate()?;
        }
        if let Some(value) = self.nodes.iter().flatten().find(|x| !x.is_finite()) {
            return Err(HousingError::Value { name: "coordinate", value: *value, allowed: "a number of m" });
        }
        let highest = self.node_sets.values().flatten().max();
        match highest {
            Some(&node) if node as usize >= self.nodes.len() => Err(HousingError::Value {
                name: "node of a set",
                value: f64::from(node),
                allowed: "a node of the mesh",
            }),
            _ => Ok(()),
        }
    }

    /// A node set.
    ///
    /// # Errors
    /// [`HousingError::NoSet`] with the names there are.
    pub fn set(&self, name: &str) -> Result<&[u32], HousingError> {
        self.node_sets.get(name).map(Vec::as_slice).ok_or_else(|| HousingError::NoSet {
            set: name.to_owned(),
            known: self.node_sets.keys().map(String::as_str).collect::<Vec<_>>().join(", "),
        })
    }

    /// Coordinates of a node.
    #[must_use]
    pub fn node(&self, node: u32) -> Vector3<f64> {
        Vector3::from(self.nodes[node as usize])
    }

    /// Mass and moments by the elements' mass rules.
    ///
    /// # Errors
    /// [`HousingError::InvertedElement`].
    pub fn inertia(&self) -> Result<Inertia, HousingError> {
        let (mut mass, mut first, mut second) = (0.0, Vector3::zeros(), nalgebra::Matrix3::zeros());
        let mut rules = Rules::default();
        for (index, element) in self.elements.iter().enumerate() {
            let rule = rules.of(element.kind);
            for point in &rule.mass {
                let x = self.mapped(element, &point.values);
                let part = self.jacobian(index, element, point)?.determinant() * point.weight;
                let part = part * self.materials[element.material].1.density;
                mass += part;
                first += part * x;
                second += part * (x.norm_squared() * nalgebra::Matrix3::identity() - x * x.transpose());
            }
        }
        let centre = if mass > 0.0 { (first / mass).into() } else { [0.0; 3] };
        let about_origin = std::array::from_fn(|i| std::array::from_fn(|j| second[(i, j)]));
        Ok(Inertia { mass, centre, about_origin })
    }

    /// Where shape functions of the given values place a point of an element.
    fn mapped(&self, element: &Element, values: &[f64]) -> Vector3<f64> {
        element.nodes.iter().zip(values).map(|(&node, &n)| n * self.node(node)).sum()
    }

    /// Derivatives of place (rows) by reference coordinates (columns).
    ///
    /// # Errors
    /// [`HousingError::InvertedElement`].
    pub fn jacobian(
        &self,
        index: usize,
        element: &Element,
        point: &Sampled,
    ) -> Result<nalgebra::Matrix3<f64>, HousingError> {
        let mut jacobian = nalgebra::Matrix3::zeros();
        for (&node, gradient) in element.nodes.iter().zip(&point.gradients) {
            jacobian += self.node(node) * Vector3::from(*gradient).transpose();
        }
        let determinant = jacobian.determinant();
        if determinant > 0.0 {
            Ok(jacobian)
        } else {
            Err(HousingError::InvertedElement {
                element: index,
                kind: element.kind.name(),
                place: self.mapped(element, &point.values).into(),
                jacobian: determinant,
            })
        }
    }

    /// Faces that belong to one element only, in the order of the elements.
    #[must_use]
    pub fn outer_faces(&self) -> Vec<Vec<u32>> {
        let mut found: BTreeMap<Vec<u32>, (usize, Vec<u32>)> = BTreeMap::new();
        let mut order = 0;
        for element in &self.elements {
            for face in element.kind.faces() {
                let nodes: Vec<u32> = face.iter().map(|&local| element.nodes[local]).collect();
                // quadratic and linear faces meet only where the mesh is at fault: all nodes are the key
                let mut key = nodes.clone();
                key.sort_unstable();
                order += 1;
                if found.remove(&key).is_none() {
                    found.insert(key, (order, nodes));
                }
            }
        }
        let mut faces: Vec<(usize, Vec<u32>)> = found.into_values().collect();
        faces.sort_unstable();
        faces.into_iter().map(|(_, nodes)| nodes).collect()
    }
}

/// Shape functions at a point of a rule.
#[derive(Debug, Clone)]
pub struct Sampled {
    /// Values.
    pub values: Vec<f64>,
    /// Derivatives by reference coordinates.
    pub gradients: Vec<[f64; 3]>,
    /// The point.
    pub at: [f64; 3],
    /// Weight of the rule.
    pub weight: f64,
}

/// Shape functions of a kind at the points of its rules.
#[derive(Debug, Clone)]
pub struct KindRules {
    /// For the stiffness.
    pub stiffness: Vec<Sampled>,
    /// For the mass.
    pub mass: Vec<Sampled>,
    /// At the middle of the element.
    pub middle: Sampled,
}

/// Rules of the kinds met so far.
#[derive(Debug, Clone, Default)]
pub struct Rules {
    known: Vec<(Kind, KindRules)>,
}

impl Rules {
    /// Of all kinds in a mesh.
    #[must_use]
    pub fn of_mesh(mesh: &SolidMesh) -> Self {
        let mut rules = Self::default();
        for element in &mesh.elements {
            rules.of(element.kind);
        }
        rules
    }

    /// Of one kind, if it has been met.
    #[must_use]
    pub fn get(&self, kind: Kind) -> Option<&KindRules> {
        self.known.iter().find(|(known, _)| *known == kind).map(|(_, rules)| rules)
    }

    /// Of one kind.
    pub fn of(&mut self, kind: Kind) -> &KindRules {
        let index = self.known.iter().position(|(known, _)| *known == kind).unwrap_or_else(|| {
            let shape = Shape::of(kind);
            let sample = |&(at, weight): &RulePoint| Sampled {
                values: shape.values(at),
                gradients: shape.gradients(at),
                at,
                weight,
            };
            let nodes = kind.reference_nodes();
            let middle = std::array::from_fn(|d| nodes.iter().map(|x| x[d]).sum::<f64>() / nodes.len() as f64);
            let rules = KindRules {
                stiffness: kind.stiffness_rule().iter().map(sample).collect(),
                mass: kind.mass_rule().iter().map(sample).collect(),
                middle: sample(&(middle, 0.0)),
            };
            self.known.push((kind, rules));
            self.known.len() - 1
        });
        &self.known[index].1
    }
}
