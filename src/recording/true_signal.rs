//! Signals of a shot's ground truth, identified by the topics of their names.

use std::fmt;

use super::Shot;
use crate::trace::Trace;

/// Prefix of topics in a recording.
const PREFIX: &str = "/truth/";

/// What a trace of the ground truth is of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TrueSignal {
    /// The force at the sensor of this name: `sensor/<name>`.
    Force(String),
    /// The force in this contact, counted from 0 at the top: `contact/<j>`.
    Contact(usize),
    /// The displacement of this body: `bead/<i>`.
    Displacement(usize),
}

impl fmt::Display for TrueSignal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Force(sensor) => write!(f, "sensor/{sensor}"),
            Self::Contact(contact) => write!(f, "contact/{contact}"),
            Self::Displacement(body) => write!(f, "bead/{body}"),
        }
    }
}

impl TrueSignal {
    /// What `trace` is of; none for a name of another form.
    pub fn of(trace: &Trace) -> Option<Self> {
        let (kind, which) = topic(trace).split_once('/')?;
        match kind {
            "sensor" => Some(Self::Force(which.to_owned())),
            "contact" => Some(Self::Contact(which.parse().ok()?)),
            "bead" => Some(Self::Displacement(which.parse().ok()?)),
            _ => None,
        }
    }

    /// The sensor's name, if it is the force at one.
    pub fn sensor(&self) -> Option<&str> {
        match self {
            Self::Force(sensor) => Some(sensor),
            Self::Contact(_) | Self::Displacement(_) => None,
        }
    }
}

/// The topic in a trace's name: what stands before the colon, without the prefix that it has in a
/// file.
pub fn topic(trace: &Trace) -> &str {
    let name = trace.name.strip_prefix(PREFIX).unwrap_or(&trace.name);
    name.split_once(": ").map_or(name, |(topic, _)| topic)
}

impl Shot {
    /// A trace of the ground truth.
    pub fn true_signal(&self, signal: &TrueSignal) -> Option<&Trace> {
        self.truth.iter().find(|trace| TrueSignal::of(trace).as_ref() == Some(signal))
    }
}
