//! Notes on a lumped-pair case: keys without effect, assumptions.

use super::resolve::{LumpedPairCase, Source};
use super::schema::{Input, Member, Supports};
use crate::document::Node;
use crate::notes::Notes;

/// Notes on a resolved case.
pub(super) fn notes(case: &LumpedPairCase, document: &Node) -> Notes {
    let mut notes = Notes::default();
    let inputs = &case.inputs;
    for (key, source) in std::iter::once(("excitation.spur_pair", &case.healthy))
        .chain(case.damaged.iter().map(|state| ("state.spur_pair", &state.source)))
    {
        if let Source::SpurPair(statics) = source {
            notes.include(key, &statics.notes);
        }
    }
    let mut idle = |section: &str, keys: &[&str], because: &str| notes.without_effect(document, section, keys, because);
    let (pair, analysis, time) = (&inputs.pair, &inputs.analysis, inputs.analysis.time);
    if pair.input == Input::Prescribed {
        idle("pair", &["pinion_torque_n_m"], "the pinion's rotation is prescribed (pair.input)");
    }
    for (name, member) in [("pinion", Member::Pinion), ("gear", Member::Gear)] {
        let section = format!("pair.{name}");
        if pair.supports == Some(Supports::Rigid) {
            idle(&section, &["mass_kg", "support_damping_n_s_per_m"], "the supports are rigid (pair.supports)");
        }
        let is_rotation = inputs.excitation.damaged_gear == member
            && (!inputs.state.is_empty() || time.is_some_and(|time| time.mesh_cycles.is_none()));
        let is_speed = member == Member::Pinion && time.is_some_and(|time| time.pinion_speed_rpm.is_some());
        if !is_rotation && !is_speed {
            idle(
                &section,
                &["teeth"],
                "no rotation of this gear is looked at: it carries no damage (excitation.damaged_gear)",
            );
        }
    }
    let has_points = |spur: &Option<String>, table: bool| spur.is_some() || table;
    let healthy = has_points(&inputs.excitation.spur_pair, inputs.excitation.table.is_some());
    if !healthy && !inputs.state.iter().any(|state| has_points(&state.spur_pair, state.table.is_some())) {
        idle("excitation", &["interpolation"], "there are no points to join, from a table or a spur-pair case");
    }
    if inputs.state.is_empty() && time.is_none_or(|time| time.mesh_cycles.is_some()) {
        idle("excitation", &["damaged_gear"], "there is no damaged state");
    }
    for (index, state) in inputs.state.iter().enumerate() {
        if state.stiffness_factor.is_none() {
            idle(
                &format!("state[{}]", index + 1),
                &["mesh_cycles"],
                "only with stiffness_factor; curves have their own length",
            );
        }
    }
    if inputs.state.is_empty() {
        idle("analysis.continuation", &["damaged"], "there is no damaged state");
    }
    if analysis.time.is_none()
        && analysis.sweep.is_none()
        && analysis.continuation.is_none()
        && analysis.damage.is_none()
    {
        idle("analysis", &["samples_per_cycle"], "no response over time is computed");
    }
    if pair.input == Input::Prescribed {
        notes.assume("the pinion turns uniformly (pair.input = \"prescribed\")");
    }
    notes.assume("two rigid discs; the mesh is known by its stiffness and transmission error at one torque, along the line of action");
    notes
}
