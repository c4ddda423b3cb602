//! Display: `DISplay`. Format and style show in the picture that `HARDCopy` sends; the rest is kept
//! and told.

use crate::instrument::word::words;
use crate::scpi::argument::{flag, real, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, place, word};
use crate::scpi::value::ReplyValue;

words! {
    /// Persistence that is not a time.
    Persistence {
        /// For good.
        Infinite = "INFinite",
        /// None.
        Off = "OFF",
    }
}

/// Persistences (s).
const PERSISTENCES: [f64; 4] = [0.0, 1.0, 2.0, 5.0];

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Display",
    rows: &[
        CommandRow::accepted("DISplay", group(Parts::Below), "all settings of the screen"),
        CommandRow::accepted("DISplay:CONTRast", place!(|at| at.instrument.panel.display.contrast, |a| whole(a, 1, 100), ReplyValue::integer), "1 to 100"),
        CommandRow::acts("DISplay:FORMat", word!(|at| at.instrument.panel.display.format), "`YT` or `XY`"),
        CommandRow::acts("DISplay:STYle", word!(|at| at.instrument.panel.display.style), "`DOTs` or `VECtors`"),
        CommandRow::accepted("DISplay:PERSistence", both(set_persistence, persistence), "`OFF`, 1, 2, 5 (seconds) or `INFinite`"),
        CommandRow::accepted(
            "DISplay:INVert",
            place!(|at| at.instrument.panel.display.inverted, flag, ReplyValue::on_or_off),
            "`ON` or `OFF`; pictures follow `HARDCopy:INKSaver`",
        )
        .apart(),
    ],
};

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

fn persistence(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let seconds = at.instrument.panel.display.persistence;
    Ok(if seconds.is_finite() {
        ReplyValue::Plain(format!("{seconds}"))
    } else {
        ReplyValue::Word("INFinite")
    })
}
