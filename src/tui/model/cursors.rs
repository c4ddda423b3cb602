//! The pair of cursors: put, moved, snapped, and what they tell.

use super::screen_state::ScreenState;
use super::state::{CursorKind, PlacedCursor, ordinate_unit, value_at};
use crate::scope::Waveform;
use crate::tui::axis::{DIVISIONS_ACROSS, DIVISIONS_UP, TurnDirection};
use crate::tui::job::{Job, Queue};

/// A cursor's step (div).
const CURSOR_STEP: f64 = 0.05;
/// Where the pair stands at first, from the centre (div).
const FIRST_CURSOR_POSITION: f64 = 2.0;
/// Two places nearer than this are one (div).
const POSITION_TOLERANCE: f64 = 1e-6;

/// Readings of the pair of cursors.
#[derive(Debug, Clone, PartialEq)]
pub struct CursorReading {
    /// Where they stand: abscissae, or ordinates (unit).
    pub at: [f64; 2],
    /// Second less first (unit).
    pub difference: f64,
    /// Unit of both.
    pub unit: String,
    /// One over the difference of two times (Hz).
    pub rate: Option<f64>,
    /// Values of the traces under cursors over time, and their unit (unit).
    pub values: [Option<f64>; 2],
    /// Unit of the values.
    pub value_unit: String,
    /// Distance of the two traces' sensors over the time between the cursors (m/s).
    pub speed: Option<f64>,
}

impl ScreenState {
    /// The next kind of cursors.
    pub(super) fn next_cursors(&mut self) {
        self.cursors.kind = match self.cursors.kind {
            CursorKind::Off => CursorKind::Time,
            CursorKind::Time => CursorKind::Volts,
            CursorKind::Volts => CursorKind::Off,
        };
        self.cursors.pair = None;
        self.place_cursors();
    }

    /// Puts both where they are seen, unless they stand somewhere.
    pub(super) fn place_cursors(&mut self) {
        let (Some(source), None) = (self.selected, self.cursors.pair) else { return };
        let Some(place) = self.place_of([-FIRST_CURSOR_POSITION, FIRST_CURSOR_POSITION]) else {
            return;
        };
        self.cursors.pair = Some(place.map(|at| PlacedCursor { at, source }));
    }

    /// Abscissae or ordinates of two places, counted in divisions from the centre.
    fn place_of(&self, divisions: [f64; 2]) -> Option<[f64; 2]> {
        let window = self.window()?;
        let vertical = self.vertical(&self.selected()?.waveform);
        match self.cursors.kind {
            CursorKind::Off => None,
            CursorKind::Time => Some(divisions.map(|d| window.centre + d * window.scale)),
            CursorKind::Volts => Some(divisions.map(|d| (d - vertical.position) * vertical.scale)),
        }
    }

    /// One division along the cursors' axis (unit).
    fn cursor_division(&self) -> Option<f64> {
        let [zero, one] = self.place_of([0.0, 1.0])?;
        Some(one - zero)
    }

    /// Moves the active cursor to `at`, on the selected trace.
    fn put_cursor(&mut self, at: f64) {
        self.place_cursors();
        let (Some(pair), Some(source)) = (&mut self.cursors.pair, self.selected) else { return };
        if let Some(cursor) = pair.get_mut(self.cursors.active) {
            *cursor = PlacedCursor { at, source };
        }
    }

    fn active_cursor(&self) -> Option<PlacedCursor> {
        self.cursors.pair?.get(self.cursors.active).copied()
    }

    /// A step of the active cursor.
    pub(super) fn move_cursor(&mut self, turn: TurnDirection) {
        match (self.active_cursor(), self.cursor_division()) {
            (Some(cursor), Some(division)) => {
                self.put_cursor(cursor.at + turn.sign() * CURSOR_STEP * division);
            }
            _ => self.notice = Some("no cursors on screen: c shows them".to_owned()),
        }
    }

    /// Moves the active cursor to the next peak or edge of the selected trace.
    pub(super) fn snap_cursor(&mut self, turn: TurnDirection) {
        let (Some(cursor), Some(division)) = (self.active_cursor(), self.cursor_division()) else {
            self.notice = Some("no cursors on screen: c shows them".to_owned());
            return;
        };
        let Some(capture) = self.selected() else { return };
        let waveform = capture.waveform.clone();
        let is_volts = self.cursors.kind == CursorKind::Volts;
        let apart = POSITION_TOLERANCE * division;
        self.move_to_found(cursor, "no further peak or edge in this direction", move || {
            let mut places = features(&waveform);
            if is_volts {
                places = places.into_iter().filter_map(|at| value_at(&waveform, at)).collect();
                places.sort_by(f64::total_cmp);
            }
            match turn {
                TurnDirection::Up => places.into_iter().find(|at| *at > cursor.at + apart),
                TurnDirection::Down => places.into_iter().rev().find(|at| *at < cursor.at - apart),
            }
        });
    }

    /// Moves the active cursor to the place that `find` finds on a thread, unless it was moved
    /// meanwhile; without a place shows the notice `nothing`.
    fn move_to_found(
        &mut self,
        from: PlacedCursor,
        nothing: &'static str,
        find: impl FnOnce() -> Option<f64> + Send + 'static,
    ) {
        self.ask(Job::new(
            Queue::Key,
            move |_| Ok(find()),
            move |model: &mut Self, found: Result<Option<f64>, String>| match found {
                Ok(Some(at)) if model.active_cursor() == Some(from) => model.put_cursor(at),
                Ok(Some(_)) => {}
                Ok(None) => model.notice = Some(nothing.to_owned()),
                Err(problem) => model.notice = Some(problem),
            },
        ));
    }

