//! The work-precision study: every method reaches what its tolerance promises, and stiffness of the supports costs an implicit
//! method nothing.

use lpm::{LpmError, Method, SUPPORT_STIFFNESSES, Supports, WorkPrecision, work_precision};

#[test]
fn order_errors_fall_with_the_tolerance_on_every_problem() -> Result<(), LpmError> {
    let rows = work_precision(&[1e-2, 1e-5, 1e-8], 0.0)?;
    // Three one-coordinate problems with four methods, four with elastic supports with three methods and elimination.
    assert_eq!(rows.len(), 3 * (3 * 4 + 4 * 4));
    for triple in rows.chunks(3) {
        let [loose, _, tight] = triple else {
            continue;
        };
        let what = format!("{} {:?} {}", tight.problem, tight.supports, tight.method.name());
        if tight.supports == Supports::Eliminated {
            continue; // model error
        }
        // Newmark's local error of third order leaves 2/3 of the power of the tolerance: 1e-8 gives some 1e-5.
        let limit = match tight.method {
            Method::Newmark => 1e-4,
            _ => 1e-6,
        };
        assert!(tight.error < limit, "{what}: {:e}", tight.error);
        assert!(loose.error < 0.5, "{what}: {:e}", loose.error);
    }
    let steps = |method: Method, stiffness: f64| {
        let own = |r: &&WorkPrecision| {
            r.method == method && r.support_stiffness == Some(stiffness) && r.supports == Supports::Integrated
        };
        rows.iter().filter(own).map(|r| r.steps).max().unwrap_or(0)
    };
    let [_, soft, _, stiff] = SUPPORT_STIFFNESSES;
    assert!(steps(Method::Esdirk, stiff) <= steps(Method::Esdirk, soft));
    assert!(steps(Method::DormandPrince, stiff) > 50 * steps(Method::Esdirk, stiff));
    Ok(())
}

#[test]
fn extreme_tolerances_are_checked() {
    assert!(work_precision(&[1e-13], 0.0).is_err());
    assert!(work_precision(&[1e-4], f64::NAN).is_err());
}
