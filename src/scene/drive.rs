//! `[drive]`: what moves a wall at an end of the chain, and the signal of its generator.

use std::f64::consts::TAU;
use std::sync::Arc;

use rand_distr::{Distribution as _, StandardUniform};

use super::document::{Node, Value};
use super::table::{Bound, TableReader};
use super::table::{any, positive, quantity, series, table, table_of, word, words};
use crate::chain::{Carrier, Drive, Signal, Support};
use crate::quantity::{Dimension, engineering};
use crate::scope::front_end::noise_stream;

/// Names of the generator's outputs, which channels take as inputs beside sensors: its signal, and
/// a pulse as long as the signal lasts.
pub const OUTPUTS: [&str; 2] = ["generator", "sync"];
/// Most sines that a band of noise is made of: the time of a run grows with them.
const MAX_TONES: f64 = 10_000.0;
/// Share of its length over which a signal under a Tukey window rises, and falls (1).
const EDGE_SHARE: f64 = 0.1;
/// Stream of the phases of noise; channels use 1 to 4, the striker's speed 5.
const PHASE_STREAM: u8 = 6;
const SIGNALS: [&str; 5] = ["sine", "burst", "chirp", "noise", "samples"];
const A_SIGNAL: &str = "e.g. { sine = \"10 kHz\" }, { burst = \"10 kHz\", cycles = 5 }, { chirp = [\"1 kHz\", \"20 kHz\"], length = \"5 ms\" }, { noise = [\"1 kHz\", \"20 kHz\"], length = \"5 ms\" } or { file = \"burst.csv\" }";

/// The end of a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChainEnd {
    /// The top.
    Top,
    /// The bottom.
    Bottom,
}

words! { ChainEnd { "top" => Top, "bottom" => Bottom } }

/// How a signal that ends begins and ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// At once.
    Rectangle,
    /// Rises over a tenth of its length, and falls as long.
    Tukey,
    /// Rises over the first half and falls over the second.
    Hann,
}

words! { Window { "rectangle" => Rectangle, "tukey" => Tukey, "hann" => Hann } }

table! {
    /// `[drive]`.
    pub struct DriveKeys<'a> {
        /// or "bottom"; there must be a wall, whose material touches the chain
        end: ChainEnd = word::<ChainEnd>().or("top"),
        /// of the wall into the chain at the signal's peak (of noise: rms), whatever the force; or:
        displacement: f64 = quantity(Dimension::LENGTH, Bound::Bench(1e-18, 1e-2)),
        /// a piezo stack
        stack: StackKeys<'a> = table_of(&[StackKeys::KEYS])
            .needs("{ stiffness = \"30 N/um\", stroke = \"100 nm\" }"),
        signal: TableReader<'a> = table_of(&[SignalKeys::KEYS]).required().needs(A_SIGNAL),
    }
}

table! {
    /// A piezo stack.
    pub struct StackKeys<'a> {
        stiffness: f64 = positive(Dimension::STIFFNESS).required(),
        /// at the signal's peak, without a load
        stroke: f64 = quantity(Dimension::LENGTH, Bound::Bench(1e-18, 1e-2)).required(),
    }
}

table! {
    /// The signal of the drive's generator.
    pub struct SignalKeys<'a> {
        /// continuous; or one of the next four
        sine: f64 = positive(Dimension::FREQUENCY),
        /// a sine of some cycles
        burst: f64 = positive(Dimension::FREQUENCY),
        cycles: f64 = quantity(Dimension::NONE, Bound::Within(0.5, 1e6)),
        /// a sine whose frequency rises from the first to the second over the length
        chirp: (f64, f64) = series(Dimension::FREQUENCY).needs("two frequencies, [\"1 kHz\", \"20 kHz\"]"),
        /// in this band, from the seed, the same for every shot
        noise: (f64, f64) = series(Dimension::FREQUENCY).needs("two frequencies, [\"1 kHz\", \"20 kHz\"]"),
        /// of a chirp or noise
        length: f64 = positive(Dimension::TIME),
        /// or "tukey" (edges of a tenth of the length), "hann"; default of chirp and noise: "tukey"
        window: Window = word::<Window>(),
        /// how long a continuous sine rises
        ramp: f64 = quantity(Dimension::TIME, Bound::NotNegative),
        /// of values, or of lines `time, value`: a generator's samples
        file: &'a str = super::table::text(),
        /// instead of a file, a list of numbers
        samples: &'a Node = any(&[]),
        /// from one sample to the next
        interval: f64 = positive(Dimension::TIME),
    }
}

