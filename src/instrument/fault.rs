//! Faults on demand, for trying lab programs: of replies, of the trigger, and of the sensors.
//!
//! Written as `KIND[@CHn][=VALUE][*COUNT]`, e.g. `noisy@CH2=50mV*1`: a sensor's fault may name one
//! channel, and COUNT ends a fault after so many replies or impacts. Random numbers come from the
//! seed of the instrument, so that the same faults do the same. Replies to `BENCh` commands are
//! left alone: they are not the instrument's.

use std::str::FromStr;

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

use super::record::Signals;
use crate::quantity::{Dimension, engineering, parse};

/// Stream of the random numbers of replies; those of a channel and shot are below.
const REPLIES: u128 = 1 << 64;

/// Longest delay of a reply or a signal, a day (s).
const MAX_DELAY: f64 = 86_400.0;
/// Largest voltage of a sensor's fault (V).
const MAX_VOLTAGE: f64 = 1e6;

/// How the kinds are written, and what each does.
pub const KINDS: &[(&str, &str)] = &[
    ("late=TIME", "replies are delayed by this time"),
    ("cut=BYTES", "replies end after this many bytes, without a line end"),
    ("garbled=SHARE", "this share of a reply's bytes is wrong, at least one, never the last"),
    ("missing", "replies are not sent"),
    ("dropped=BYTES", "the connection is closed after this many bytes of a longer reply"),
    ("identity=TEXT", "*IDN? and ID? answer this"),
    ("no-trigger", "impacts do not trigger the scope"),
    ("clipped=VOLTAGE", "the sensor's signal is clipped at plus and minus this voltage"),
    ("noisy=VOLTAGE", "normal noise of this rms value is added to the sensor's signal"),
    ("drifting=V/s", "the sensor's signal drifts, from zero at the impact"),
    ("dead", "the sensor's signal is zero"),
    ("second=TIME", "the signal is added a second time, delayed by this time"),
];

#[derive(Debug, Clone, PartialEq)]
enum FaultKind {
    Late(f64),
    Cut(usize),
    Garbled(f64),
    Missing,
    Dropped(usize),
    Identity(String),
    NoTrigger,
    Clipped(f64),
    Noisy(f64),
    Drifting(f64),
    Dead,
    Second(f64),
}

/// A fault.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// As it was written.
    text: String,
    kind: FaultKind,
    /// The channel whose sensor it is; none for all.
    channel: Option<u8>,
    /// How many replies or impacts are left; none for all.
    left: Option<u32>,
}

/// What is wrong with a fault as written.
#[derive(Debug, thiserror::Error)]
#[error("found \"{text}\": {reason}")]
pub struct FaultError {
    text: String,
    reason: String,
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let text = text.trim();
        read(text).map_err(|reason| FaultError { text: text.to_owned(), reason })
    }
}

