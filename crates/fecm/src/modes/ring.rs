//! The ring of one symmetry family: all harmonics, the lowest modes among them, and what each mode does on flank and hub.

use std::f64::consts::SQRT_2;
use std::ops::Range;

use faer::Mat;
use rayon::prelude::*;

use super::harmonic::{Harmonic, HarmonicModes};
use super::sector::{HalfSector, Mirror, SectorLayout, SectorSpace};
use super::{FamilyShapes, Mode, Twin};
use crate::body::ToothSector;
use crate::error::FecmError;
use crate::linalg::product;

/// The reduced sector of one family and the harmonics of its ring.
pub(super) struct FamilyRing<'a> {
    layout: SectorLayout<'a>,
    teeth: u32,
    pub(super) halves: [HalfSector; 2],
    harmonics: Vec<Harmonic>,
}

/// Sector modes of one mirror half that make the lowest `count` modes of a gear of `teeth` teeth good to about 1e-5.
pub(super) fn default_sector_modes(count: usize, teeth: u32) -> usize {
    12 + 4 * count.div_ceil(teeth as usize)
}

impl<'a> FamilyRing<'a> {
    /// Reduces the sector to its cuts and `held` modes of each mirror half.
    pub(super) fn new(layout: SectorLayout<'a>, density: f64, teeth: u32, held: usize) -> Result<Self, FecmError> {
        let space = SectorSpace::new(layout, density)?;
        let reduce = |mirror| HalfSector::new(&space, mirror, held);
        let (even, odd) = rayon::join(|| reduce(Mirror::Even), || reduce(Mirror::Odd));
        Ok(Self { layout, teeth, halves: [even?, odd?], harmonics: Harmonic::of_ring(teeth, &layout.cut_components()) })
    }

    fn solve(&self, counts: &[usize]) -> Result<Vec<HarmonicModes>, FecmError> {
        let tasks: Vec<_> = self.harmonics.iter().zip(counts).collect();
        tasks.into_par_iter().map(|(harmonic, &count)| harmonic.solve(&self.halves, count)).collect()
    }

    /// The one or two modes of a shape, but for family and frequency.
    pub(super) fn modes_of_shape(
        &self,
        harmonic: &Harmonic,
        halves: &[Mat<f64>; 2],
        shape: usize,
    ) -> impl Iterator<Item = Mode> + use<> {
        let twins: &'static [Twin] = match harmonic.only {
            None => &[Twin::Even, Twin::Odd],
            Some(Mirror::Even) => &[Twin::Even],
            Some(Mirror::Odd) => &[Twin::Odd],
        };
        // the sum of cos^2 over all teeth is N / 2, or N where the cosine is +-1
        let teeth = f64::from(self.teeth);
        let scale = if harmonic.only.is_some() { 1.0 / teeth.sqrt() } else { (2.0 / teeth).sqrt() };
        let momentum = self.momentum(halves, shape);
        let nodal_diameter = harmonic.nodal_diameter;
        twins.iter().map(move |&twin| Mode {
            family: 0,
            nodal_diameter,
            twin,
            angular_frequency: 0.0,
            rigid_coupling: rigid_coupling(nodal_diameter, twin, teeth.sqrt(), &momentum),
            shape,
            scale,
        })
    }

    /// `s^T M r` and `a^T M r` of a shape with the rigid motions, in their even or odd half.
    fn momentum(&self, halves: &[Mat<f64>; 2], shape: usize) -> [f64; 6] {
        let mut result = [0.0; 6];
        for (half, coordinates) in self.halves.iter().zip(halves) {
            for (sum, (_, momentum)) in result.iter_mut().zip(&half.rigid) {
                let pairs = momentum.col_as_slice(0).iter().zip(coordinates.col_as_slice(shape));
                *sum += pairs.map(|(a, b)| a * b).sum::<f64>();
            }
        }
        result
    }

    /// What is kept of the family's shapes.
    pub(super) fn shapes(
        self,
        sector: &ToothSector,
        family: usize,
        range: Range<usize>,
        halves: &[Mat<f64>; 2],
    ) -> FamilyShapes {
        let cuts = [0, 1].map(|index| {
            let half = &self.halves[index];
            let cut = halves[index].as_ref().subrows(0, half.cut_stiffness.nrows());
            product(self.layout.cuts_of_upper(half.mirror).as_ref(), cut)
        });
        let block = self.layout.basis.block();
        let functions = 2 * self.layout.basis.plane_degrees().len();
        let flank_rows: Vec<usize> = sector
            .flank_nodes()
            .iter()
            .flat_map(|&node| (0..functions).map(move |dof| node as usize * block + dof))
            .collect();
        let flank = [0, 1].map(|index| {
            let half = &self.halves[index];
            let mut flank = product(sector.families[family].at_flank.as_ref(), cuts[index].as_ref());
            flank *= faer::Scale(-1.0);
            let modes = Mat::from_fn(flank_rows.len(), half.values.len(), |i, k| half.modes[(flank_rows[i], k)]);
            let held = halves[index].as_ref().subrows(half.cut_stiffness.nrows(), half.values.len());
            flank += product(modes.as_ref(), held);
            flank
        });
        let [even, odd] = self.halves;
        let held = |half: HalfSector, coordinates: &Mat<f64>| {
            let rows = half.cut_stiffness.nrows();
            (coordinates.as_ref().subrows(rows, half.values.len()).to_owned(), half.modes)
        };
        let held = [held(even, &halves[0]), held(odd, &halves[1])];
        FamilyShapes { range, basis: self.layout.basis.clone(), flank, cuts, held }
    }
}

