//! The ring of one symmetry family: all harmonics, the lowest modes among them, and what each mode does on flank and hub.

use std::f64::consts::SQRT_2;
use std::ops::Range;

use faer::Mat;
use rayon::prelude::*;

use super::harmonic::{Harmonic, HarmonicModes};
use super::krylov::append;
use super::sector::{HalfSector, Mirror, SectorLayout, SectorSpace};
use super::{FamilyShapes, Mode, Twin};
use crate::body::ToothSector;
use crate::error::FecmError;
use crate::linalg::product;

/// The reduced sector of one family and the harmonics of its ring.
pub(super) struct FamilyRing<'a> {
    space: SectorSpace<'a>,
    teeth: u32,
    pub(super) halves: [HalfSector; 2],
    harmonics: Vec<Harmonic>,
}

impl<'a> FamilyRing<'a> {
    /// Reduces the sector to its cuts.
    pub(super) fn new(layout: SectorLayout<'a>, density: f64, teeth: u32) -> Result<Self, FecmError> {
        let space = SectorSpace::new(layout, density)?;
        let reduce = |mirror| HalfSector::new(&space, mirror);
        let (even, odd) = rayon::join(|| reduce(Mirror::Even), || reduce(Mirror::Odd));
        let harmonics = Harmonic::of_ring(teeth, &layout.cut_components());
        Ok(Self { space, teeth, halves: [even, odd], harmonics })
    }

    fn solve(&self, counts: &[usize]) -> Result<Vec<HarmonicModes>, FecmError> {
        let tasks: Vec<_> = self.harmonics.iter().zip(counts).collect();
        tasks.into_par_iter().map(|(harmonic, &count)| harmonic.solve(&self.halves, count)).collect()
    }

    /// Gives the sector what the inertia of those modes asks for that still moved by more than `tolerance` of their frequency since `before`
    /// (squared frequencies by harmonic). Returns whether there was anything new.
    fn enrich(&mut self, modes: &[HarmonicModes], before: &[Vec<f64>], tolerance: f64) -> Result<bool, FecmError> {
        let space = &self.space;
        let of_half = |half: usize| {
            let mut motions = Mat::zeros(self.halves[half].size(), 0);
            let taking = modes.iter().enumerate().filter(|(_, own)| own.harmonic.takes(&self.halves[half]));
            for (index, own) in taking {
                let known = before.get(index).map_or(&[][..], Vec::as_slice);
                for (k, value) in own.values.iter().enumerate() {
                    let settled = known.get(k).is_some_and(|known| (known / value).sqrt() - 1.0 <= tolerance);
                    if !settled {
                        append(&mut motions, &own.halves[half].as_ref().subcols(k, 1).to_owned());
                    }
                }
            }
            motions
        };
        let motions = [of_half(0), of_half(1)];
        let [even, odd] = &mut self.halves;
        let (even, odd) = rayon::join(|| even.enrich(space, &motions[0]), || odd.enrich(space, &motions[1]));
        Ok(even? + odd? > 0)
    }

    /// The one or two modes of a shape, but for family and frequency.
    pub(super) fn modes_of_shape(
        &self,
        harmonic: &Harmonic,
        halves: &[Mat<f64>; 2],
        shape: usize,
        rigid: &[[Vec<f64>; 6]; 2],
    ) -> impl Iterator<Item = Mode> + use<> {
        let twins: &'static [Twin] = match harmonic.only {
            None => &[Twin::Even, Twin::Odd],
            Some(Mirror::Even) => &[Twin::Even],
            Some(Mirror::Odd) => &[Twin::Odd],
        };
        // the sum of cos^2 over all teeth is N / 2, or N where the cosine is +-1
        let teeth = f64::from(self.teeth);
        let scale = if harmonic.only.is_some() { 1.0 / teeth.sqrt() } else { (2.0 / teeth).sqrt() };
        let momentum = momentum(halves, shape, rigid);
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

