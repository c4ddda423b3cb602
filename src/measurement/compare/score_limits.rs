//! Limits of a comparison's scores: `peak=5%, arrival=2us, rms=1lsb`.

use super::{ChannelScore, SpeedScore};
use crate::quantity::{Dimension, Quantity, engineering, parse};

/// A limit on a residual.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Amount {
    Levels(f64),
    Volts(f64),
    Newtons(f64),
}

/// One limit.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Limit {
    Peak(f64),
    Arrival(f64),
    Speed(f64),
    Gain(f64),
    Rms(Amount),
    Max(Amount),
    Correlation(f64),
    Spectrum(f64),
}

/// Limits on the scores; every one that is named has to hold for every channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoreLimits(Vec<Limit>);

impl Default for ScoreLimits {
    /// The scope's resolution: residuals of one level.
    fn default() -> Self {
        Self(vec![Limit::Rms(Amount::Levels(1.0))])
    }
}

/// Largest limit on a relative error (1).
const MAX_SHARE: f64 = 10.0;
/// Largest limit on an arrival, longer than any record (s).
const MAX_TIME: f64 = 1000.0;
/// Largest limit on a residual (levels, V or N).
const MAX_AMOUNT: f64 = 1e6;

const KEYS: &str = "peak, speed, gain, spectrum (each a share, 5%), arrival (2us), rms, max (each 2lsb, 10mV or 0.1N), or correlation (0.99)";

impl ScoreLimits {
    /// Reads `peak=5%,arrival=2us`.
    ///
    /// # Errors
    /// In words: what was found, and what is expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split(',').map(str::trim).filter(|part| !part.is_empty());
        let limits = parts.map(limit).collect::<Result<Vec<_>, _>>()?;
        if limits.is_empty() {
            return Err(format!("found no limit, expected {KEYS}"));
        }
        Ok(Self(limits))
    }

    /// The limits in words.
    pub fn words(&self) -> Vec<String> {
        self.0.iter().map(words).collect()
    }

    /// Scores beyond the limits, as text; a missing score is beyond any.
    pub fn failures(&self, channels: &[ChannelScore], speeds: &[SpeedScore]) -> Vec<String> {
        let mut failures = Vec::new();
        for limit in &self.0 {
            if let Limit::Speed(most) = limit {
                if speeds.is_empty() {
                    failures.push("no speed".to_owned());
                }
                let beyond =
                    speeds.iter().filter(|s| s.error.value.is_nan() || s.error.value.abs() > *most);
                failures.extend(beyond.map(|s| {
                    let off = percent(s.error.value);
                    format!(
                        "speed {} to {} by {}: {off}, more than {}",
                        s.from,
                        s.to,
                        s.estimator,
                        percent(*most)
                    )
                }));
                continue;
            }
            for channel in channels {
                failures.extend(beyond(channel, *limit));
            }
        }
        failures
    }
}

fn limit(part: &str) -> Result<Limit, String> {
    let Some((key, value)) = part.split_once('=') else {
        return Err(format!("found {part}, expected {KEYS}"));
    };
    let has_unit = value.trim().ends_with(|c: char| !c.is_ascii_digit() && c != '.');
    if matches!(key.trim(), "peak" | "speed" | "gain" | "spectrum") && !has_unit {
        let percent = format!("{}={}%", key.trim(), value.trim());
        return Err(format!("found {part} without a unit, expected a share, e.g. {percent}"));
    }
    let read = |dimension, most: f64| match parse(value, dimension) {
        Ok(number) if (0.0..=most).contains(&number) => Ok(number),
        Ok(number) if number > most => Err(match dimension {
            Dimension::TIME => format!("found {part}, expected a limit of at most {most} s"),
            _ if most > 1.0 => format!("found {part}, expected at most {:.0} %", 100.0 * most),
            _ => format!("found {part}, expected a correlation from 0 to {most}"),
        }),
        Ok(_) => Err(format!("found {part}, expected a limit of zero or more")),
        Err(error) => Err(format!("{key}: found {error}, expected {KEYS}")),
    };
    match key.trim() {
        "peak" => read(Dimension::NONE, MAX_SHARE).map(Limit::Peak),
        "speed" => read(Dimension::NONE, MAX_SHARE).map(Limit::Speed),
        "gain" => read(Dimension::NONE, MAX_SHARE).map(Limit::Gain),
        "spectrum" => read(Dimension::NONE, MAX_SHARE).map(Limit::Spectrum),
        "correlation" => read(Dimension::NONE, 1.0).map(Limit::Correlation),
        "arrival" => read(Dimension::TIME, MAX_TIME).map(Limit::Arrival),
        "rms" => amount(part, value).map(Limit::Rms),
        "max" => amount(part, value).map(Limit::Max),
        other => Err(format!("found {other}, expected {KEYS}")),
    }
}

