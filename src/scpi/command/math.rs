//! Math: `MATH`.

use crate::instrument::Event;
use crate::instrument::panel::MathFunction;
use crate::scope::model::nearest;
use crate::scpi::argument::text;
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, number};
use crate::scpi::value::ReplyValue;

/// Horizontal zooms of a spectrum (1).
const HORIZONTAL_ZOOMS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];
/// Vertical zooms of a spectrum (1).
const VERTICAL_ZOOMS: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 10.0];
/// Farthest vertical position of a spectrum (div).
const MAX_POSITION: f64 = 100.0;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Math",
    rows: &[
        CommandRow::acts("MATH", group(Parts::Below), "all settings of the math trace"),
        CommandRow::acts("MATH:DEFINE", both(define, definition), "e.g. `\"CH1 - CH2\"` or `\"FFT(CH1,HANNING)\"`"),
        CommandRow::acts("MATH:FFT", group(Parts::Below), "how the screen shows a spectrum"),
        CommandRow::acts(
            "MATH:FFT:HORizontal:POSition",
            number!(|at| at.instrument.panel.math.fft_horizontal_position, |_, _, percent| percent
                .clamp(0.0, 100.0)),
            "percent of the spectrum in the screen's centre",
        ),
        CommandRow::acts(
            "MATH:FFT:HORizontal:SCAle",
            number!(|at| at.instrument.panel.math.fft_horizontal_scale, |_, _, zoom| nearest(
                zoom,
                &HORIZONTAL_ZOOMS
            )),
            "zoom 1, 2, 5 or 10",
        ),
        CommandRow::acts(
            "MATH:FFT:VERtical:POSition",
            number!(|at| at.instrument.panel.math.fft_vertical_position, |_, _, divisions| {
                divisions.clamp(-MAX_POSITION, MAX_POSITION)
            }),
            "divisions",
        ),
        CommandRow::acts(
            "MATH:FFT:VERtical:SCAle",
            number!(|at| at.instrument.panel.math.fft_vertical_scale, |_, _, zoom| nearest(
                zoom,
                &VERTICAL_ZOOMS
            )),
            "zoom 0.5, 1, 2, 5 or 10",
        ),
    ],
};

fn define(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let function = MathFunction::parse(text(arguments)?, at.instrument.model.channels);
    at.instrument.panel.math.function = function.ok_or(Event::InvalidMath)?;
    Ok(())
}

fn definition(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Text(at.instrument.panel.math.function.definition()))
}
