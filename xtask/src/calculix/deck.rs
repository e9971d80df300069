//! Input deck, run and reaction moments. Units of the deck: mm, N, MPa.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::Command;

use anyhow::{Context, bail, ensure};
use fecm::Material;
use nalgebra::{Point2, Rotation2};

use super::mesh::TriangleMesh;

/// Contact stiffness (MPa/mm): 1000 MPa of pressure then overlap by 0.01 um, some 0.1 % of the mesh deflection.
const CONTACT_SLOPE: f64 = 1e8;

/// What a run needs.
pub struct Deck<'a> {
    /// Pinion and wheel.
    pub meshes: &'a [TriangleMesh; 2],
    /// Centre of the wheel (m).
    pub centre: Point2<f64>,
    /// Materials.
    pub materials: [Material; 2],
    /// Thickness (m).
    pub facewidth: f64,
    /// Rotations of the wheel's bore (rad), one step each.
    pub rotations: &'a [f64],
}

/// Runs the deck; moment of the wheel's bore reactions about its centre (N m) at each rotation.
pub fn run(deck: &Deck<'_>) -> anyhow::Result<Vec<f64>> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("pair.inp"), deck.text()?)?;
    let output = Command::new("ccx")
        .arg("pair")
        .current_dir(folder.path())
        .env("OMP_NUM_THREADS", "2")
        .output()
        .context("ccx cannot be started; on Debian: apt-get install calculix-ccx")?;
    let results = std::fs::read_to_string(folder.path().join("pair.dat")).unwrap_or_default();
    let moments = deck.moments(&results)?;
    if moments.len() != deck.rotations.len() {
        let log = String::from_utf8_lossy(&output.stdout).into_owned();
        let tail: Vec<&str> = log.lines().rev().take(12).collect();
        bail!(
            "ccx solved {} of {} steps: {}",
            moments.len(),
            deck.rotations.len(),
            tail.into_iter().rev().collect::<Vec<_>>().join("\n")
        );
    }
    Ok(moments)
}

impl Deck<'_> {
    fn text(&self) -> anyhow::Result<String> {
        let mut text = String::new();
        let names = ["PINION", "WHEEL"];
        let (mut first_node, mut first_element) = (1, 1);
        let mut starts = Vec::new();
        for (mesh, name) in self.meshes.iter().zip(names) {
            starts.push(first_node);
            writeln!(text, "*NODE, NSET=N{name}")?;
            for (k, node) in mesh.nodes.iter().enumerate() {
                writeln!(text, "{}, {:.12e}, {:.12e}, 0.", first_node + k, node.x * 1e3, node.y * 1e3)?;
            }
            writeln!(text, "*ELEMENT, TYPE=CPE6, ELSET=E{name}")?;
            for (k, element) in mesh.elements.iter().enumerate() {
                let nodes: Vec<String> = element.iter().map(|n| (first_node + n).to_string()).collect();
                writeln!(text, "{}, {}", first_element + k, nodes.join(", "))?;
            }
            writeln!(text, "*SURFACE, NAME=S{name}, TYPE=ELEMENT")?;
            for (element, face) in &mesh.contact_faces {
                writeln!(text, "{}, S{face}", first_element + element)?;
            }
            writeln!(text, "*NSET, NSET=B{name}")?;
            for node in &mesh.bore {
                writeln!(text, "{},", first_node + node)?;
            }
            first_node += mesh.nodes.len();
            first_element += mesh.elements.len();
        }
        for (material, name) in self.materials.iter().zip(names) {
            writeln!(
                text,
                "*MATERIAL, NAME=M{name}\n*ELASTIC\n{:.9e}, {:.9e}",
                material.young_modulus * 1e-6,
                material.poisson_ratio
            )?;
            writeln!(text, "*SOLID SECTION, ELSET=E{name}, MATERIAL=M{name}\n{:.9e}", self.facewidth * 1e3)?;
        }
        writeln!(
            text,
            "*SURFACE INTERACTION, NAME=CONTACT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{CONTACT_SLOPE:e}"
        )?;
        writeln!(text, "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE\nSPINION, SWHEEL")?;
        writeln!(text, "*BOUNDARY\nBPINION, 1, 2, 0.")?;
        for rotation in self.rotations {
            writeln!(text, "*STEP, INC=500\n*STATIC\n1., 1., 1e-6, 1.\n*BOUNDARY")?;
            let turn = Rotation2::new(*rotation);
            for &node in &self.meshes[1].bore {
                let arm = self.meshes[1].nodes[node] - self.centre;
                let moved = (turn * arm - arm) * 1e3;
                writeln!(
                    text,
                    "{}, 1, 1, {:.12e}\n{}, 2, 2, {:.12e}",
                    starts[1] + node,
                    moved.x,
                    starts[1] + node,
                    moved.y
                )?;
            }
            writeln!(text, "*NODE PRINT, NSET=BWHEEL\nRF\n*END STEP")?;
        }
        Ok(text)
    }

    /// Moments at the ends of the steps, from the tables of reactions in the result file (increments cut back leave tables as well).
    fn moments(&self, results: &str) -> anyhow::Result<Vec<f64>> {
        const HEADING: &str = "forces (fx,fy,fz) for set BWHEEL and time";
        let offset = self.meshes[0].nodes.len() + 1;
        let mut tables: Vec<(f64, f64)> = Vec::new();
        for line in results.lines() {
            if let Some((_, time)) = line.split_once(HEADING) {
                tables.push((time.trim().parse()?, 0.0));
                continue;
            }
            let words: Vec<&str> = line.split_whitespace().collect();
            let (Some((_, moment)), [node, fx, fy, _]) = (tables.last_mut(), words.as_slice()) else { continue };
            let node: usize = node.parse().with_context(|| format!("result line {line:?}"))?;
            ensure!(
                node >= offset && node - offset < self.meshes[1].nodes.len(),
                "reaction of node {node}, which is not the wheel's"
            );
            let arm = self.meshes[1].nodes[node - offset] - self.centre;
            *moment += arm.x * fy.parse::<f64>()? - arm.y * fx.parse::<f64>()?;
        }
        // steps last one unit of time each; the last table at its end counts
        let mut ends = BTreeMap::new();
        for (time, moment) in tables {
            if (time - time.round()).abs() < 1e-6 {
                ends.insert(time.round() as u64, moment);
            }
        }
        Ok(ends.into_values().collect())
    }
}