    /// `M r` of the rigid motions on both halves.
    pub(super) fn rigid(&self) -> [[Vec<f64>; 6]; 2] {
        [0, 1].map(|half| self.halves[half].rigid(&self.space))
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
            product(self.space.layout.cuts_of_upper(half.mirror).as_ref(), cut)
        });
        let block = self.space.layout.basis.block();
        let functions = self.space.layout.basis.plane_degrees().len();
        let flank = [0, 1].map(|index| {
            let half = &self.halves[index];
            let mut flank = product(sector.families[family].at_flank.as_ref(), cuts[index].as_ref());
            flank *= faer::Scale(-1.0);
            let fields = sector.flank_of_fields(half.held.as_ref(), block, functions);
            let held = halves[index].as_ref().subrows(half.cut_stiffness.nrows(), half.held.ncols());
            flank += product(fields.as_ref(), held);
            flank
        });
        let [even, odd] = self.halves;
        let held = |half: HalfSector, coordinates: &Mat<f64>| {
            let rows = half.cut_stiffness.nrows();
            (coordinates.as_ref().subrows(rows, half.held.ncols()).to_owned(), half.held)
        };
        let held = [held(even, &halves[0]), held(odd, &halves[1])];
        FamilyShapes { range, basis: self.space.layout.basis.clone(), flank, cuts, held }
    }
}

/// `s^T M r` and `a^T M r` of a shape with the rigid motions, in their even or odd half.
fn momentum(halves: &[Mat<f64>; 2], shape: usize, rigid: &[[Vec<f64>; 6]; 2]) -> [f64; 6] {
    let mut result = [0.0; 6];
    for (rigid, coordinates) in rigid.iter().zip(halves) {
        for (sum, momentum) in result.iter_mut().zip(rigid) {
            *sum += momentum.iter().zip(coordinates.col_as_slice(shape)).map(|(a, b)| a * b).sum::<f64>();
        }
    }
    result
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

/// The lowest modes of all families and harmonics, `count` in all, pairs whole: by family, then harmonic. Sectors are enriched until no frequency
/// falls by more than `tolerance` of itself.
pub(super) fn lowest_of_rings(
    rings: &mut [FamilyRing<'_>],
    count: usize,
    tolerance: f64,
) -> Result<Vec<Vec<HarmonicModes>>, FecmError> {
    let teeth = rings.first().map_or(1, |ring| ring.teeth as usize);
    let mut counts: Vec<Vec<usize>> =
        rings.iter().map(|ring| vec![count.div_ceil(teeth) + 2; ring.harmonics.len()]).collect();
    let mut before = vec![Vec::new(); rings.len()];
    loop {
        let solved = select(rings, count, &mut counts)?;
        let mut new = false;
        for ((ring, modes), before) in rings.iter_mut().zip(&solved).zip(&mut before) {
            new |= ring.enrich(modes, before, tolerance)?;
            *before = modes.iter().map(|modes| modes.values.clone()).collect();
        }
        if !new {
            return Ok(solved);
        }
    }
}

/// All frequencies, ascending (rad/s).
fn frequencies(solved: &[Vec<HarmonicModes>]) -> Vec<f64> {
    let all = solved.iter().flatten();
    let mut values: Vec<f64> = all
        .flat_map(|modes| modes.values.iter().flat_map(|&value| vec![value.sqrt(); modes.harmonic.multiplicity()]))
        .collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The lowest modes with the sectors as they are. `counts` of each harmonic grow until none can be missing.
fn select(
    rings: &[FamilyRing<'_>],
    count: usize,
    counts: &mut [Vec<usize>],
) -> Result<Vec<Vec<HarmonicModes>>, FecmError> {
    loop {
        let mut solved = Vec::new();
        for (ring, counts) in rings.iter().zip(&*counts) {
            solved.push(ring.solve(counts)?);
        }
        let last = frequencies(&solved).get(count - 1).map_or(f64::INFINITY, |frequency| frequency * frequency);
        // the root squared may fall below the value itself
        let last = last * (1.0 + 4.0 * f64::EPSILON);
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