fn read(text: &str) -> Result<Fault, String> {
    let counted = text.rsplit_once('*').and_then(|(rest, count)| Some((rest, count.parse().ok()?)));
    let (rest, left) = counted.map_or((text, None), |(rest, count)| (rest, Some(count)));
    let (name, value) = match rest.split_once('=') {
        Some((name, value)) => (name, Some(value.trim())),
        None => (rest, None),
    };
    let (name, channel) = match name.split_once('@') {
        Some((name, channel)) => (name, Some(channel.trim().to_ascii_uppercase())),
        None => (name, None),
    };
    let known = |(form, _): &&(&str, &str)| form.split('=').next() == Some(name.trim());
    let Some((form, _)) = KINDS.iter().find(known) else {
        let forms: Vec<&str> = KINDS.iter().map(|(form, _)| *form).collect();
        return Err(format!("expected one of {}", forms.join(", ")));
    };
    if form.contains('=') != value.is_some() {
        return Err(format!("expected {form}"));
    }
    let value = value.unwrap_or_default();
    let number = |dimension: Dimension| {
        let example = dimension.example().unwrap_or("1 %");
        parse(value, dimension)
            .map_err(|error| format!("{error}; expected {form}, e.g. {}={example}", name.trim()))
    };
    let above_zero = |dimension: Dimension, most: f64| match number(dimension)? {
        value if value > 0.0 && value <= most => Ok(value),
        value if value > most => {
            let unit = dimension.unit();
            let most = engineering(most, if unit == "1" { "" } else { &unit }, 3);
            Err(format!("expected {form} up to {most}"))
        }
        _ => Err(format!("expected {form} above zero")),
    };
    let bytes = || value.parse().map_err(|_| format!("expected {form}"));
    let kind = match name.trim() {
        "late" => FaultKind::Late(above_zero(Dimension::TIME, MAX_DELAY)?),
        "cut" => FaultKind::Cut(bytes()?),
        "garbled" => FaultKind::Garbled(above_zero(Dimension::NONE, 1.0)?),
        "missing" => FaultKind::Missing,
        "dropped" => FaultKind::Dropped(bytes()?),
        "identity" => FaultKind::Identity(value.to_owned()),
        "no-trigger" => FaultKind::NoTrigger,
        "clipped" => FaultKind::Clipped(above_zero(Dimension::VOLTAGE, MAX_VOLTAGE)?),
        "noisy" => FaultKind::Noisy(above_zero(Dimension::VOLTAGE, MAX_VOLTAGE)?),
        "drifting" => FaultKind::Drifting(number(Dimension::VOLTAGE_PER_TIME)?),
        "second" => FaultKind::Second(above_zero(Dimension::TIME, MAX_DELAY)?),
        _ => FaultKind::Dead,
    };
    let channel = match channel.as_deref().map(|name| name.strip_prefix("CH")?.parse().ok()) {
        None => None,
        Some(Some(number @ 1..=4)) if kind.is_of_sensor() => Some(number),
        Some(_) if kind.is_of_sensor() => return Err("expected a channel, @CH1 to @CH4".to_owned()),
        Some(_) => return Err("only a sensor's fault has a channel".to_owned()),
    };
    if left == Some(0) {
        return Err("expected a count above zero".to_owned());
    }
    Ok(Fault { text: text.to_owned(), kind, channel, left })
}

impl FaultKind {
    fn is_of_sensor(&self) -> bool {
        matches!(
            self,
            Self::Clipped(_) | Self::Noisy(_) | Self::Drifting(_) | Self::Dead | Self::Second(_)
        )
    }
}

/// What becomes of a reply besides its bytes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReplyFault {
    /// How much later it comes (s).
    pub delay: Option<f64>,
    /// Bytes after which the connection is closed.
    pub drop_after: Option<usize>,
}

/// The faults that act at present.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faults {
    active: Vec<Fault>,
    /// Replies that were disturbed.
    replies: u64,
}

impl Faults {
    /// Adds a fault; it takes the place of one of the same kind and channel.
    pub fn add(&mut self, fault: Fault) {
        let same = |other: &Fault| {
            std::mem::discriminant(&other.kind) == std::mem::discriminant(&fault.kind)
                && other.channel == fault.channel
        };
        self.active.retain(|other| !same(other));
        self.active.push(fault);
    }

    /// Ends all faults.
    pub fn clear(&mut self) {
        self.active.clear();
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.active.is_empty()
    }

    /// All of them as they were written.
    pub fn text(&self) -> String {
        let texts: Vec<&str> = self.active.iter().map(|fault| fault.text.as_str()).collect();
        texts.join(", ")
    }

    /// Another answer to `*IDN?`.
    pub fn identity(&self) -> Option<&str> {
        self.active.iter().find_map(|fault| match &fault.kind {
            FaultKind::Identity(text) => Some(text.as_str()),
            _ => None,
        })
    }