/// Sum over the gear of a mode's momentum in the rigid motions. In the frame of a tooth at angle `p`, motion along x is the even field
/// `X` with the odd `Y` (`cos p X - sin p Y`, the pattern of [`Twin::Even`]), along y of [`Twin::Odd`]; tilts alike with the even `-AboutY` and
/// the odd `AboutX`.
fn rigid_coupling(nodal_diameter: u32, twin: Twin, root: f64, momentum: &[f64; 6]) -> [f64; 6] {
    let [x, y, z, about_x, about_y, about_z] = *momentum;
    let (moved, tilted) = (root / SQRT_2 * (x + y), root / SQRT_2 * (about_x - about_y));
    match (nodal_diameter, twin) {
        (0, Twin::Even) => [0.0, 0.0, root * z, 0.0, 0.0, 0.0],
        (0, Twin::Odd) => [0.0, 0.0, 0.0, 0.0, 0.0, root * about_z],
        (1, Twin::Even) => [moved, 0.0, 0.0, 0.0, -tilted, 0.0],
        (1, Twin::Odd) => [0.0, moved, 0.0, tilted, 0.0, 0.0],
        _ => [0.0; 6],
    }
}

/// The lowest modes of all families and harmonics: `count` in all, pairs whole. By family, then harmonic.
pub(super) fn lowest_of_rings(rings: &[FamilyRing<'_>], count: usize) -> Result<Vec<Vec<HarmonicModes>>, FecmError> {
    let harmonics = |ring: &FamilyRing<'_>| ring.harmonics.len();
    let teeth = rings.first().map_or(1, |ring| ring.teeth as usize);
    let mut counts: Vec<Vec<usize>> =
        rings.iter().map(|ring| vec![count.div_ceil(teeth) + 2; harmonics(ring)]).collect();
    loop {
        let mut solved = Vec::new();
        for (ring, counts) in rings.iter().zip(&counts) {
            solved.push(ring.solve(counts)?);
        }
        let mut values: Vec<f64> = solved
            .iter()
            .flatten()
            .flat_map(|modes| modes.values.iter().flat_map(|&value| vec![value; modes.harmonic.multiplicity()]))
            .collect();
        values.sort_by(f64::total_cmp);
        let last = values.get(count - 1).copied().unwrap_or(f64::INFINITY);
        // a harmonic whose modes all lie below may have more
        let mut complete = true;
        for (modes, count) in solved.iter().flatten().zip(counts.iter_mut().flatten()) {
            if !modes.all && modes.values.last().is_none_or(|&highest| highest <= last) {
                *count += 2 + *count / 2;
                complete = false;
            }
        }
        if complete {
            for modes in solved.iter_mut().flatten() {
                let kept = modes.values.iter().take_while(|&&value| value <= last).count();
                modes.truncate(kept);
            }
            return Ok(solved);
        }
    }
}