fn amount(part: &str, text: &str) -> Result<Amount, String> {
    let wrong = || format!("found {part}, expected levels, volts or newtons: 2lsb, 10mV, 0.1N");
    let lower = text.trim().to_ascii_lowercase();
    let found = if let Some(levels) = lower.strip_suffix("lsb") {
        Amount::Levels(levels.trim().parse().map_err(|_| wrong())?)
    } else {
        match text.parse::<Quantity>().map(|quantity| (quantity.value, quantity.dimension)) {
            Ok((volts, Dimension::VOLTAGE)) => Amount::Volts(volts),
            Ok((newtons, Dimension::FORCE)) => Amount::Newtons(newtons),
            _ => return Err(wrong()),
        }
    };
    let (Amount::Levels(value) | Amount::Volts(value) | Amount::Newtons(value)) = found;
    if (0.0..=MAX_AMOUNT).contains(&value) { Ok(found) } else { Err(wrong()) }
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

fn words(limit: &Limit) -> String {
    match limit {
        Limit::Peak(most) => format!("peak within {}", percent(*most)),
        Limit::Speed(most) => format!("speed within {}", percent(*most)),
        Limit::Gain(most) => format!("gain within {} of 1", percent(*most)),
        Limit::Spectrum(most) => format!("spectrum distance up to {}", percent(*most)),
        Limit::Correlation(least) => format!("correlation of {least} or more"),
        Limit::Arrival(most) => format!("arrival within {}", engineering(*most, "s", 3)),
        Limit::Rms(most) => format!("rms difference up to {}", in_words(*most)),
        Limit::Max(most) => format!("largest difference up to {}", in_words(*most)),
    }
}

fn in_words(amount: Amount) -> String {
    match amount {
        Amount::Levels(levels) => format!("{levels:.2} LSB"),
        Amount::Volts(volts) => engineering(volts, "V", 3),
        Amount::Newtons(newtons) => engineering(newtons, "N", 3),
    }
}

/// A score beyond its limit, as text.
fn beyond(channel: &ChannelScore, limit: Limit) -> Option<String> {
    let share = |error: f64| percent(error);
    let seconds = |error: f64| engineering(error, "s", 3);
    let residual = |most: Amount, (own, levels, newtons): (f64, f64, Option<f64>)| match most {
        Amount::Levels(most) => (Some(levels), most, in_words(Amount::Levels(levels))),
        Amount::Volts(most) => {
            (Some(own).filter(|_| channel.unit == "V"), most, in_words(Amount::Volts(own)))
        }
        Amount::Newtons(most) => {
            (newtons, most, newtons.map_or_else(String::new, |n| in_words(Amount::Newtons(n))))
        }
    };
    let told = |error: Option<f64>, most: f64, show: &dyn Fn(f64) -> String| {
        (error.map(f64::abs), most, error.map_or_else(String::new, show))
    };
    let (error, most, shown) = match limit {
        Limit::Peak(most) => told(channel.peak_error.map(|e| e.value), most, &share),
        Limit::Gain(most) => told(Some(channel.gain.value - 1.0), most, &share),
        Limit::Spectrum(most) => told(channel.spectrum_distance, most, &share),
        Limit::Arrival(most) => told(channel.arrival_error_s.map(|e| e.value), most, &seconds),
        // The closer to one the better: what is missing from one counts.
        Limit::Correlation(least) => {
            let found = channel.correlation;
            (
                found.map(|c| 1.0 - c),
                1.0 - least,
                found.map_or_else(String::new, |c| format!("{c:.5}")),
            )
        }
        Limit::Rms(most) => residual(most, (channel.rms, channel.rms_lsb, channel.rms_n)),
        Limit::Max(most) => residual(most, (channel.max, channel.max_lsb, channel.max_n)),
        Limit::Speed(_) => return None,
    };
    let name = &channel.name;
    match error {
        Some(error) if error <= most => None,
        Some(_) => Some(format!("{name}: {shown}, expected {}", words(&limit))),
        None => Some(format!("{name}: no value, expected {}", words(&limit))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_with_their_units_and_refused_by_name() {
        let found =
            ScoreLimits::parse("peak=5%, arrival=2us,rms=1.5 lsb,max=0.2N,correlation=0.99");
        let expected = vec![
            Limit::Peak(0.05),
            Limit::Arrival(2e-6),
            Limit::Rms(Amount::Levels(1.5)),
            Limit::Max(Amount::Newtons(0.2)),
            Limit::Correlation(0.99),
        ];
        assert_eq!(found, Ok(ScoreLimits(expected)));
        for (wrong, told) in [
            ("", "no limit"),
            ("peak", "expected peak"),
            ("peak=5us", "a time"),
            ("peak=5", "e.g. peak=5%"),
            ("speed=0.05", "without a unit"),
            ("rms=3kg", "levels, volts or newtons"),
            ("rms=-1lsb", "levels, volts or newtons"),
            ("rms=nanlsb", "levels, volts or newtons"),
            ("speed=-1%", "zero or more"),
            ("colour=1", "found colour"),
            ("correlation=2", "a correlation from 0 to 1"),
            ("peak=1e300%", "at most 1000 %"),
            ("arrival=1e300s", "at most 1000 s"),
            ("rms=1e300lsb", "levels, volts or newtons"),
        ] {
            let error = ScoreLimits::parse(wrong).expect_err(wrong);
            assert!(error.contains(told), "{wrong}: {error}");
        }
    }
}
