//! A record before its integral: is it sound, where is its zero, where its pulse.

use std::ops::Range;

use crate::analysis::baseline::{Baseline, noise_of};
use crate::analysis::disturbance::Disturbance;
use crate::analysis::gate::Gate;
use crate::analysis::pulse::{Conditions, PulseError};
use crate::analysis::quiet_scope::{AtRest, MovingScatter};
use crate::trace::Trace;

/// Safety factor on the noise: thousands of samples, none of which may pass by chance (1).
pub(super) const NOISE_TIMES: f64 = 4.0;

/// A record as it came from the scope.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecord {
    /// Voltage over time.
    pub trace: Trace,
    /// Distance of the digitiser's levels; 0 for what was never digitised (V).
    pub level: f64,
    /// Samples at the converter's ends.
    pub clipped: usize,
    /// Where to integrate; by default the contact and a little on either side.
    pub window: Option<Gate>,
}

/// Why an impact is left out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Exclusion {
    /// The converter was driven to its end.
    #[error("saturated: {samples} samples at the converter's ends")]
    Saturated {
        /// How many.
        samples: usize,
    },
    /// Nothing to take the baseline from.
    #[error(
        "no pre-trigger: {samples} samples before the contact are too few for a baseline, expected 20 % of the record"
    )]
    NoPreTrigger {
        /// How many there are.
        samples: usize,
    },
    /// The window or the record does not hold the whole pulse.
    #[error("the {what} cuts the pulse at {:.1} us", 1e6 * time)]
    Cut {
        /// `window` or `record`.
        what: &'static str,
        /// Where the cut is (s).
        time: f64,
    },
    /// Another pulse in the same record.
    #[error("two impacts in one record: a second pulse at {:.1} us", 1e6 * time)]
    TwoImpacts {
        /// Where the other one is (s).
        time: f64,
    },
    /// The sensor is not at rest before the contact.
    #[error(
        "not at rest before the contact: it varies by {times:.1} times its noise; begin the record earlier, or remove drift and hum"
    )]
    NotAtRest {
        /// Root mean square over the noise of neighbouring samples (1).
        times: f64,
    },
    /// The zero moves by less than a scope without noise shows.
    #[error(
        "the zero moves before the contact by a level or so, and the scope's noise is too small to show how: take fewer volts a division, earth the probe, trigger on line or let the scope warm up"
    )]
    Unresolved,
    /// Nothing above the noise.
    #[error("no pulse above the noise")]
    NoPulse,
    /// Values that are no numbers, or a time axis that does not go on.
    #[error("values or an interval that are no numbers")]
    NotFinite,
    /// It contradicts the others.
    #[error("outlier: {times:.1} standard uncertainties away from the other impacts")]
    Outlier {
        /// How many standard uncertainties (1).
        times: f64,
    },
}

/// The contact begins and ends where the force passes this share of its peak, or the noise if that
/// is more (1).
const CONTACT_SHARE: f64 = 0.01;
/// A pulse must stand out of the noise this many times (1).
const MIN_PEAK_TO_NOISE: f64 = 20.0;
/// Least samples of a baseline.
const MIN_BASELINE_SAMPLES: usize = 50;
/// The end of the contact is not sharp: what is behind it begins this share of the contact later
/// (1).
const TAIL_DELAY_SHARE: f64 = 0.3;
/// The sum of the voltage begins this part of the rise before the contact is seen.
const LEAD_DIVISOR: usize = 3;

/// What the records at one V/div together tell about each of them: the scatter of its samples
/// about smooth curves, and the disturbance of its baseline, if that is known.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    /// Scatter about smooth curves.
    pub scatter: MovingScatter,
    /// Whether its noise is known to be above that of quiet scopes.
    pub is_dithered: bool,
    /// Drift, hum and 1/f noise with the zero.
    pub disturbance: Option<Disturbance>,
    /// Whether the disturbance was looked for in all records together: where none was found, it is
    /// found in the record's own baseline.
    pub is_searched: bool,
    /// Whether all records of a quiet scope may have the same zero.
    pub has_common_zero: bool,
}

/// A record whose pulse is positive and stands out of the noise; its baseline is known.
pub struct PreparedRecord {
    /// Its baseline.
    pub baseline: Baseline,
    /// What the codes before the contact tell, on a quiet scope.
    pub rest: Option<AtRest>,
    /// Standard uncertainty of one sample (V).
    pub noise: f64,
    /// Whether it was turned over.
    pub negative: bool,
    /// The voltage without its baseline.
    pub signal: Trace,
    /// Modes of the baseline's error at each sample (V).
    pub modes: Vec<Vec<f64>>,
    /// Sample of the highest value.
    pub peak: usize,
    /// Threshold of the contact's begin and end (V).
    pub threshold: f64,
}

