//! Losses in the contacts: `[effects.dashpot]`, `[effects.kuwabara_kono]` and
//! `[effects.power_law_loss]`.

use super::reader::effect;
use super::reader::{Bound, TableReader};
use crate::chain::{ContactOverride, EffectsSpec, EndOfContact, LOSS_MODELS, LossModel, LossSpec};
use crate::quantity::Dimension;

/// Exponents of the power law: below one the loss would be infinitely steep at rest.
const EXPONENTS: Bound = Bound::Within(1.0, 5.0);

/// Reads the losses into `spec`. `kinds` are the kinds of particles that stand beside each other,
/// with "striker" and "wall".
pub fn losses(effects: &TableReader<'_>, pairs: &[(&str, &str)], spec: &mut EffectsSpec) {
    let mut ends = Vec::new();
    for (model, loss_spec) in LOSS_MODELS.iter().zip(&mut spec.losses) {
        if let Some(table) = effect(effects, model.name) {
            let has_exponent = model.has_exponent;
            let read = || table.required("exponent", Dimension::NONE, EXPONENTS);
            let exponent = if has_exponent { read() } else { Some(1.0) };
            let read = loss(&table, model, pairs, &mut ends);
            *loss_spec = read.zip(exponent).map(|(spec, exponent)| LossSpec { exponent, ..spec });
            table.finish();
        }
    }
}

fn loss(
    table: &TableReader<'_>,
    model: &LossModel,
    pairs: &[(&str, &str)],
    ends: &mut Vec<EndOfContact>,
) -> Option<LossSpec> {
    let LossModel { key, dimension, .. } = *model;
    let bound = Bound::Within(0.0, model.largest);
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
    let spec = LossSpec { value: value?, exponent: 1.0, overrides, end: end? };
    complete.then_some(spec)
}
