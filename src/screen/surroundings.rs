//! Draws the surroundings of the graticule: status above, scales below, the menu beside it.

use embedded_graphics::Drawable as _;
use embedded_graphics::geometry::{Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_6X10;
use embedded_graphics::primitives::{Primitive as _, PrimitiveStyle, Rectangle};
use embedded_graphics::text::{Baseline, Text};

use super::content::type_name;
use super::picture::{Ink, Picture};
use super::readout::readout;
use super::strokes::{CENTRE, CORNER, SPAN, dots, line, text, text_to};
use super::{Screen, TriggerReadout};
use crate::scope::{Slope, Source, TriggerSource, Waveform};

/// Left edge of the menu.
const MENU: i32 = 267;
/// Upper edges of the two lines below the graticule.
const LINES: [i32; 2] = [220, 230];

/// Status, place of the trigger, position.
pub fn above(picture: &mut Picture, screen: &Screen) {
    let style = MonoTextStyle::new(&FONT_6X10, Ink::Text);
    let name = Text::with_baseline("Tek", Point::new(CORNER.0, 2), style, Baseline::Top);
    let Ok(_) = name.draw(picture);
    text(picture, (44, 3), &screen.status, Ink::Text);
    let position = format!("M Pos: {}", readout(screen.position, "s"));
    text_to(picture, (CORNER.0 + SPAN.0, 3), &position, Ink::Text);
    let width = 10.0 * screen.window.unwrap_or(screen.time_base);
    let share = if width > 0.0 { 0.5 - screen.position / width } else { return };
    let x = CORNER.0 + dots(share.clamp(0.0, 1.0) * f64::from(SPAN.0));
    for step in 0..4 {
        line(picture, (x - 3 + step, 13 + step), (x + 3 - step, 13 + step), Ink::Bar);
    }
}

/// Scales, time base, trigger.
pub fn below(picture: &mut Picture, screen: &Screen) {
    for waveform in &screen.traces {
        let unit = &waveform.preamble.y_unit;
        let scale = match unit.as_str() {
            "dB" => readout(10.0 / screen.zoom.up, unit),
            _ => readout(waveform.vertical.scale, unit),
        };
        let words = format!("{} {scale}", waveform.source);
        let place = match waveform.source {
            Source::Channel(1) => (2, LINES[0]),
            Source::Channel(2) => (68, LINES[0]),
            Source::Channel(3) => (2, LINES[1]),
            Source::Channel(_) => (68, LINES[1]),
            Source::Math => (CORNER.0 + 3, CORNER.1 + 2),
            Source::Reference(letter) => {
                let row = "ABCD".find(letter).and_then(|row| i32::try_from(row).ok()).unwrap_or(0);
                (CORNER.0 + 3, CORNER.1 + 12 + 9 * row)
            }
        };
        let mut words = words;
        if matches!(waveform.source, Source::Math | Source::Reference(_)) {
            let unit = &waveform.preamble.x_unit;
            let across = if unit == "Hz" { screen.zoom.across } else { 1.0 };
            words.push(' ');
            words.push_str(&readout(waveform.horizontal_scale / across, unit));
        }
        text(picture, place, &words, Ink::of(waveform.source));
    }
    if screen.time_base > 0.0 {
        text(picture, (136, LINES[0]), &format!("M {}", readout(screen.time_base, "s")), Ink::Text);
    }
    if let Some(window) = screen.window {
        text(picture, (136, LINES[1]), &format!("W {}", readout(window, "s")), Ink::Text);
    }
    if let Some(readout) = &screen.trigger {
        trigger(picture, readout, &screen.traces);
    }
}

/// Source, edge and level below the graticule, and an arrow at the level.
fn trigger(picture: &mut Picture, trigger: &TriggerReadout, traces: &[Waveform]) {
    let source = trigger.source.channel().map(Source::Channel);
    let ink = source.map_or(Ink::Text, Ink::of);
    let (x, y) = (204, LINES[0]);
    let name = match trigger.source {
        TriggerSource::External => "Ext".to_owned(),
        TriggerSource::External5 => "Ext/5".to_owned(),
        TriggerSource::Line => "AC Line".to_owned(),
        TriggerSource::Channel(number) => format!("CH{number}"),
    };
    text(picture, (x, y), &name, ink);
    let after = x + 5 * i32::try_from(name.len()).unwrap_or(0) + 4;
    if let Some(kind) = trigger.other {
        text(picture, (after, y), type_name(kind), ink);
    } else {
        let (start, end) = match trigger.slope {
            Slope::Rise => (y + 6, y),
            Slope::Fall => (y, y + 6),
        };
        line(picture, (after, start), (after + 3, start), ink);
        line(picture, (after + 3, start), (after + 3, end), ink);
        line(picture, (after + 3, end), (after + 6, end), ink);
    }
    if trigger.source != TriggerSource::Line {
        text_to(picture, (319, y), &readout(trigger.level, "V"), ink);
    }
    let Some(watched) = traces.iter().find(|trace| Some(trace.source) == source) else { return };
    let y = (CENTRE - dots(watched.height_of(trigger.level)))
        .clamp(CORNER.1 + 3, CORNER.1 + SPAN.1 - 3);
    for step in 0..4 {
        let x = CORNER.0 + SPAN.0 + 2 + step;
        line(picture, (x, y - step), (x, y + step), ink);
    }
}

/// Title and entries beside the graticule.
pub fn menu(picture: &mut Picture, entries: &[[String; 2]]) {
    let middle = |words: &str| {
        let letters = i32::try_from(words.chars().count()).unwrap_or(0);
        MENU + (321 - MENU - 5 * letters) / 2
    };
    let mut top = CORNER.1 - 16;
    for (index, [name, value]) in entries.iter().enumerate() {
        if index == 0 {
            let title = Rectangle::new(Point::new(MENU, top), Size::new(53, 12));
            let Ok(()) = title.into_styled(PrimitiveStyle::with_fill(Ink::Menu)).draw(picture);
            text(picture, (middle(name), top + 2), name, Ink::Text);
            top += 16;
            continue;
        }
        text(picture, (middle(name), top + 8), name, Ink::Text);
        text(picture, (middle(value), top + 19), value, Ink::Text);
        top += SPAN.1 / 5;
        line(picture, (MENU, top - 1), (319, top - 1), Ink::Graticule);
    }
    if !entries.is_empty() {
        line(picture, (MENU, 0), (MENU, CORNER.1 + SPAN.1 - 1), Ink::Graticule);
    }
}