    /// Disturbs a reply; a fault that leaves it as it is does not count.
    pub fn disturb_reply(&mut self, reply: &mut Vec<u8>, seed: u64) -> ReplyFault {
        let mut found = ReplyFault::default();
        self.replies += 1;
        let mut numbers = Pcg64::new(u128::from(seed), REPLIES | u128::from(self.replies));
        for fault in &mut self.active {
            let acts = match fault.kind {
                FaultKind::Late(delay) => found.delay.replace(delay).is_none(),
                FaultKind::Cut(length) if length < reply.len() => {
                    reply.truncate(length);
                    true
                }
                FaultKind::Garbled(share) => garble(reply, share, &mut numbers),
                FaultKind::Missing => {
                    reply.clear();
                    true
                }
                FaultKind::Dropped(length) if length < reply.len() => {
                    found.drop_after = Some(length);
                    true
                }
                _ => false,
            };
            fault.count(acts);
        }
        self.active.retain(|fault| fault.left != Some(0));
        found
    }

    /// The faults that act on the next impact.
    pub fn of_impact(&self) -> Vec<Fault> {
        self.active.iter().filter(|fault| fault.is_of_impact()).cloned().collect()
    }

    /// The next impact has come.
    pub fn count_impact(&mut self) {
        self.active.iter_mut().for_each(|fault| fault.count(fault.is_of_impact()));
        self.active.retain(|fault| fault.left != Some(0));
    }
}

/// Makes bytes wrong, at least one, but not the last one. Whether there are any.
fn garble(reply: &mut [u8], share: f64, numbers: &mut Pcg64) -> bool {
    let Some((_, bytes @ [_, ..])) = reply.split_last_mut() else { return false };
    let mut draw = || -> f64 { StandardUniform.sample(numbers) };
    let first = (draw() * bytes.len() as f64) as usize;
    for (index, byte) in bytes.iter_mut().enumerate() {
        if index == first || draw() < share {
            *byte ^= 1 + (draw() * 255.0) as u8;
        }
    }
    true
}

impl Fault {
    fn count(&mut self, acts: bool) {
        if let Some(left) = self.left.as_mut().filter(|_| acts) {
            *left -= 1;
        }
    }

    fn is_of_impact(&self) -> bool {
        self.kind == FaultKind::NoTrigger || self.kind.is_of_sensor()
    }

    /// Whether the impact is one that the scope does not trigger on.
    pub fn hides_impact(&self) -> bool {
        self.kind == FaultKind::NoTrigger
    }

    /// Disturbs the signals of an impact.
    pub fn disturb(&self, signals: &mut Signals, seed: u64) {
        let (interval, contact) = (signals.interval, signals.automatic as f64);
        for (number, volts) in (1..).zip(&mut signals.volts) {
            if self.channel.is_some_and(|channel| channel != number) {
                continue;
            }
            match self.kind {
                FaultKind::Clipped(limit) => {
                    for value in volts {
                        *value = value.clamp(-limit, limit);
                    }
                }
                FaultKind::Noisy(rms) => {
                    // Not the stream of the scope's own noise, which counts channels from 1.
                    let stream = (u128::from(signals.shot) << 8) | (1 << 7) | u128::from(number);
                    let mut numbers = Pcg64::new(u128::from(seed), stream);
                    for value in volts {
                        let draw: f64 = StandardNormal.sample(&mut numbers);
                        *value += rms * draw;
                    }
                }
                FaultKind::Drifting(rate) => {
                    for (index, value) in volts.iter_mut().enumerate() {
                        *value += rate * interval * (index as f64 - contact);
                    }
                }
                FaultKind::Dead => volts.fill(0.0),
                FaultKind::Second(delay) => {
                    let shift = (delay / interval).round() as usize;
                    for index in (shift..volts.len()).rev() {
                        let first = volts.get(index - shift).copied().unwrap_or_default();
                        if let Some(value) = volts.get_mut(index) {
                            *value += first;
                        }
                    }
                }
                _ => {}
            }
        }
    }
}
