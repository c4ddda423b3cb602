//! Readings of a recorder at the end of a run.

use super::{PEAK_SHARE, PassedOver, Peak, PulseRecorder};
use crate::experiment::segment::Rise;
use crate::motion::probe_step::SAMPLE_TIMES;
use crate::numeric::roots::root;

impl PulseRecorder {
    /// A copy that takes up no more memory than its readings need: of many that are kept, most
    /// would be empty.
    pub fn readings(&mut self) -> Self {
        self.clear_history();
        self.clone()
    }

    /// Largest dynamic force so far (N).
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Whether that is rounding, and no pulse.
    pub fn is_quiet(&self) -> bool {
        self.largest <= self.quietest
    }

    /// The first local maximum of the dynamic force above a quarter of its largest value so far,
    /// and above the rounding of the static force and of the impact's.
    pub fn first_peak(&self) -> Option<Peak> {
        let threshold = (PEAK_SHARE * self.largest).max(self.quietest);
        let high = self.peaks.iter().filter(|peak| peak.most > threshold);
        let mut tops = high.map(|peak| (peak, self.felt.top(peak)));
        let (peak, (theta, dynamic_n)) = tops.find(|(_, top)| top.1 > threshold)?;
        let time_s = self.felt.time(&peak.segment, theta);
        Some(Peak { total_n: dynamic_n + self.static_force, dynamic_n, time_s })
    }

    /// The highest maximum that was the first peak until larger forces raised the threshold above
    /// it.
    pub fn passed_over(&self) -> Option<PassedOver> {
        let threshold = (PEAK_SHARE * self.largest).max(self.quietest);
        let tops = self.passed_over.iter().chain(&self.peaks).map(|peak| self.felt.top(peak).1);
        let dynamic_n = tops.take_while(|top| *top <= threshold).fold(0.0, f64::max);
        if dynamic_n <= self.quietest {
            return None;
        }
        Some(PassedOver { dynamic_n, until_s: self.first_reach(dynamic_n / PEAK_SHARE)? })
    }

    /// The time when the dynamic force first reached `level` (N), which is positive; none where it
    /// did not, or where the level is lower than [`MIN_LEVEL_SHARE`](super::MIN_LEVEL_SHARE) of a
    /// first peak and no longer remembered (s).
    pub fn first_reach(&self, level: f64) -> Option<f64> {
        let is_it = |rise: &&Rise| rise.reached >= level && level > self.forgotten;
        let Rise { segment, top, .. } = self.rises.iter().find(is_it)?;
        let excess = |theta: f64| self.felt.force(segment, theta) - level;
        let (mut before, mut lacks) = (0.0, excess(0.0));
        if lacks >= 0.0 {
            return Some(self.felt.time(segment, 0.0));
        }
        // Looks up to the largest force, which may stand between two of them.
        let looks = SAMPLE_TIMES.into_iter().take_while(|look| look < top);
        for theta in looks.chain([*top]) {
            let exceeds = excess(theta);
            if exceeds >= 0.0 {
                let reached = root(&excess, [before, theta], [lacks, exceeds]);
                return Some(self.felt.time(segment, reached));
            }
            (before, lacks) = (theta, exceeds);
        }
        Some(self.felt.time(segment, *top))
    }
}
