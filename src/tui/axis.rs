//! The screen's axes: the window in time, the vertical scale of a trace, and the steps of the
//! knobs.
//!
//! Pure arithmetic, no terminal. A screen has 10 divisions across and 8 up, as on the instrument;
//! positions are counted in divisions from the screen's centre, so that volts become divisions by
//! `division = volts / scale + position`.

use crate::scope::Waveform;
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// Presses of a position key that move by one division (1).
pub const PRESSES_PER_DIVISION: f64 = 2.0;
/// Divisions across the screen.
pub const DIVISIONS_ACROSS: u16 = 10;
/// Divisions from the screen's bottom to its top.
pub const DIVISIONS_UP: u16 = 8;

/// Half of the screen's width (div).
const HALF_WIDTH: f64 = 5.0;
/// Two scales nearer than this are the same; the steps' own round-off is far smaller (1).
const SCALE_TOLERANCE: f64 = 1e-6;
/// How far from the screen's centre zero volts may be moved (div).
const MAX_POSITION: f64 = 1000.0;
/// A record so many times longer than the screen it was taken on can be zoomed out further than
/// recorded (1).
const ZOOM_OUT_THRESHOLD: f64 = 1.02;
/// How many times the recorded V/div the screen may show (1).
const MAX_SCALE_FACTOR: f64 = 100.0;

/// An axis has fewer ticks than this (1).
const MOST_MULTIPLES: f64 = 100.0;

/// Which way a knob is turned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TurnDirection {
    /// To the smaller number: down, left, earlier, fewer units a division.
    Down,
    /// To the larger number: up, right, later, more units a division.
    Up,
}

impl TurnDirection {
    /// The other way.
    pub fn other(self) -> Self {
        match self {
            Self::Down => Self::Up,
            Self::Up => Self::Down,
        }
    }

    /// -1 for down, 1 for up (1).
    pub fn sign(self) -> f64 {
        match self {
            Self::Down => -1.0,
            Self::Up => 1.0,
        }
    }
}

/// The steps of a knob within a decade.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steps {
    /// 1-2-5, as V/div.
    OneTwoFive,
    /// 1-2.5-5, as s/div.
    OneTwoAndHalfFive,
}

impl Steps {
    fn mantissas(self) -> [&'static str; 3] {
        match self {
            Self::OneTwoFive => ["1", "2", "5"],
            Self::OneTwoAndHalfFive => ["1", "2.5", "5"],
        }
    }

    /// The steps around `value`, upward; each is the double nearest to its decimal number.
    fn around(self, value: f64) -> impl Iterator<Item = f64> {
        let exponent = value.log10().floor().clamp(-400.0, 400.0) as i32;
        (exponent - 1..=exponent + 1).flat_map(move |exponent| {
            self.mantissas()
                .into_iter()
                .filter_map(move |mantissa| format!("{mantissa}e{exponent}").parse().ok())
        })
    }

    /// The step next to `value` when the knob is turned; a `value` between two steps goes to the
    /// nearer end (unit).
    pub fn next(self, value: f64, turn: TurnDirection) -> f64 {
        let steps = self.around(value);
        match turn {
            TurnDirection::Up => {
                steps.into_iter().find(|step| *step > value * (1.0 + SCALE_TOLERANCE))
            }
            TurnDirection::Down => {
                steps.filter(|step| *step < value * (1.0 - SCALE_TOLERANCE)).last()
            }
        }
        .unwrap_or(value)
    }

    /// Multiples of the smallest step that is not below `spacing`, from `low` to `high`, each with
    /// its factor (unit).
    pub fn multiples(self, (low, high): (f64, f64), spacing: f64) -> Vec<(i64, f64)> {
        let step = self.at_least(spacing);
        let (first, last) =
            ((low / step - SCALE_TOLERANCE).ceil(), (high / step + SCALE_TOLERANCE).floor());
        if (last - first).abs() > MOST_MULTIPLES || !step.is_normal() {
            return Vec::new();
        }
        (first as i64..=last as i64).map(|factor| (factor, factor as f64 * step)).collect()
    }

    /// The smallest step that is not below `value` (unit).
    pub fn at_least(self, value: f64) -> f64 {
        self.around(value).find(|step| *step >= value * (1.0 - SCALE_TOLERANCE)).unwrap_or(value)
    }
}

/// The part of the abscissa that is on screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewWindow {
    /// Abscissa of the screen's centre (s; Hz for an FFT).
    pub centre: f64,
    /// Width of a division (s/div; Hz/div for an FFT).
    pub scale: f64,
}

impl ViewWindow {
    /// The window under which `waveform` was recorded: its whole record, unless its preamble says
    /// otherwise.
    pub fn recorded(waveform: &Waveform) -> Self {
        let (start, end) = extent(waveform);
        let half = waveform.codes.len() as f64 / 2.0;
        let centre = waveform.time(0) + waveform.preamble.x_incr * half;
        let width = (end - start) / f64::from(DIVISIONS_ACROSS);
        let scale = [waveform.horizontal_scale, width]
            .into_iter()
            .find(|scale| scale.is_normal() && *scale > 0.0)
            .unwrap_or(1.0);
        let centre = if centre.is_finite() { centre } else { 0.0 };
        Self { centre, scale }
    }

    /// Abscissa of the left edge (s; Hz for an FFT).
    pub fn left(&self) -> f64 {
        self.centre - HALF_WIDTH * self.scale
    }

    /// Abscissa of the right edge (s; Hz for an FFT).
    pub fn right(&self) -> f64 {
        self.centre + HALF_WIDTH * self.scale
    }

