//! The column of times or frequencies, and the interval behind it. Reader and writer share it.
//! Equations and sources: the module above.

use super::layout::{self, Domain, HeaderLayout};

/// The interval that a header's `Sample Interval` stands for (s; Hz for an FFT).
///
/// The time domain's intervals have few digits and are printed in full. An FFT's follow from the
/// sampling rate and are cut to seven digits; this finds the rate whose interval prints like
/// `text`. Falls back on `printed` where no rate does.
pub(super) fn exact_interval(domain: Domain, printed: f64, text: &str) -> f64 {
    match domain {
        Domain::Time => printed,
        Domain::Frequency => (0..=11)
            .flat_map(|power| [1.0, 2.5, 5.0].map(|digits| digits * 10_f64.powi(power)))
            .map(bin_spacing)
            .find(|spacing| layout::spells(*spacing, domain, text))
            .unwrap_or(printed),
    }
}

/// Distance of two FFT bins (Hz) at 250 points a division taken at `rate` (S/s).
///
/// `rate/2048`, and 100/99 of it at 250 µs/div and slower. Source: 56 published files, the
/// project's fact sheet on the TDS2000 family, section 1.1.
fn bin_spacing(rate: f64) -> f64 {
    let slow = if rate <= 1e6 { 100.0 / 99.0 } else { 1.0 };
    rate * slow / 2048.0
}

/// The column of times or frequencies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Abscissa {
    pub(super) domain: Domain,
    pub(super) layout: HeaderLayout,
    /// From one row to the next (s; Hz for an FFT).
    pub(super) interval: f64,
    /// Index of the trigger (1).
    pub(super) trigger_point: f64,
}

impl Abscissa {
    /// Abscissa of row `index`, counted from 0 (s; Hz for an FFT).
    pub(super) fn value(&self, index: u32) -> f64 {
        let beside = self.layout.rows();
        if self.domain == Domain::Time || index < beside {
            return (f64::from(index) - self.trigger_point) * self.interval;
        }
        let last_beside = f64::from(beside - 1) * self.interval;
        five_decimals(last_beside) + f64::from(index + 1 - beside) * five_decimals(self.interval)
    }

    /// Abscissa of row `index`, counted from 0, as the instrument prints it.
    pub(super) fn text(&self, index: u32) -> String {
        let value = self.value(index);
        let beside = self.layout.rows();
        match (self.domain, index < beside) {
            (Domain::Frequency, true) => format!("{value:17.5}"),
            (Domain::Frequency, false) => format!("{value:.5}"),
            (Domain::Time, true) => format!("{value:17.12}"),
            (Domain::Time, false) => {
                let zero = if self.trigger_point >= f64::from(beside) { "0" } else { "" };
                let sign = if f64::from(index) <= self.trigger_point { "-" } else { "" };
                format!("{sign}{zero}{:.12}", value.abs())
            }
        }
    }

    /// How far a printed abscissa may lie from `value` (s; Hz for an FFT): half the last digit of a
    /// time, one last digit of a frequency, whose addition of printed numbers is inferred.
    pub(super) fn tolerance(&self, value: f64) -> f64 {
        let digits = match self.domain {
            Domain::Time => 0.5e-12,
            Domain::Frequency => 1e-5,
        };
        digits * (1.0 + 1e-6) + 4.0 * f64::EPSILON * value.abs()
    }
}

/// `value` as five printed decimals say it.
fn five_decimals(value: f64) -> f64 {
    format!("{value:.5}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An FFT of firmware v6.08, fact sheet section 4.3: rows 1, 2, 16 stand beside the header.
    #[test]
    fn old_fft_frequencies_add_printed_numbers() {
        let interval = exact_interval(Domain::Frequency, 12.33033, "1.233033e+01");
        assert!((interval - 25e3 * 100.0 / 99.0 / 2048.0).abs() < 1e-12, "{interval}");
        let column = Abscissa {
            domain: Domain::Frequency,
            layout: HeaderLayout::Old,
            interval,
            trigger_point: 0.0,
        };
        for (index, text) in [
            (0, "          0.00000"),
            (1, "         12.33033"),
            (2, "         24.66067"),
            (9, "        110.97301"),
            (15, "        184.95502"),
            (16, "197.28535"),
            (17, "209.61568"),
            (18, "221.94601"),
            (19, "234.27634"),
        ] {
            assert_eq!(column.text(index), text, "row {}", index + 1);
        }
    }

    /// A file of a TDS1012C-EDU, fact sheet section 4.3.
    #[test]
    fn fast_fft_interval_is_recovered() {
        let interval = exact_interval(Domain::Frequency, 12207.03, "1.220703e+04");
        assert!((interval - 12_207.031_25).abs() < 1e-9, "{interval}");
        let column = Abscissa {
            domain: Domain::Frequency,
            layout: HeaderLayout::Named,
            interval,
            trigger_point: 0.0,
        };
        assert_eq!(column.text(17), "     207519.53125");
        assert_eq!(column.text(18), "219726.56250");
    }

    /// A file of a TDS2014C, fact sheet section 4.3: rows 1, 18, 19 and those about the trigger.
    #[test]
    fn times_below_the_header_have_an_extra_zero() {
        let column = Abscissa {
            domain: Domain::Time,
            layout: HeaderLayout::Named,
            interval: 1e-4,
            trigger_point: 800.0,
        };
        for (index, text) in [
            (0, "  -0.080000000000"),
            (17, "  -0.078300000000"),
            (18, "-00.078200000000"),
            (799, "-00.000100000000"),
            (800, "-00.000000000000"),
            (801, "00.000100000000"),
            (802, "00.000200000000"),
        ] {
            assert_eq!(column.text(index), text, "row {}", index + 1);
        }
    }

    /// A scan-mode file of a TBS1072B, fact sheet section 4.3.
    #[test]
    fn scan_times_have_neither_zero_nor_sign() {
        let column = Abscissa {
            domain: Domain::Time,
            layout: HeaderLayout::Named,
            interval: 4e-3,
            trigger_point: -0.0,
        };
        assert_eq!(column.text(0), "   0.000000000000");
        assert_eq!(column.text(17), "   0.068000000000");
        assert_eq!(column.text(18), "0.072000000000");
    }
}
