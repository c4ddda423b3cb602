//! Colours of channels and of the palette.

use ratatui::style::Color;

use crate::scope::Source;
use crate::tui::model::Palette;

/// The colour of a trace, as on the instrument's screen.
pub(in crate::tui) fn colour_of(palette: Palette, source: Source) -> Color {
    let wanted = match source {
        Source::Channel(1) => Color::Yellow,
        Source::Channel(2) => Color::Cyan,
        Source::Channel(3) => Color::Magenta,
        Source::Channel(4) => Color::Green,
        Source::Channel(_) | Source::Reference(_) => Color::White,
        Source::Math => Color::Red,
    };
    colour(palette, wanted)
}

/// `wanted`, or the terminal's own where there are to be no colours.
pub(in crate::tui) fn colour(palette: Palette, wanted: Color) -> Color {
    match palette {
        Palette::Colour => wanted,
        Palette::Plain => Color::Reset,
    }
}
