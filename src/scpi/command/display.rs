//! Display: `DISplay`. Format and style show in the picture that `HARDCopy` sends; the rest is kept and told.

use crate::instrument::word::words;
use crate::scpi::argument::{real, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Both, Context, GroupQuery, Parts, Stop, Words};
use crate::scpi::value::Value;

words! {
    /// Persistence that is no time.
    Persistence {
        /// For good.
        Infinite = "INFinite",
        /// None.
        Off = "OFF",
    }
}

/// Persistences (s).
const PERSISTENCES: [f64; 4] = [0.0, 1.0, 2.0, 5.0];

/// The group.
pub const GROUP: Group = Group {
    title: "Display",
    rows: &[
        Row::accepted("DISplay", &GroupQuery(Parts::Below), "all settings of the screen"),
        Row::accepted(
            "DISplay:CONTRast",
            &Both(set_contrast, |at| {
                Ok(Value::Integer(i64::from(at.instrument.panel.display.contrast)))
            }),
            "1 to 100",
        ),
        Row::acts("DISplay:FORMat", &Words(|i, _| &mut i.panel.display.format), "`YT` or `XY`"),
        Row::acts(
            "DISplay:STYle",
            &Words(|i, _| &mut i.panel.display.style),
            "`DOTs` or `VECtors`",
        ),
        Row::accepted(
            "DISplay:PERSistence",
            &Both(set_persistence, persistence),
            "`OFF`, 1, 2, 5 (seconds) or `INFinite`",
        ),
    ],
};

fn set_contrast(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.panel.display.contrast = whole(arguments, 1, 100)?;
    Ok(())
}

fn set_persistence(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let distance = |asked: f64, choice: f64| (asked - choice).abs();
    let nearest = |asked: f64| {
        let choices = PERSISTENCES.iter().copied();
        choices.min_by(|a, b| distance(asked, *a).total_cmp(&distance(asked, *b))).unwrap_or(0.0)
    };
    at.instrument.panel.display.persistence = match real(arguments) {
        Ok(seconds) => nearest(seconds),
        Err(_) => match word(arguments)? {
            Persistence::Infinite => f64::INFINITY,
            Persistence::Off => 0.0,
        },
    };
    Ok(())
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn persistence(at: &mut Context<'_>) -> Result<Value, Stop> {
    let seconds = at.instrument.panel.display.persistence;
    Ok(if seconds.is_finite() {
        Value::Plain(format!("{seconds}"))
    } else {
        Value::Word("INFinite")
    })
}
