//! When a pulse arrives at a sensor: several estimators of the first pulse of a sampled trace, each
//! with its uncertainty.
//!
//! The paper does not say how it measured arrivals, and estimators differ by tens of microseconds:
//! an arrival always carries its estimator's name. With `P` the height of the first peak:
//!
//! - level crossings at `f P`, `f` = 0.5 (half-rise) and 0.1: the time when a cubic through the
//!   samples around the crossing, over 0.35 of the rise from half to peak on either side, is at the
//!   level; `u^2 = [u_fit^2 + (f u_P)^2 + u_zero^2] / slope^2 + u_dt^2`, `u_P` without the zero and
//!   `u_zero` that of the zero there less `f` times the zero at the peak;
//! - peak: where a polynomial of degree 5 over 0.6 of that rise on either side has its maximum;
//!   `u^2 = (u_slope^2 + u_tilt^2) / curvature^2 + u_dt^2`;
//! - maximum slope: the inflection of a quartic over 0.75 of that rise on either side.
//!
//! `u_fit`, `u_slope`: from the samples' noise through the fit's covariance; `u_zero`, `u_tilt`:
//! from the zero's modes ([`super::disturbance`]), grown by undoing the droop ([`super::droop`]);
//! `u_dt = dt^2 |y''/y'| / (8 sqrt(3))`: what a straight line between two samples may miss of the
//! curve, the sample interval's share. Propagation: JCGM 100:2008, Eq. (10). To both places that
//! are found as a polynomial's extremum or inflection comes `u_shape`, since pulses are no
//! polynomials: the distance to that of a fit over 1.6 times as many samples, over `1.6^p - 1`
//! where it grows with the width's power `p`. An inflection moves by the first term that a quartic
//! leaves out of the curvature, `p` = 4. A peak moves by the seventh derivative, `p` = 6, in slow
//! components of a pulse; `p` falls to 3 in those with periods of 0.65 rises (from the response of
//! the fit's slope to a sine), and faster ones are peaks of their own. In gravity's chains two
//! contacts press on a plate one after the other: the top is flat, with shoulders half a rise away,
//! and `p` is 3 to 4 (gravity-1.22g, 2.75g and 17.81g, noise of 0.004 to 0.06 div). Valid for
//! pulses that rise over at least four samples and stand at least six standard deviations out of
//! the noise; for signals whose time constant is not known, droop moves arrivals by more than is
//! stated (peaks by about 1 us in this bench).

use crate::numeric::intervals::even_half_width;
use crate::quantity::Uncertain;
use std::fmt;

use super::local_fit::{LocalFit, nearest_fall};
use super::pulse::Pulse;
use super::rounding::Spread;

/// Definition of the arrival.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Estimator {
    /// The signal first reaches half of its first peak.
    HalfRise,
    /// The first peak.
    Peak,
    /// The signal first reaches a tenth of its first peak.
    TenPercent,
    /// The signal rises fastest before its first peak.
    MaximumSlope,
}

impl Estimator {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 4] = [Self::HalfRise, Self::Peak, Self::TenPercent, Self::MaximumSlope];

    /// Name in machine-readable reports, as `run --json` has it.
    pub fn key(self) -> &'static str {
        match self {
            Self::HalfRise => "half_rise",
            Self::Peak => "peak",
            Self::TenPercent => "ten_percent",
            Self::MaximumSlope => "maximum_slope",
        }
    }
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::HalfRise => "half-rise",
            Self::Peak => "peak",
            Self::TenPercent => "10 %",
            Self::MaximumSlope => "max. slope",
        })
    }
}

/// A polynomial's degree, and the share of the rise from half to peak on either side over which it
/// is fitted.
struct Fitted(usize, f64);
const LEVEL: Fitted = Fitted(3, 0.35);
const PEAK: Fitted = Fitted(5, 0.6);
const STEEPEST: Fitted = Fitted(4, 0.75);
/// Powers of a fit's width with which what the pulse's shape does to the places grows (1).
const PEAK_GROWTH: i32 = 3;
const STEEPEST_GROWTH: i32 = 4;
/// Width of the second fit, which shows what the pulse's shape does to a place found, over that of
/// the first (1).
const FIT_WIDTH_FACTOR: f64 = 1.6;
/// A level this many standard deviations of the smoothed noise high can be found (1).
const MIN_LEVEL_DEVIATIONS: f64 = 4.0;
/// A crossing at a tenth of the height, and at half of it, is refused where its slope's standard
/// uncertainty is a larger share of the slope at half of the height: there the first order of the
/// propagation does not hold. The crossing's own slope is no measure: those that noise has made
/// steep would be kept. Chosen, as the next, on the magnet scene in noise of 0.06 to 0.2 div (seeds
/// from 20000 on, others than the tests'), so that intervals hold the truth in 93 % or more (1).
const MAX_SLOPE_SHARE: [f64; 2] = [0.2, 0.6];
/// Arrivals at a tenth of the height are refused where the noise of one sample is a larger share of
/// the height, or 1/f noise moves the crossing more than white noise does: the samples around the
/// crossing are then those that noise has chosen (1).
const MAX_NOISE_AT_TENTH: f64 = 0.05;
/// A peak's time is refused where noise moves it by a larger share of the fit's reach, for a
/// parabola that is half as high a rise away (1).
const MAX_PEAK_SHARE: f64 = 0.2;
/// A fit is moved to what it found this many times.
const CENTRING_STEPS: usize = 3;

