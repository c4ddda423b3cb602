//! What disturbs the records of a calibration: from the samples before each contact, and from those
//! behind it, where only the charge that the contact has left leaks away.
//!
//! Behind a contact whose samples sum up to `B` is `V[i] = -(1 - a) a^i B` ([`super::tail`]), with
//! `B` and `1 - a` unknown. Records of one range have amplitudes of drift, hum and 1/f noise and
//! the white noise in common ([`crate::analysis::disturbance`]).

use std::ops::Range;

use super::record::{PreparedRecord, RawRecord, Surroundings};
use super::tail::{MIN_TAIL_SAMPLES, discharge};
use crate::analysis::disturbance::{Disturbance, KnownParts};

/// Blocks before the contact and behind it.
const BLOCKS_BEFORE: usize = 16;
const BLOCKS_BEHIND: usize = 28;

/// Time constants that are tried for a start: from this many sample intervals to this many lengths
/// of the record, and how many (1).
const TRIED_TIMES: (f64, f64, i32) = (20.0, 10.0, 60);
/// A sample behind the contact above this share of the peak is another pulse's (1).
const ANOTHER_PULSE: f64 = 0.25;

/// A record's baseline, contact and what is behind it, turned so that the pulse is positive.
struct Parts<'a> {
    record: &'a RawRecord,
    /// Samples above the baseline's mean (V).
    above: Vec<f64>,
    level: f64,
    sign: f64,
    baseline: Range<usize>,
    contact: Range<usize>,
}

impl<'a> Parts<'a> {
    /// Those of `record`, if it is good for that: dithered, with a single pulse and enough behind
    /// it.
    fn of(record: &'a RawRecord, known: &Surroundings) -> Option<Self> {
        let prepared = PreparedRecord::new(record, known).ok()?;
        let is_dithered = record.level > 0.0 && prepared.rest.is_none();
        let contact = prepared.contact().filter(|_| is_dithered)?;
        let (level, sign) = (prepared.baseline.level, if prepared.negative { -1.0 } else { 1.0 });
        // The disturbance found so far is to be found again, with the zero's mean.
        let above: Vec<f64> = record.trace.values.iter().map(|v| sign * (v - level)).collect();
        let behind = above.get(contact.end..).filter(|part| part.len() >= MIN_TAIL_SAMPLES)?;
        let top = above.get(prepared.peak)?;
        let is_single = behind.iter().all(|v| v.abs() < ANOTHER_PULSE * top);
        let baseline = 0..prepared.baseline.end;
        is_single.then_some(Self { record, above, level, sign, baseline, contact })
    }

    /// The charge that the contact leaves, as the sum of its samples (V).
    fn charge(&self) -> f64 {
        self.above.get(self.contact.clone()).unwrap_or_default().iter().sum()
    }

    /// What is known of the record if the droop has the time constant `tau` (s); with `is_free` but
    /// for errors of the charge and of `1 - a`.
    fn known(&self, tau: f64, is_free: bool) -> KnownParts {
        let Self { record, above, contact, .. } = self;
        let leak = -(-record.trace.interval / tau).exp_m1();
        let charge = self.charge();
        let behind = above.get(contact.end..).unwrap_or_default();
        let expected: Vec<[f64; 2]> = discharge(charge, leak).take(behind.len()).collect();
        let unknowns = if is_free { 2 } else { 0 };
        let mut parts = KnownParts::new(above.len(), record.trace.interval, record.level, unknowns);
        let baseline = above.get(self.baseline.clone()).unwrap_or_default();
        parts.add(baseline, self.baseline.start, BLOCKS_BEFORE, &[]);
        let off: Vec<f64> = behind.iter().zip(&expected).map(|(v, [left, _])| v - left).collect();
        if is_free {
            // Relative errors: of the sum over the contact, and of `1 - a`.
            parts.add_sum(0.0, contact.clone(), vec![charge / contact.len() as f64, 0.0]);
            let columns = [
                expected.iter().map(|[left, _]| *left).collect(),
                expected.iter().map(|[_, change]| leak * change).collect(),
            ];
            parts.add(&off, contact.end, BLOCKS_BEHIND, &columns);
        } else {
            parts.add(&off, contact.end, BLOCKS_BEHIND, &[]);
        }
        parts.turned(self.sign, self.level)
    }
}

/// A time constant to begin with: that which leaves least of all records beside drift and hum (s).
pub fn first_tau(records: &[(&RawRecord, &Surroundings)]) -> Option<f64> {
    let parts: Vec<Parts<'_>> =
        records.iter().filter_map(|(record, known)| Parts::of(record, known)).collect();
    let (shortest, longest) = parts.iter().fold((f64::INFINITY, 0.0), |(low, high), part| {
        let interval = part.record.trace.interval;
        let length = interval * part.above.len() as f64;
        (f64::min(low, TRIED_TIMES.0 * interval), f64::max(high, TRIED_TIMES.1 * length))
    });
    let steps = f64::from(TRIED_TIMES.2 - 1);
    let tried = (0..TRIED_TIMES.2)
        .map(|step| shortest * (longest / shortest).powf(f64::from(step) / steps));
    let misfit = |tau: f64| parts.iter().map(|part| part.known(tau, false).misfit()).sum::<f64>();
    let weighed = tried.map(|tau| (tau, misfit(tau)));
    let best = weighed.filter(|_| !parts.is_empty()).min_by(|a, b| a.1.total_cmp(&b.1));
    best.map(|(tau, _)| tau)
}

/// The disturbances of `records`, whose droop has the time constant `tau` (s); none of a record
/// that is no good, or of a quiet scope.
pub fn find(records: &[(&RawRecord, &Surroundings)], tau: f64) -> Vec<Option<Disturbance>> {
    let parts: Vec<Option<KnownParts>> = records
        .iter()
        .map(|(record, known)| Some(Parts::of(record, known)?.known(tau, true)))
        .collect();
    let mut found = vec![None; records.len()];
    let level = |index: usize| records.get(index).map_or(0, |(record, _)| record.level.to_bits());
    let mut left: Vec<usize> = (0..records.len()).filter(|i| parts[*i].is_some()).collect();
    while let Some(first) = left.first().copied() {
        let (same, others): (Vec<usize>, Vec<usize>) =
            left.into_iter().partition(|index| level(*index) == level(first));
        let own: Vec<KnownParts> = same.iter().filter_map(|i| parts[*i].clone()).collect();
        let disturbances = Disturbance::of(&own).into_iter().flatten();
        for (index, disturbance) in same.into_iter().zip(disturbances) {
            found[index] = Some(disturbance);
        }
        left = others;
    }
    found
}
