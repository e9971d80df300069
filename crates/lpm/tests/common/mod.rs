//! An event-driven exact solver for one mass under piecewise constant excitation, written independently of the crate's
//! integrators: closed forms between jumps, contact changes by bisection of the closed forms.
#![allow(dead_code)]

use lpm::analytic::Oscillator;

/// Piecewise constant problem: pieces of (start phase, stiffness, transmission error) in one mesh cycle.
#[derive(Clone)]
pub struct Exact {
    pub mass: f64,
    pub damping: f64,
    pub force: f64,
    pub frequency: f64,
    pub pieces: Vec<(f64, f64, f64)>,
}

/// End state and instants of contact change (s).
pub struct Trace {
    pub x: f64,
    pub v: f64,
    pub events: Vec<f64>,
    /// States at the ends of the mesh cycles.
    pub ends: Vec<(f64, f64)>,
}

impl Exact {
    pub fn run(&self, cycles: usize, x0: f64, v0: f64) -> Trace {
        let mut out = Trace { x: x0, v: v0, events: Vec::new(), ends: Vec::new() };
        let period = 1.0 / self.frequency;
        for c in 0..cycles {
            for (i, &(start, k, e)) in self.pieces.iter().enumerate() {
                let stop = self.pieces.get(i + 1).map_or(1.0, |p| p.0);
                let t0 = (c as f64 + start) * period;
                self.piece(k, e, t0, (stop - start) * period, &mut out);
            }
            out.ends.push((out.x, out.v));
        }
        out
    }

    fn piece(&self, k: f64, e: f64, t0: f64, span: f64, out: &mut Trace) {
        let limit = e - self.force / k; // elastic force vanishes here
        let mut t = 0.0;
        let mut contact = out.x > limit;
        while t < span {
            // Displacements relative to the limit, where the spring is slack.
            let o = Oscillator {
                mass: self.mass,
                damping: if contact { self.damping } else { 0.0 },
                stiffness: if contact { k } else { 0.0 },
                force: self.force,
            };
            let (u0, v0) = (out.x - limit, out.v);
            let sign = if contact { 1.0 } else { -1.0 };
            let side = |dt: f64| sign * o.after(dt, u0, v0).0;
            // Scan finely for the first exit, then bisect.
            let (mut lo, mut hit) = (0.0, None);
            let grid = 1e-3 / (k / self.mass).sqrt();
            let left = span - t;
            let n = (left / grid).ceil() as usize;
            for i in 1..=n {
                let at = left * i as f64 / n as f64;
                if side(at) < 0.0 {
                    hit = Some(at);
                    break;
                }
                lo = at;
            }
            let Some(mut hi) = hit else {
                let (u, v) = o.after(left, u0, v0);
                (out.x, out.v) = (u + limit, v);
                return;
            };
            for _ in 0..200 {
                let mid = 0.5 * (lo + hi);
                if side(mid) < 0.0 { hi = mid } else { lo = mid }
            }
            let (_, v) = o.after(hi, u0, v0);
            (out.x, out.v) = (limit, v);
            t += hi;
            out.events.push(t0 + t);
            contact = !contact;
        }
    }
}