/// How much larger the variance of a quotient is than with an exact divisor, whose own is
/// `variance`: `1 + 3 r^2` to second order, `r` its relative uncertainty (1).
fn over_noisy(divisor: f64, variance: f64) -> f64 {
    1.0 + 3.0 * variance / (divisor * divisor)
}

/// A fitted polynomial and the place found in it.
struct Place {
    fit: LocalFit,
    x: f64,
}

impl Pulse {
    /// When the pulse arrives by `estimator` (s); none if it is not determined.
    pub fn arrival(&self, estimator: Estimator) -> Option<Uncertain> {
        match estimator {
            Estimator::HalfRise => self.crossing(0.5, self.reach_of(0.5)?),
            Estimator::TenPercent if self.hides_tenth() => None,
            Estimator::TenPercent => self.crossing(0.1, self.reach_of(0.1)?),
            Estimator::Peak => self.peak_time(),
            Estimator::MaximumSlope => self.steepest(),
        }
    }

    /// Height of the first peak above the baseline (unit).
    pub fn height(&self) -> Option<Uncertain> {
        let place = self.peak_place()?;
        let Place { fit, x } = &place;
        let spread = self.top_spread(&place).plus(self.zero_spread(fit.time(*x)));
        let u = spread.variance.sqrt();
        let half_width = even_half_width(u, spread.fourth_cumulant);
        Some(Uncertain { value: fit.value(*x), u, half_width })
    }

    /// How noise and rounding distribute the height at the peak's `place`, without the zero.
    fn top_spread(&self, place: &Place) -> Spread {
        self.spread(&place.fit, &place.fit.gradient(0, place.x))
    }

    /// Full width at half of the first peak (s); none where the signal does not fall to it again.
    pub fn width(&self) -> Option<Uncertain> {
        let level = 0.5 * self.height()?.value;
        let fallen = self.smoothed.iter().skip(self.peak).position(|v| *v <= level)?;
        let (rise, fall) =
            (self.arrival(Estimator::HalfRise)?, self.crossing(0.5, self.peak + fallen)?);
        // Both ends move with the peak's height in opposite directions: their uncertainties add up
        // at worst.
        let standard_uncertainty = rise.u + fall.u;
        Some(Uncertain::normal(fall.value - rise.value, standard_uncertainty))
    }

    /// True if noise hides the pulse at a tenth of its height.
    fn hides_tenth(&self) -> bool {
        let height = self.height().map_or(0.0, |height| height.value);
        self.noise > MAX_NOISE_AT_TENTH * height
    }

    /// First smoothed sample at `share` of the peak, if that is clear of the noise.
    fn reach_of(&self, share: f64) -> Option<usize> {
        let level = share * self.height()?.value;
        if level < MIN_LEVEL_DEVIATIONS * self.smoothed_noise {
            return None;
        }
        let first = self.smoothed.iter().position(|v| *v >= level)?;
        (first > 0).then_some(first)
    }

    /// Time at which the signal is at `share` of its first peak, near sample `at`.
    fn crossing(&self, share: f64, at: usize) -> Option<Uncertain> {
        let top = self.peak_place()?;
        let level = share * top.fit.value(top.x);
        let fit = self.fit(at, self.share_of_rise(&LEVEL), LEVEL.0)?;
        // A level is crossed upward before the peak and downward behind it.
        let sign = if at < self.peak { 1.0 } else { -1.0 };
        let x = nearest_fall(&|x| sign * (level - fit.value(x)))?;
        let slope = fit.slope(x);
        let of_slope = self.variance(&fit, &fit.gradient(1, x));
        let [at_tenth, at_half] = MAX_SLOPE_SHARE;
        let most = if share < 0.5 { at_tenth } else { at_half };
        let value = fit.gradient(0, x);
        let is_coloured = share < 0.5 && self.is_coloured(&fit, &value);
        if is_coloured || of_slope.sqrt() > most * self.slope_at_half()? {
            return None;
        }
        let noise = self.variance(&fit, &value) * over_noisy(slope, of_slope);
        let height = share * share * self.top_spread(&top).variance;
        let zero = self.zero_difference(fit.time(x), top.fit.time(top.x), share);
        let seconds = fit.scale() / slope;
        let interval = self.interval_share(fit.curvature(x) / slope / fit.scale());
        let variance = (noise + height + zero) * seconds * seconds + interval * interval;
        Some(Uncertain::normal(fit.time(x), variance.sqrt()))
    }

    /// Slope of the fit around half of the height (unit).
    fn slope_at_half(&self) -> Option<f64> {
        let fit = self.fit(self.half, self.share_of_rise(&LEVEL), LEVEL.0)?;
        Some(fit.slope(0.0)).filter(|slope| *slope > 0.0)
    }