impl PreparedRecord {
    /// Evaluates `record`, given what all records at its V/div tell.
    ///
    /// # Errors
    /// [`Exclusion`]: why it is no good.
    pub fn new(record: &RawRecord, known: &Surroundings) -> Result<Self, Exclusion> {
        let trace = &record.trace;
        if record.clipped > 0 {
            return Err(Exclusion::Saturated { samples: record.clipped });
        }
        let sound = trace.interval > 0.0 && trace.interval.is_finite();
        if !sound || trace.values.iter().any(|v| !v.is_finite()) {
            return Err(Exclusion::NotFinite);
        }
        let conditions = Conditions { level: record.level, ..Conditions::default() };
        let scatter = || known.scatter;
        let of_rest: Option<&dyn Fn() -> MovingScatter> =
            (known.disturbance.is_none() && !known.is_dithered).then_some(&scatter);
        let found = Baseline::with_rest(trace, (&conditions, false), of_rest);
        let (baseline, rest) = match found {
            Ok((baseline, _)) if baseline.is_moving => return Err(Exclusion::Unresolved),
            Ok((baseline, rest)) if baseline.samples >= MIN_BASELINE_SAMPLES => (baseline, rest),
            Ok(_) | Err(PulseError::NoBaseline { .. })
                if !stands_out(&trace.values, record.level) =>
            {
                return Err(Exclusion::NoPulse);
            }
            Ok((Baseline { samples, .. }, _)) | Err(PulseError::NoBaseline { samples, .. }) => {
                return Err(Exclusion::NoPreTrigger { samples });
            }
            Err(PulseError::NotAtRest { rms, noise, .. }) => {
                return Err(Exclusion::NotAtRest { times: rms / noise });
            }
            Err(PulseError::Unresolved { .. }) => return Err(Exclusion::Unresolved),
            Err(_) => return Err(Exclusion::NoPulse),
        };
        let (mut baseline, rest) = match &known.disturbance {
            Some(disturbance) => {
                let range = 0..baseline.end;
                (Baseline::disturbed(disturbance.clone(), range, record.level), None)
            }
            None => (baseline, rest),
        };
        if rest.is_none() && known.is_searched && known.disturbance.is_none() {
            baseline.find_disturbance(trace);
        }
        let noise = baseline.rounding.sample();
        let (mut signal, mut modes) = baseline.take_from(trace, None);
        let highest = |values: &[f64], sign: f64| {
            let top = values.iter().enumerate().map(|(i, v)| (i, sign * v));
            top.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
        };
        let (up, down) = (highest(&signal.values, 1.0), highest(&signal.values, -1.0));
        let negative = down.1 > up.1;
        let (peak, top) = if negative { down } else { up };
        if negative {
            signal.values.iter_mut().for_each(|v| *v = -*v);
            modes.iter_mut().flatten().for_each(|v| *v = -*v);
        }
        if top < MIN_PEAK_TO_NOISE * noise {
            return Err(Exclusion::NoPulse);
        }
        let rest = rest.map(|rest| if negative { rest.turned() } else { rest });
        let threshold = (CONTACT_SHARE * top).max(NOISE_TIMES * noise);
        Ok(Self { baseline, rest, noise, negative, signal, modes, peak, threshold })
    }

    /// Last sample before the peak that is below the threshold.
    pub fn rise(&self) -> Option<usize> {
        self.signal.values.get(..self.peak)?.iter().rposition(|v| *v <= self.threshold)
    }

    /// Sample from which on the voltage is summed: what the pulse has before it passes the
    /// threshold counts as well.
    pub fn start(&self) -> Option<usize> {
        let rise = self.rise()?;
        Some(rise.saturating_sub((self.peak - rise) / LEAD_DIVISOR))
    }

    /// The samples from the sum's start to where the charge is all that is left: the voltage passes
    /// zero a little before the contact ends, and that end is not sharp.
    pub fn contact(&self) -> Option<Range<usize>> {
        let start = self.start()?;
        let zero = self.fall(&self.signal.values, 0.0)?;
        Some(start..zero + (TAIL_DELAY_SHARE * (zero - start) as f64) as usize)
    }

    /// Mean of each mode of the baseline's error over the contact (V).
    pub fn contact_modes(&self) -> Vec<f64> {
        let Some(contact) = self.contact() else { return Vec::new() };
        let count = contact.len().max(1) as f64;
        let mean = |mode: &Vec<f64>| {
            mode.get(contact.clone()).unwrap_or_default().iter().sum::<f64>() / count
        };
        self.modes.iter().map(mean).collect()
    }

    /// First sample behind the peak where `values` are below `level`.
    pub fn fall(&self, values: &[f64], level: f64) -> Option<usize> {
        let behind = values.get(self.peak..)?.iter().position(|v| *v <= level)?;
        Some(self.peak + behind)
    }
}

/// Whether the values differ more than neighbours do, which is what noise does.
fn stands_out(values: &[f64], level: f64) -> bool {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    let steps: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    let noise = noise_of((0.5 * steps / values.len() as f64).sqrt(), level);
    high - low >= MIN_PEAK_TO_NOISE * noise
}
