//! Rows at a place of the transmission.

use super::dense::{Square, dot};
use super::rest::Operator;
use super::rows::{HousingPart, RIGID};
use super::system::System;

/// Where the transmission stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Angle of the carrier (rad).
    pub angle: f64,
    /// Mesh cycles travelled.
    pub travelled: f64,
}

/// Rows at a place.
pub(super) struct Placed {
    /// Parts on rigid bodies: row, body, values.
    parts: Vec<PlacedPart>,
    /// Parts per body, as indices of `parts`.
    of_body: Vec<Vec<usize>>,
    /// Rows on one interface of the housing each, with sign -1.
    ports: Vec<(usize, usize)>,
    /// Rows on the seat: coefficients.
    seats: Vec<PlacedSeat>,
}

struct PlacedPart {
    row: usize,
    body: usize,
    values: [f64; RIGID],
}

struct PlacedSeat {
    row: usize,
    values: Vec<f64>,
}

impl Placed {
    pub fn new(system: &System, place: Place) -> Self {
        let (sin, cos) = place.angle.sin_cos();
        let mut placed = Self {
            parts: Vec::new(),
            of_body: vec![Vec::new(); system.ids.len()],
            ports: Vec::new(),
            seats: Vec::new(),
        };
        let seat_rows = 2 * (2 * system.interfaces.harmonics + 1);
        for (index, row) in system.rows.iter().enumerate() {
            for part in &row.parts {
                placed.of_body[part.body].push(placed.parts.len());
                placed.parts.push(PlacedPart { row: index, body: part.body, values: part.at((cos, sin)) });
            }
            match &row.housing {
                HousingPart::None => {}
                HousingPart::Interface(interface) => placed.ports.push((index, *interface)),
                HousingPart::Seat(seat) => {
                    let mut values = vec![0.0; seat_rows];
                    seat.coefficients(place.angle, system.interfaces.harmonics, &mut values);
                    placed.seats.push(PlacedSeat { row: index, values });
                }
            }
        }
        placed
    }

    /// `out += J q`, from rigid coordinates and motions of interfaces.
    pub fn displacements(&self, rigid: &[f64], faces: &[f64], seat: usize, out: &mut [f64]) {
        for part in &self.parts {
            out[part.row] += dot6(&part.values, &rigid[RIGID * part.body..]);
        }
        for &(row, interface) in &self.ports {
            out[row] -= faces[interface];
        }
        for part in &self.seats {
            out[part.row] += dot(&part.values, &faces[seat..]);
        }
    }

    /// Largest displacement of a body that goes into an approach, rows from this one on.
    pub fn magnitude(&self, rigid: &[f64], first: usize) -> f64 {
        let parts = self.parts.iter().filter(|part| part.row >= first);
        parts.fold(0.0, |most, part| most.max(dot6(&part.values, &rigid[RIGID * part.body..]).abs()))
    }

    /// One row over all coordinates.
    pub fn row(&self, system: &System, index: usize) -> Vec<f64> {
        let rigid = system.rigid();
        let mut row = vec![0.0; system.size()];
        for part in self.parts.iter().filter(|part| part.row == index) {
            row[RIGID * part.body..][..RIGID].iter_mut().zip(part.values).for_each(|(out, value)| *out += value);
        }
        let mut add = |interface: usize, factor: f64| {
            let modal = row[rigid..].iter_mut().zip(system.interfaces.row(interface));
            modal.for_each(|(out, value)| *out += factor * value);
        };
        self.ports.iter().filter(|(row, _)| *row == index).for_each(|(_, interface)| add(*interface, -1.0));
        for part in self.seats.iter().filter(|part| part.row == index) {
            part.values.iter().enumerate().for_each(|(k, value)| add(system.interfaces.seat + k, *value));
        }
        row
    }

    /// `rigid -= J^T l`, `faces -= J^T l`.
    pub fn react(&self, forces: &[f64], rigid: &mut [f64], faces: &mut [f64], seat: usize) {
        for part in &self.parts {
            let force = forces[part.row];
            for (out, value) in rigid[RIGID * part.body..].iter_mut().zip(&part.values) {
                *out -= force * value;
            }
        }
        for &(row, interface) in &self.ports {
            faces[interface] += forces[row];
        }
        for part in &self.seats {
            let force = forces[part.row];
            for (out, value) in faces[seat..].iter_mut().zip(&part.values) {
                *out -= force * value;
            }
        }
    }

    /// `J A^-1 J^T`.
    pub fn compliance(&self, operator: &Operator, rows: usize, seat: usize) -> Square {
        let mut w = Square::zeros(rows);
        for (body, parts) in self.of_body.iter().enumerate() {
            for &j in parts {
                let column = operator.body(body, &self.parts[j].values);
                let target = w.column_mut(self.parts[j].row);
                for &i in parts {
                    target[self.parts[i].row] += dot6(&self.parts[i].values, &column);
                }
            }
        }
        let gram = &operator.gram;
        for &(column, interface) in &self.ports {
            let source = gram.column(interface);
            let target = w.column_mut(column);
            for &(row, other) in &self.ports {
                target[row] += source[other];
            }
        }
        let mut motion = vec![0.0; gram.size];
        for part in &self.seats {
            motion.fill(0.0);
            for (k, value) in part.values.iter().enumerate() {
                for (out, entry) in motion.iter_mut().zip(gram.column(seat + k)) {
                    *out += value * entry;
                }
            }
            for &(row, interface) in &self.ports {
                *w.at_mut(row, part.row) -= motion[interface];
                *w.at_mut(part.row, row) -= motion[interface];
            }
            for other in &self.seats {
                *w.at_mut(other.row, part.row) += dot(&other.values, &motion[seat..]);
            }
        }
        w
    }
}

fn dot6(a: &[f64; RIGID], b: &[f64]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]
}