/// The supports of the chain with the drive of `table`; `seed` decides on noise. None if something
/// is wrong with it.
pub fn driven(
    table: &TableReader<'_>,
    seed: Option<u64>,
    mut supports: [Support; 2],
) -> Option<[Support; 2]> {
    let keys = DriveKeys::read(table);
    let motion = match (table.has("displacement"), table.has("stack")) {
        (true, false) => keys.displacement.map(|amplitude| (amplitude, None)),
        (false, true) => keys.stack.and_then(|stack| Some((stack.stroke?, Some(stack.stiffness?)))),
        (both, _) => {
            let found = if both {
                "a displacement beside a stack"
            } else {
                "neither displacement nor stack"
            };
            let expected = "displacement = \"50 nm\", or stack = { stiffness = \"30 N/um\", stroke = \"100 nm\" }";
            table.problem("displacement", found, expected);
            None
        }
    };
    let signal = keys.signal.as_ref().and_then(|table| signal(&SignalKeys::read(table), seed));
    let (amplitude, stiffness) = motion?;
    let drive = Drive { amplitude, stiffness, signal: signal? };
    let end = keys.end? as usize;
    if supports[end].moves() {
        let expected = "a wall at that end, or the drive at the other end";
        table.problem("end", "a rod or plate, which a drive cannot move", expected);
        return None;
    }
    supports[end] = Support::Driven(drive);
    Some(supports)
}

fn signal(keys: &SignalKeys<'_>, seed: Option<u64>) -> Option<Signal> {
    let table = &keys.table;
    let given: Vec<&str> = SIGNALS.into_iter().filter(|key| table.has(key)).collect();
    let [kind] = given.as_slice() else {
        let found = if given.is_empty() { "no signal".to_owned() } else { given.join(" and ") };
        table.problem("", found, A_SIGNAL);
        return None;
    };
    let takes: &[&str] = match *kind {
        "sine" => &["ramp"],
        "burst" => &["cycles", "window"],
        "samples" => &["interval", "window"],
        _ => &["length", "window"],
    };
    let others = ["cycles", "length", "window", "ramp", "interval"];
    for key in others.iter().filter(|key| table.has(key) && !takes.contains(key)) {
        table.problem(
            key,
            format!("`{key}` beside `{kind}`"),
            format!("{kind} with {}", takes.join(" and ")),
        );
    }
    for key in takes.iter().filter(|key| !["ramp", "window"].contains(key) && !table.has(key)) {
        table.require(SignalKeys::KEYS, key);
    }
    let (carrier, length, window) = match *kind {
        "sine" => (Carrier::Sine { frequency: keys.sine? }, f64::INFINITY, Window::Rectangle),
        "burst" => {
            let frequency = keys.burst?;
            (Carrier::Sine { frequency }, keys.cycles? / frequency, Window::Rectangle)
        }
        "chirp" => {
            let ((from, to), length) = (keys.chirp?, keys.length?);
            (Carrier::Chirp { from, rate: (to - from) / length, to }, length, Window::Tukey)
        }
        "noise" => {
            let length = keys.length?;
            let carrier = noise(keys.noise?, length, seed?);
            let refuse = |expected| table.problem("length", engineering(length, "s", 3), expected);
            (carrier.map_err(refuse).ok()?, length, Window::Tukey)
        }
        _ => {
            let (values, interval) = (samples(table, keys.samples?)?, keys.interval?);
            let length = interval * values.len() as f64;
            (Carrier::Samples(values, interval), length, Window::Rectangle)
        }
    };
    let edge = match keys.window.unwrap_or(window) {
        Window::Rectangle => keys.ramp.unwrap_or(0.0),
        Window::Tukey => EDGE_SHARE * length,
        Window::Hann => 0.5 * length,
    };
    Some(Signal { carrier, length, edge })
}

