//! The front panel as text: what the instrument answers to `SET?` and saves as a `.SET` file.
//!
//! Source: programmer manual 071-1075, `SET?`; order and spelling after files saved by instruments
//! of this family.

use std::fmt::Write as _;

use super::setup::Setup;
use super::waveform::{Coupling, PointFormat, Source, Waveform};
use super::word::Word as _;

/// A number as the instrument writes it (NR3): shortest mantissa with at least one decimal,
/// `5.0E-1`, `1.0E0`.
pub fn nr3(value: f64) -> String {
    let text = format!("{value:E}");
    match text.split_once('E') {
        Some((mantissa, exponent)) if !mantissa.contains('.') => format!("{mantissa}.0E{exponent}"),
        _ => text,
    }
}

/// What a waveform is in words, `WFId`:
/// `Ch1, DC coupling, 5.0E-1 V/div, 5.0E-2 s/div, 2500 points, Sample mode`; a coupling that is not
/// known is left out. `number` writes scales, `mode` is how samples were taken.
pub fn waveform_id(waveform: &Waveform, number: fn(f64) -> String, mode: &str) -> String {
    let name = match waveform.source {
        Source::Channel(number) => format!("Ch{number}"),
        Source::Math => "Math".to_owned(),
        Source::Reference(letter) => format!("Ref{letter}"),
    };
    let coupling = waveform.vertical.coupling.map(|c| format!(", {c} coupling"));
    let mode = match waveform.preamble.pt_fmt {
        PointFormat::Envelope => "Peak Detect",
        PointFormat::Sample => mode,
    };
    format!(
        "{name}{}, {} {}/div, {} {}/div, {} points, {mode} mode",
        coupling.unwrap_or_default(),
        number(waveform.vertical.scale),
        waveform.preamble.y_unit,
        number(waveform.horizontal_scale),
        waveform.preamble.x_unit,
        waveform.codes.len(),
    )
}

/// The settings that this program models, in the order of a `.SET` file.
pub fn set_up_text(setup: &Setup) -> String {
    let on_off = |flag: bool| if flag { "ON" } else { "OFF" };
    let word = |word: &str| word.to_ascii_uppercase();
    let mode = word(setup.acquisition.mode.word());
    let averages = setup.acquisition.averages;
    let mut text = format!(":ACQUIRE:MODE {mode};NUMAVG {averages};STATE 0;STOPAFTER SEQUENCE");
    let mut select = String::new();
    for (number, channel) in (1..).zip(&setup.channels) {
        let on = u8::from(channel.is_some());
        let _ = write!(select, "{}CH{number} {on}", if number == 1 { "" } else { ";" });
        let Some(channel) = channel else { continue };
        let vertical = &channel.vertical;
        let _ = write!(
            text,
            ";:CH{number}:PROBE {};SCALE {};POSITION {};COUPLING {};BANDWIDTH {};INVERT {}",
            vertical.probe,
            nr3(vertical.scale),
            nr3(vertical.position),
            vertical.coupling.unwrap_or(Coupling::Dc),
            on_off(vertical.bandwidth_limited == Some(true)),
            on_off(vertical.inverted == Some(true)),
        );
    }
    let trigger = &setup.trigger;
    let mode = word(trigger.mode.word());
    let (slope, coupling) = (word(trigger.slope.word()), word(trigger.coupling.word()));
    let _ = write!(
        text,
        ";:HORIZONTAL:VIEW MAIN;MAIN:SCALE {};POSITION {};:TRIGGER:MAIN:MODE {mode};TYPE EDGE;\
         :TRIGGER:MAIN:EDGE:SOURCE {};COUPLING {coupling};SLOPE {slope};:TRIGGER:MAIN:LEVEL {};:SELECT:{select}",
        nr3(setup.time_base),
        nr3(setup.horizontal_position),
        trigger.source,
        nr3(trigger.level),
    );
    text
}

#[cfg(test)]
mod tests {
    use super::nr3;

    /// Spellings taken from replies of real instruments.
    #[test]
    fn numbers_look_as_on_the_instrument() {
        for (value, text) in [
            (0.5, "5.0E-1"),
            (1.0, "1.0E0"),
            (4.56, "4.56E0"),
            (5e-7, "5.0E-7"),
            (-166.0, "-1.66E2"),
            (1e-11, "1.0E-11"),
            (0.0, "0.0E0"),
            (7.8125e-5, "7.8125E-5"),
        ] {
            assert_eq!(nr3(value), text);
        }
    }
}
