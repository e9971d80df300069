//! The reduced housing of a case, made or kept.

use anyhow::Context;
use faer::Mat;
use planetary::elastic::{ElasticBody, Port, RingSeat, Sensor};
use serde::{Deserialize, Serialize};

use super::cache::Cache;
use crate::RunObserver;
use gearwright_case::transmission::housing::HousingPlan;

/// An elastic body as it is kept.
#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    frequencies: Vec<f64>,
    damping_ratios: Vec<f64>,
    /// Name, place, rows.
    ports: Vec<(String, [f64; 3], Vec<Vec<f64>>)>,
    /// Radius, height, harmonics, rows.
    seat: Option<(f64, f64, usize, Vec<Vec<f64>>)>,
    sensors: Vec<KeptSensor>,
}

/// A sensor as it is kept.
#[derive(Debug, Serialize, Deserialize)]
struct KeptSensor {
    name: String,
    position: [f64; 3],
    direction: [f64; 3],
    shape: Vec<f64>,
}

fn rows(matrix: &Mat<f64>) -> Vec<Vec<f64>> {
    (0..matrix.nrows()).map(|i| (0..matrix.ncols()).map(|k| matrix[(i, k)]).collect()).collect()
}

fn matrix(rows: &[Vec<f64>], columns: usize) -> Mat<f64> {
    Mat::from_fn(rows.len(), columns, |i, k| rows[i].get(k).copied().unwrap_or_default())
}

impl Kept {
    fn of(body: &ElasticBody) -> Self {
        Self {
            frequencies: body.frequencies.clone(),
            damping_ratios: body.damping_ratios.clone(),
            ports: body.ports.iter().map(|port| (port.name.clone(), port.position, rows(&port.shapes))).collect(),
            seat: body.ring_seat.as_ref().map(|seat| (seat.radius, seat.z, seat.harmonics, rows(&seat.shapes))),
            sensors: body
                .sensors
                .iter()
                .map(|sensor| KeptSensor {
                    name: sensor.name.clone(),
                    position: sensor.position,
                    direction: sensor.direction,
                    shape: sensor.shape.clone(),
                })
                .collect(),
        }
    }

    fn body(self) -> ElasticBody {
        let columns = self.frequencies.len();
        let port = |(name, position, rows): (String, [f64; 3], Vec<Vec<f64>>)| Port {
            name,
            position,
            shapes: matrix(&rows, columns),
        };
        let sensor =
            |KeptSensor { name, position, direction, shape }: KeptSensor| Sensor { name, position, direction, shape };
        ElasticBody {
            ports: self.ports.into_iter().map(port).collect(),
            ring_seat: self.seat.map(|(radius, z, harmonics, rows)| RingSeat {
                radius,
                z,
                harmonics,
                shapes: matrix(&rows, columns),
            }),
            sensors: self.sensors.into_iter().map(sensor).collect(),
            frequencies: self.frequencies,
            damping_ratios: self.damping_ratios,
        }
    }
}

/// Reduces the housing.
///
/// # Errors
/// Finite elements that fail.
pub fn reduced(plan: &HousingPlan, cache: &Cache, observer: &dyn RunObserver) -> anyhow::Result<ElasticBody> {
    let kept = cache.get("housing", &format!("{plan:?}"), || {
        observer.stage("finite elements of the housing");
        let reduced = plan.solid.reduce(&plan.options).context("the housing cannot be reduced")?;
        anyhow::Ok(Kept::of(&reduced.body))
    })?;
    Ok(kept.body())
}