    /// Puts the active cursor at the arrival of the first pulse in the selected trace.
    pub(super) fn snap_to_arrival(&mut self) {
        let cursor = self.active_cursor().filter(|_| self.cursors.kind == CursorKind::Time);
        let Some(cursor) = cursor else {
            self.notice = Some("no cursors over time on screen: c shows them".to_owned());
            return;
        };
        let Some(survey) = self.survey_job() else { return };
        let name = self.selected().map(|capture| capture.waveform.source.to_string());
        self.move_to_found(cursor, "found no first pulse in this trace", move || {
            let survey = survey();
            let channel = survey.channels.iter().find(|c| Some(&c.channel) == name.as_ref())?;
            let half = channel.arrivals.iter().find(|arrival| arrival.estimator == "half_rise")?;
            Some(half.time_s?.value)
        });
    }

    /// The button went down at a place counted in divisions from the centre: takes hold of the
    /// nearer cursor, or of the picture.
    pub(super) fn press_at(&mut self, x: f64, y: f64) {
        if self.page.is_some() {
            self.grip = None;
            return;
        }
        self.grip = Some((x, y));
        if let (Some(pair), Some([at, _])) = (self.cursors.pair, self.place_of(self.along(x, y))) {
            let distance = pair.map(|cursor| (cursor.at - at).abs());
            self.cursors.active = usize::from(distance[1] < distance[0]);
            self.put_cursor(at);
        }
    }

    /// The mouse moves with its button down: a cursor goes along, or else the picture.
    pub(super) fn drag_to(&mut self, x: f64, y: f64) {
        let Some((from_x, from_y)) = self.grip.replace((x, y)) else { return };
        if let (Some(_), Some([at, _])) = (self.cursors.pair, self.place_of(self.along(x, y))) {
            self.put_cursor(at);
        } else {
            self.shift_picture(x - from_x, y - from_y);
        }
    }

    fn along(&self, x: f64, y: f64) -> [f64; 2] {
        let inside = |place: f64, divisions: u16| {
            let half = f64::from(divisions) / 2.0;
            place.clamp(-half, half)
        };
        match self.cursors.kind {
            CursorKind::Volts => [inside(y, DIVISIONS_UP); 2],
            _ => [inside(x, DIVISIONS_ACROSS); 2],
        }
    }

    /// The cursors' readings; none without cursors.
    pub fn cursor_reading(&self) -> Option<CursorReading> {
        let [first, second] = self.cursors.pair?;
        let waveforms = [first, second].map(|cursor| self.find(cursor.source).map(|c| &c.waveform));
        let one = waveforms[0].or(waveforms[1])?;
        let difference = second.at - first.at;
        let is_time = self.cursors.kind == CursorKind::Time;
        let ordinate = ordinate_unit(one).to_owned();
        let unit = if is_time { one.preamble.x_unit.clone() } else { ordinate.clone() };
        let value = |cursor: PlacedCursor| value_at(&self.find(cursor.source)?.waveform, cursor.at);
        let seconds = is_time && unit == "s" && difference != 0.0;
        let speed = || {
            let from = self.sensor(first.source)?.place?;
            let to = self.sensor(second.source)?.place?;
            let distance = self.recordings.front().scene.as_ref()?.distance(from, to)?.value;
            (distance != 0.0).then(|| (distance / difference).abs())
        };
        Some(CursorReading {
            at: [first.at, second.at],
            difference,
            unit,
            rate: seconds.then(|| 1.0 / difference.abs()),
            values: if is_time { [value(first), value(second)] } else { [None; 2] },
            value_unit: ordinate,
            speed: if seconds { speed() } else { None },
        })
    }
}

/// Swings smaller than this share of the largest are no peaks (1).
const MIN_SWING_SHARE: f64 = 0.1;
/// A peak is half as high at its edge (1).
const EDGE_SHARE: f64 = 0.5;

/// Abscissae of all peaks and edges, in order (s; Hz for an FFT).
pub fn features(waveform: &Waveform) -> Vec<f64> {
    let values: Vec<f64> = waveform.values().collect();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let Some(base) = sorted.get(sorted.len() / 2).copied() else { return Vec::new() };
    let swing = values.iter().map(|value| (value - base).abs()).fold(0.0, f64::max);
    let band = MIN_SWING_SHARE * swing;
    let mut places = Vec::new();
    let mut index = 0;
    while let Some(first) = next_outside(&values, index, base, band) {
        let sign = (values.get(first).copied().unwrap_or(base) - base).signum();
        let height = |at: usize| values.get(at).map_or(0.0, |value| sign * (value - base));
        let end = (first..values.len()).find(|at| height(*at) < band).unwrap_or(values.len());
        let peak =
            (first..end).fold(first, |best, at| if height(at) > height(best) { at } else { best });
        let level = EDGE_SHARE * height(peak);
        let from = first.saturating_sub(1);
        let rise = (from..peak).find(|at| height(*at) < level && height(at + 1) >= level);
        places.extend(rise.map(|at| {
            let share = (level - height(at)) / (height(at + 1) - height(at));
            waveform.time(at) + share * waveform.preamble.x_incr
        }));
        places.push(waveform.time(peak));
        index = end;
    }
    places
}

/// The first point from `from` on that lies outside the band (1).
fn next_outside(values: &[f64], from: usize, base: f64, band: f64) -> Option<usize> {
    let outside = |value: &f64| band > 0.0 && (value - base).abs() >= band;
    values.iter().skip(from).position(outside).map(|at| at + from)
}