/// Sines a length's inverse apart over the band, of equal amplitudes, together of rms 1; what to
/// expect where they are too many.
fn noise((from, to): (f64, f64), length: f64, seed: u64) -> Result<Carrier, String> {
    let count = ((to - from) * length).round().max(1.0);
    if count > MAX_TONES {
        let longest = engineering(MAX_TONES / (to - from), "s", 3);
        return Err(format!("at most {longest} with this band"));
    }
    let mut stream = noise_stream(seed, 0, PHASE_STREAM);
    let tone = |place: u32| {
        let phase: f64 = StandardUniform.sample(&mut stream);
        [TAU * (from + (to - from) * (f64::from(place) + 0.5) / count), TAU * phase]
    };
    let tones: Arc<[[f64; 2]]> = (0..count as u32).map(tone).collect();
    Ok(Carrier::Noise(tones, (2.0 / count).sqrt()))
}

fn samples(table: &TableReader<'_>, node: &Node) -> Option<Arc<[f64]>> {
    let Value::List(items) = &node.value else {
        table.problem("samples", node.describe(), "a list of numbers, [0, 0.5, 1]");
        return None;
    };
    let number = |item: &Node| match &item.value {
        Value::Number { value, .. } if value.is_finite() => Some(*value),
        _ => {
            table.problem_at(&item.place, "samples", item.describe(), "a number".to_owned());
            None
        }
    };
    let values: Option<Vec<f64>> = items.iter().map(number).collect();
    let values = values.filter(|values| !values.is_empty());
    if items.is_empty() {
        table.problem("samples", "an empty list", "numbers, [0, 0.5, 1]");
    }
    values.map(Into::into)
}

/// Noise of the band `from` to `to` (Hz) over `length` (s), drawn from `seed`, as a signal.
///
/// # Errors
/// What to expect, in words, where that would be too many sines.
pub(super) fn noise_signal(band: (f64, f64), length: f64, seed: u64) -> Result<Signal, String> {
    Ok(Signal { carrier: noise(band, length, seed)?, length, edge: EDGE_SHARE * length })
}

/// A generator's samples from the text of a file: one value a line, or lines of time and value
/// behind any header; with the interval between them if the file has times (s).
///
/// # Errors
/// What is wrong with the text, in words.
pub(super) fn read_samples(text: &str) -> Result<(Vec<f64>, Option<f64>), String> {
    let numbers = |line: &str| -> Option<Vec<f64>> {
        let parts = line.split([',', ';', '\t', ' ']).filter(|part| !part.is_empty());
        parts.map(|part| part.parse().ok().filter(|value: &f64| value.is_finite())).collect()
    };
    let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let lines: Vec<(usize, &str)> = lines.skip_while(|(_, line)| numbers(line).is_none()).collect();
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for (number, line) in &lines {
        match numbers(line).as_deref() {
            Some([value]) => values.push(*value),
            Some([time, value]) => {
                times.push(*time);
                values.push(*value);
            }
            _ => return Err(format!("line {number}: \"{line}\"")),
        }
    }
    match times.as_slice() {
        [] if values.is_empty() => Err("no numbers".to_owned()),
        [] => Ok((values, None)),
        [first, .., last] if times.len() == values.len() => {
            let interval = (last - first) / (times.len() - 1) as f64;
            let is_even = |(place, time): (usize, &f64)| {
                (time - (first + place as f64 * interval)).abs() <= 0.01 * interval
            };
            let even = interval > 0.0 && times.iter().enumerate().all(is_even);
            if even {
                Ok((values, Some(interval)))
            } else {
                Err("times that are not evenly spaced".to_owned())
            }
        }
        _ => Err("lines with and without a time".to_owned()),
    }
}