    fn peak_time(&self) -> Option<Uncertain> {
        let Place { fit, x } = self.peak_place()?;
        let shape = self.shape((&fit, x), &PEAK, &LocalFit::slope, PEAK_GROWTH);
        let curvature = fit.curvature(x);
        let tilt = self.tilt_variance(fit.time(x), fit.scale());
        let seconds = fit.scale() / curvature;
        let interval = self.interval_share(fit.bend(x) / curvature / fit.scale());
        let of_curvature = self.variance(&fit, &fit.gradient(2, x));
        let of_slope = self.variance(&fit, &fit.gradient(1, x)).sqrt();
        if of_slope > MAX_PEAK_SHARE * PEAK.1 * PEAK.1 * fit.value(x).abs() {
            return None;
        }
        let noise = (self.variance(&fit, &fit.gradient(1, x)) + tilt) * seconds * seconds;
        let noise = noise * over_noisy(curvature, of_curvature);
        let variance = noise + interval * interval + shape * shape;
        Some(Uncertain::normal(fit.time(x), variance.sqrt()))
    }

    /// The maximum of a polynomial around the first peak, whose middle is moved to where the
    /// maximum was found.
    fn peak_place(&self) -> Option<Place> {
        // Noise may leave a quartic over a flat top without a maximum; a parabola has one.
        let of = |fitted: &Fitted| {
            let place = self.centred(self.peak, fitted, &LocalFit::slope)?;
            // Another maximum is another peak.
            let found = self.nearest(place.fit.time(place.x));
            (found.abs_diff(self.peak) <= self.rise()).then_some(place)
        };
        of(&PEAK).or_else(|| of(&Fitted(2, PEAK.1)))
    }

    fn steepest(&self) -> Option<Uncertain> {
        let start = self.reach_of(0.1)?;
        let step = self.share_of_rise(&LEVEL).max(1);
        let gain = |at: &usize| {
            let of = |index: usize| self.smoothed.get(index).copied().unwrap_or(f64::NAN);
            of(at + step) - of(at.saturating_sub(step))
        };
        let rough = (start..=self.peak).max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
        let cubic = || self.centred(rough, &Fitted(3, STEEPEST.1), &LocalFit::curvature);
        let Place { fit, x } =
            self.centred(rough, &STEEPEST, &LocalFit::curvature).or_else(cubic)?;
        let bend = fit.bend(x);
        let seconds = fit.scale() / bend;
        let of_bend = self.variance(&fit, &fit.gradient(3, x));
        let noise = self.variance(&fit, &fit.gradient(2, x))
            * seconds
            * seconds
            * over_noisy(bend, of_bend);
        let interval = self.interval_share(1.0 / fit.scale());
        let shape = self.shape((&fit, x), &STEEPEST, &LocalFit::curvature, STEEPEST_GROWTH);
        let standard_uncertainty = (noise + interval * interval + shape * shape).sqrt();
        Some(Uncertain::normal(fit.time(x), standard_uncertainty))
    }

    /// Fits around sample `at`, finds where `zero` is zero, and fits again around that, so that the
    /// place comes to lie in the middle.
    fn centred(
        &self,
        at: usize,
        fitted: &Fitted,
        zero: &dyn Fn(&LocalFit, f64) -> f64,
    ) -> Option<Place> {
        let mut at = at;
        let mut found = None;
        for _ in 0..CENTRING_STEPS {
            let fit = self.fit(at, self.share_of_rise(fitted), fitted.0)?;
            let x = nearest_fall(&|x| zero(&fit, x))?;
            let next = self.nearest(fit.time(x));
            let settled = next == at;
            found = Some(Place { fit, x });
            if settled {
                break;
            }
            at = next;
        }
        found
    }

    /// By how much the pulse's shape moves the place at `x` in `fit`, from the distance to that in
    /// a fit over more samples (s).
    fn shape(
        &self,
        (fit, x): (&LocalFit, f64),
        fitted: &Fitted,
        zero: &dyn Fn(&LocalFit, f64) -> f64,
        power: i32,
    ) -> f64 {
        let found = fit.time(x);
        let wider = Fitted(fitted.0, FIT_WIDTH_FACTOR * fitted.1);
        let wider = self.centred(self.nearest(found), &wider, zero);
        let moved = wider.map_or(0.0, |Place { fit, x }| (fit.time(x) - found).abs());
        moved / (FIT_WIDTH_FACTOR.powi(power) - 1.0)
    }

    /// What a straight line between two samples may miss of the curve, for `bend` = `|y''/y'|`
    /// (1/s), as a time (s).
    fn interval_share(&self, bend: f64) -> f64 {
        let dt = self.signal.interval;
        dt * dt * bend.abs() / (8.0 * 3f64.sqrt())
    }

    fn share_of_rise(&self, fitted: &Fitted) -> usize {
        (fitted.1 * self.rise() as f64).round() as usize
    }

    fn nearest(&self, time: f64) -> usize {
        ((time - self.signal.start) / self.signal.interval).round() as usize
    }
}
