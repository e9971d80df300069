//! Dashed lines as pieces, for a renderer that cannot carry a dash over a corner.

use std::fmt::Write as _;

use kuva::render::render::{Primitive, Scene};

/// Replaces every dashed path of straight pieces by its dashes.
pub fn cut(scene: &mut Scene) {
    for element in &mut scene.elements {
        let Primitive::Path(path) = element else { continue };
        let Some(lengths) = path.stroke_dasharray.as_deref().and_then(lengths) else { continue };
        let Some(lines) = polylines(&path.d) else { continue };
        // the renderer rounds the ends: half a width longer at either one
        path.d = lines.iter().map(|line| dashes(line, &lengths, path.stroke_width)).collect();
        path.stroke_dasharray = None;
    }
}

/// Dashes and gaps in turn; `None` unless all are positive.
fn lengths(text: &str) -> Option<Vec<f64>> {
    let lengths: Vec<f64> =
        text.split([' ', ',']).filter(|w| !w.is_empty()).map(str::parse).collect::<Result<_, _>>().ok()?;
    let usable = !lengths.is_empty() && lengths.len() % 2 == 0 && lengths.iter().all(|l| *l > 0.0);
    usable.then_some(lengths)
}

/// The corners of a path of `M` and `L` commands; `None` if it has others.
fn polylines(d: &str) -> Option<Vec<Vec<(f64, f64)>>> {
    let mut lines: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut rest = d.trim_start();
    while let Some(command) = rest.chars().next() {
        if !matches!(command, 'M' | 'L') {
            return None;
        }
        let end = rest[1..].find(char::is_alphabetic).map_or(rest.len(), |k| k + 1);
        let numbers = rest[1..end].split([' ', ',', '\n']).filter(|w| !w.is_empty()).map(str::parse);
        let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
        if command == 'M' {
            lines.push(Vec::new());
        }
        lines.last_mut()?.extend(numbers.chunks_exact(2).map(|p| (p[0], p[1])));
        rest = rest[end..].trim_start();
    }
    Some(lines)
}

/// Path of the dashes along a polyline.
fn dashes(line: &[(f64, f64)], lengths: &[f64], width: f64) -> String {
    let mut d = String::new();
    let (mut turn, mut left, mut fresh) = (0, (lengths[0] - width).max(0.1), true);
    for pair in line.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let whole = (to_x - x).hypot(to_y - y);
        let mut done = 0.0;
        while whole - done > 1e-9 {
            let step = left.min(whole - done);
            let at = |s: f64| (x + (to_x - x) * s / whole, y + (to_y - y) * s / whole);
            if turn % 2 == 0 {
                if fresh {
                    let from = at(done);
                    // writing to a string cannot fail
                    let _ = write!(d, "M{:.2},{:.2}", from.0, from.1);
                }
                let to = at(done + step);
                let _ = write!(d, "L{:.2},{:.2}", to.0, to.1);
                fresh = false;
            }
            done += step;
            left -= step;
            if left <= 1e-9 {
                turn = (turn + 1) % lengths.len();
                let change = if turn % 2 == 0 { -width } else { width };
                (left, fresh) = ((lengths[turn] + change).max(0.1), true);
            }
        }
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_run_over_corners() {
        // an L of 10 + 10 in dashes of 6 and gaps of 4: the second dash begins at the corner, the third does not exist
        let line = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)];
        assert_eq!(dashes(&line, &[6.0, 4.0], 0.0), "M0.00,0.00L6.00,0.00M10.00,0.00L10.00,6.00");
        // a dash that bends
        assert_eq!(dashes(&line, &[12.0, 20.0], 0.0), "M0.00,0.00L10.00,0.00L10.00,2.00");
    }

    #[test]
    fn other_paths_are_left_alone() {
        assert_eq!(polylines("M0,0 C1,1 2,2 3,3"), None);
        assert_eq!(polylines("M0,1 L2,3"), Some(vec![vec![(0.0, 1.0), (2.0, 3.0)]]));
        assert_eq!(lengths("0"), None);
    }
}
