//! Losses in the contacts: `[effects.dashpot]`, `[effects.kuwabara_kono]` and
//! `[effects.power_law_loss]`.

use super::reader::effect;
use super::reader::{Bound, TableReader};
use crate::chain::{
    ContactOverride, Dashpot, EffectsSpec, EndOfContact, KuwabaraKono, LossSpec, PowerLawLoss,
};
use crate::quantity::Dimension;

/// Largest dashpot: beyond it a bead of this bench would stop within a nanosecond (N s/m).
const MAX_GAMMA: f64 = 1e5;
/// Largest time of Kuwabara and Kono: hundreds of times the duration of an impact (s).
const MAX_ETA: f64 = 1e-3;
/// Largest force of the power law at 1 m/s (N).
const MAX_FORCE: f64 = 1e5;
/// Exponents of the power law: below one the loss would be infinitely steep at rest.
const EXPONENTS: Bound = Bound::Within(1.0, 5.0);

/// A coefficient's key, dimension and range.
type Coefficient = (&'static str, Dimension, Bound);

/// Reads the losses into `spec`. `kinds` are the kinds of particles that stand beside each other,
/// with "striker" and "wall".
pub fn losses(effects: &TableReader<'_>, pairs: &[(&str, &str)], spec: &mut EffectsSpec) {
    let mut ends = Vec::new();
    if let Some(table) = effect(effects, "dashpot") {
        let gamma = ("gamma", Dimension::DAMPING, Bound::Within(0.0, MAX_GAMMA));
        spec.dashpot = loss(&table, gamma, pairs, &mut ends).map(|gamma| Dashpot { gamma });
        table.finish();
    }
    if let Some(table) = effect(effects, "kuwabara_kono") {
        let eta = ("eta", Dimension::TIME, Bound::Within(0.0, MAX_ETA));
        spec.kuwabara_kono = loss(&table, eta, pairs, &mut ends).map(|eta| KuwabaraKono { eta });
        table.finish();
    }
    if let Some(table) = effect(effects, "power_law_loss") {
        let exponent = table.required("exponent", Dimension::NONE, EXPONENTS);
        let force = ("force_at_1_m_per_s", Dimension::FORCE, Bound::Within(0.0, MAX_FORCE));
        let force = loss(&table, force, pairs, &mut ends);
        spec.power_law_loss =
            force.zip(exponent).map(|(force, exponent)| PowerLawLoss { force, exponent });
        table.finish();
    }
}

fn loss(
    table: &TableReader<'_>,
    coefficient: Coefficient,
    pairs: &[(&str, &str)],
    ends: &mut Vec<EndOfContact>,
) -> Option<LossSpec> {
    let (key, dimension, bound) = coefficient;
    let _ = table.text("source");
    let value = table.required(key, dimension, bound);
    let words = [EndOfContact::ZeroOverlap, EndOfContact::ZeroForce].map(|end| (end.name(), end));
    let end = table.choice("end_of_contact", &words);
    if !table.has("end_of_contact") {
        let expected = "\"zero_overlap\", where a contact pulls before it ends, or \"zero_force\"";
        table.problem("end_of_contact", "no such key", expected);
    }
    if let (Some(end), Some(other)) = (end, ends.first())
        && end != *other
    {
        let expected =
            format!("\"{}\", as for the other losses: a contact ends once", other.name());
        table.problem("end_of_contact", format!("\"{}\"", end.name()), expected);
    }
    ends.extend(end);
    let mut overrides = Vec::new();
    let mut complete = true;
    for own in table.list("contacts") {
        let names = own.texts("between");
        let value = own.required(key, dimension, bound);
        let between = if let [(upper, _), (lower, _)] = names.as_slice() {
            Some([(*upper).to_owned(), (*lower).to_owned()])
        } else {
            own.problem("between", format!("{} names", names.len()), "two kinds of bodies");
            None
        };
        if let Some([upper, lower]) = &between {
            let meets =
                |(a, b): &(&str, &str)| (a == upper && b == lower) || (a == lower && b == upper);
            if !pairs.is_empty() && !pairs.iter().any(meets) {
                let found = format!("\"{upper}\" and \"{lower}\", which do not touch");
                let mut known: Vec<String> =
                    pairs.iter().map(|(a, b)| format!("{a} and {b}")).collect();
                known.sort();
                known.dedup();
                own.problem("between", found, format!("one of {}", known.join(", ")));
            }
        }
        own.finish();
        match between.zip(value) {
            Some((between, value)) => overrides.push(ContactOverride { between, value }),
            None => complete = false,
        }
    }
    let spec = LossSpec { value: value?, overrides, end: end? };
    complete.then_some(spec)
}