    /// Whether two windows show the same to within round-off.
    pub fn same_as(&self, other: &Self) -> bool {
        (self.scale / other.scale - 1.0).abs() < SCALE_TOLERANCE
            && ((self.centre - other.centre) / other.scale).abs() < SCALE_TOLERANCE
    }

    /// Finest and coarsest scale of a record (s/div; Hz/div for an FFT).
    fn scales(waveform: &Waveform) -> (f64, f64) {
        let (start, end) = extent(waveform);
        let steps = Steps::OneTwoAndHalfFive;
        let recorded = Self::recorded(waveform).scale;
        let span = (end - start) / f64::from(DIVISIONS_ACROSS);
        let coarsest =
            if span > recorded * ZOOM_OUT_THRESHOLD { steps.at_least(span) } else { recorded };
        let finest = steps.at_least(waveform.preamble.x_incr.abs());
        (if finest.is_normal() { finest.min(coarsest) } else { coarsest }, coarsest)
    }

    /// The window around `centre` with the next scale that is not below `scale`, as far as the
    /// record reaches. The centre is rounded to half divisions.
    pub fn around(waveform: &Waveform, centre: f64, scale: f64) -> Self {
        let (finest, coarsest) = Self::scales(waveform);
        let scale = Steps::OneTwoAndHalfFive.at_least(scale).clamp(finest, coarsest);
        let centre = (2.0 * centre / scale).round() * scale / 2.0;
        Self { centre, scale }.kept_inside(waveform)
    }

    /// This window after a turn of the s/div knob; what stands `anchor` divisions right of the
    /// centre stays there.
    pub fn zoomed(self, waveform: &Waveform, turn: TurnDirection, anchor: f64) -> Self {
        let (finest, coarsest) = Self::scales(waveform);
        let scale = Steps::OneTwoAndHalfFive.next(self.scale, turn).clamp(finest, coarsest);
        let scale = if scale.is_normal() { scale } else { self.scale };
        let centre = self.centre + anchor * (self.scale - scale);
        Self { centre, scale }.kept_inside(waveform)
    }

    /// This window moved by `divisions` to later abscissae, as far as the record reaches.
    pub fn panned(self, waveform: &Waveform, divisions: f64) -> Self {
        let centre = self.centre + divisions * self.scale;
        Self { centre, ..self }.kept_inside(waveform)
    }

    /// Keeps the screen on what was recorded.
    fn kept_inside(self, waveform: &Waveform) -> Self {
        let home = Self::recorded(waveform);
        let (start, end) = extent(waveform);
        let first = start.min(home.left()) + HALF_WIDTH * self.scale;
        let last = end.max(home.right()) - HALF_WIDTH * self.scale;
        let centre =
            if first < last { self.centre.clamp(first, last) } else { f64::midpoint(first, last) };
        let kept = Self { centre, ..self };
        if kept.same_as(&home) || !centre.is_finite() { home } else { kept }
    }
}

/// Abscissae of the record's two ends, the smaller first.
pub(super) fn extent(waveform: &Waveform) -> (f64, f64) {
    let first = waveform.time(0);
    let last = waveform.time(waveform.codes.len().saturating_sub(1));
    (first.min(last), first.max(last))
}

/// How a trace stands on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertical {
    /// Vertical scale (V/div; dB/div for an FFT).
    pub scale: f64,
    /// Where zero stands, upward from the screen's centre (div).
    pub position: f64,
}

impl Vertical {
    /// The setting under which `waveform` was recorded.
    ///
    /// A spectrum has no zero on the screen to speak of: its level 0 stands in the centre.
    pub fn recorded(waveform: &Waveform) -> Self {
        let setup = &waveform.vertical;
        let scale = [setup.scale, waveform.preamble.y_mult * LEVELS_PER_DIVISION]
            .into_iter()
            .find(|scale| scale.is_normal() && *scale > 0.0)
            .unwrap_or(1.0);
        let position =
            if is_spectrum(waveform) { -waveform.volts_of(0) / scale } else { setup.position };
        let position = if position.is_finite() { position } else { 0.0 };
        Self { scale, position }
    }

    /// The scale after a turn of the V/div knob, between one level a division and 100 times the
    /// recorded scale (V/div).
    pub fn turned(self, waveform: &Waveform, turn: TurnDirection) -> f64 {
        let steps = Steps::OneTwoFive;
        let recorded = Self::recorded(waveform).scale;
        let coarsest = steps.at_least(recorded * MAX_SCALE_FACTOR);
        let finest = steps.at_least((waveform.preamble.y_mult.abs()).min(recorded));
        let finest = if finest > 0.0 { finest } else { recorded };
        let next = steps.next(self.scale, turn).clamp(finest, coarsest);
        // A scale between two steps is found again on the way back.
        let between = (recorded - self.scale) * (recorded - next) < 0.0;
        if between || !next.is_normal() { recorded } else { next }
    }

    /// The position after moving the trace up by `divisions` (div).
    pub fn moved(self, divisions: f64) -> f64 {
        let reach = MAX_POSITION.max(self.position.abs());
        (self.position + divisions).clamp(-reach, reach)
    }

    /// Whether two settings show the same to within round-off.
    pub fn same_as(&self, other: &Self) -> bool {
        (self.scale / other.scale - 1.0).abs() < SCALE_TOLERANCE
            && (self.position - other.position).abs() < SCALE_TOLERANCE
    }
}

/// Whether a waveform is an FFT, with frequencies along the abscissa.
pub fn is_spectrum(waveform: &Waveform) -> bool {
    waveform.preamble.x_unit.eq_ignore_ascii_case("hz")
}
