//! The front panel: everything that a set-up memory holds and `SET?` returns, and the limits that
//! hold whichever setting was changed.
//!
//! Sizes come from the model: it has as many channels as its data file says, and as many reference
//! memories. `instrument` holds the panel of a virtual scope, scenes set it up ([`Panel::of`]), and
//! digitiser and trigger take their part of it ([`Panel::setup`]).

use std::collections::BTreeMap;

use super::limits;
use super::word::{Word as _, abbreviates, words};
use super::{
    AcquireSetup, ChannelSetup, Coupling, Deviation, EdgeCoupling, Model, Setup, Slope, Source,
    Trigger, TriggerMode, TriggerSource, VerticalSetup,
};

words! {
    /// Condition that ends an acquisition.
    StopAfter {
        /// The RUN/STOP key.
        RunStop = "RUNSTop",
        /// The end of one sequence.
        Sequence = "SEQuence",
    }

    /// Type of the trigger.
    TriggerType {
        /// The source crosses the level.
        Edge = "EDGE",
        /// A line or field of a video signal.
        Video = "VIDeo",
        /// A pulse of a certain width.
        Pulse = "PULse",
    }

    /// Direction of a pulse.
    PulsePolarity {
        /// Upward.
        Positive = "POSITIVe",
        /// Downward.
        Negative = "NEGAtive",
    }

    /// Which pulses trigger.
    PulseWhen {
        /// As wide as the setting.
        Equal = "EQual",
        /// Narrower or wider.
        NotEqual = "NOTEqual",
        /// Narrower.
        Inside = "INside",
        /// Wider.
        Outside = "OUTside",
    }

    /// The part of the record on the screen.
    View {
        /// The main time base.
        Main = "MAIn",
        /// The window zone on top of the main time base.
        Zone = "ZONE",
        /// The window alone.
        Window = "WINDOW",
    }

    /// Which cursors are shown.
    CursorFunction {
        /// None.
        Off = "OFF",
        /// Two levels.
        HorizontalBars = "HBArs",
        /// Two times.
        VerticalBars = "VBArs",
    }

    /// Unit of the distance between vertical bars.
    BarUnits {
        /// As a time.
        Seconds = "SECOnds",
        /// As a frequency.
        Hertz = "HERtz",
    }

    /// The measurements of this instrument.
    MeasurementType {
        /// Nothing.
        None = "NONe",
        /// Frequency of the first cycle.
        Frequency = "FREQuency",
        /// Mean over the whole record.
        Mean = "MEAN",
        /// Length of the first cycle.
        Period = "PERIod",
        /// Highest less lowest level.
        PeakToPeak = "PK2pk",
        /// Root mean square over the first cycle.
        CycleRms = "CRMs",
        /// Lowest level.
        Minimum = "MINImum",
        /// Highest level.
        Maximum = "MAXImum",
        /// From 10 % to 90 % of the first rising edge.
        Rise = "RISe",
        /// From 90 % to 10 % of the first falling edge.
        Fall = "FALL",
        /// Width of the first pulse upward, at half height.
        PositiveWidth = "PWIdth",
        /// Width of the first pulse downward, at half height.
        NegativeWidth = "NWIdth",
    }

    /// Weight of the samples in a transform.
    FftWindow {
        /// Good for frequencies and transients.
        Hanning = "HANning",
        /// Good for amplitudes.
        FlatTop = "FLATtop",
        /// None.
        Rectangular = "RECTangular",
    }

    /// Display format: YT or XY.
    DisplayFormat {
        /// Volts against time.
        Yt = "YT",
        /// Channel 2 against channel 1.
        Xy = "XY",
    }

    /// How points are drawn.
    DisplayStyle {
        /// As dots.
        Dots = "DOTs",
        /// Joined by lines.
        Vectors = "VECtors",
    }

    /// Where the printer is.
    Port {
        /// Parallel port.
        Centronics = "CENtronics",
        /// Serial port.
        Rs232 = "RS232",
        /// Instrument bus.
        Gpib = "GPIB",
    }

    /// Language of the printer.
    HardCopyFormat {
        /// Windows bitmap.
        Bmp = "BMP",
        /// Bubble jet.
        BubbleJet = "BUBBLEJet",
        /// Seiko DPU 411.
        Dpu411 = "DPU411",
        /// Seiko DPU 412.
        Dpu412 = "DPU412",
        /// Desk jet in colour.
        DeskJetColour = "DESKJETC",
        /// Desk jet.
        DeskJet = "DESKJet",
        /// Encapsulated PostScript in colour.
        EpsColour = "EPSCOlor",
        /// Encapsulated PostScript.
        EpsMono = "EPSMono",
        /// Epson, 9 or 24 pins.
        Epson = "EPSOn",
        /// Interleaf.
        Interleaf = "INTERLeaf",
        /// Laser jet.
        LaserJet = "LASERJet",
        /// PC Paintbrush.
        Pcx = "PCX",
        /// RLE bitmap.
        Rle = "RLE",
        /// Think jet.
        ThinkJet = "THINKjet",
        /// Tagged image file.
        Tiff = "TIFf",
    }
}

/// One channel's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// Whether the channel is on.
    pub displayed: bool,
    /// Whether the scale may stand between the steps of 1-2-5: Volts/Div on Fine in the channel's
    /// menu.
    pub fine: bool,
    /// Scale, position, coupling, bandwidth, inversion, probe.
    pub vertical: VerticalSetup,
}

impl Default for Channel {
    fn default() -> Self {
        Self {
            displayed: false,
            fine: false,
            vertical: VerticalSetup {
                scale: 1.0,
                position: 0.0,
                coupling: Some(Coupling::Dc),
                bandwidth_limited: Some(false),
                inverted: Some(false),
                probe: 10.0,
            },
        }
    }
}

impl Channel {
    /// Turns the channel to the scale nearest to `scale` (V/div); the position keeps to its steps
    /// and within its reach there.
    pub fn turn_scale(&mut self, model: &Model, scale: f64) {
        let vertical = &mut self.vertical;
        vertical.scale = limits::vertical_scale(model, (scale, vertical.probe), self.fine);
        let VerticalSetup { scale, position, probe, .. } = *vertical;
        vertical.position = limits::vertical_position(model, position, scale, probe);
    }
}

/// The time base's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Horizontal {
    /// Which part is shown.
    pub view: View,
    /// Main time base (s/div).
    pub scale: f64,
    /// Screen's centre after the trigger (s).
    pub position: f64,
    /// Time base of the window (s/div).
    pub delay_scale: f64,
    /// Window's centre after the trigger (s).
    pub delay_position: f64,
}

impl Default for Horizontal {
    fn default() -> Self {
        Self {
            view: View::Main,
            scale: 500e-6,
            position: 0.0,
            delay_scale: 50e-6,
            delay_position: 0.0,
        }
    }
}

/// The pulse trigger's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseTrigger {
    /// Direction of the pulse.
    pub polarity: PulsePolarity,
    /// Which pulses trigger.
    pub when: PulseWhen,
    /// Width that pulses are compared with (s).
    pub width: f64,
}

impl Default for PulseTrigger {
    fn default() -> Self {
        Self { polarity: PulsePolarity::Positive, when: PulseWhen::Equal, width: 1e-3 }
    }
}

/// Function of the math trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MathFunction {
    /// Sum of two channels.
    Sum(u8, u8),
    /// First channel less the second.
    Difference(u8, u8),
    /// Spectrum of a channel.
    Fft(u8, FftWindow),
}

/// Pairs of channels that the original instrument adds and subtracts.
const PAIRS: [(u8, u8); 2] = [(1, 2), (3, 4)];

impl MathFunction {
    /// Reads a definition, e.g. `CH1 - CH2` or `FFT(CH1,HANNING)`; `None` for what this instrument
    /// has not.
    pub fn parse(definition: &str, channels: u8) -> Option<Self> {
        let text: String = definition.chars().filter(|c| !c.is_whitespace()).collect();
        let upper = text.to_ascii_uppercase();
        let channel = |name: &str| match Source::from_name(name) {
            Some(Source::Channel(number)) if number <= channels => Some(number),
            _ => None,
        };
        if let Some(inner) = upper.strip_prefix("FFT(").and_then(|rest| rest.strip_suffix(')')) {
            let (name, window) = inner.split_once(',').unwrap_or((inner, "HANNING"));
            let is_named = |(_, word): &&(FftWindow, &'static str)| abbreviates(window, word);
            let (window, _) = FftWindow::WORDS.iter().find(is_named)?;
            return Some(Self::Fft(channel(name)?, *window));
        }
        let sign = upper.find(['+', '-'])?;
        let (first, rest) = upper.split_at_checked(sign)?;
        let (a, b) = (channel(first)?, channel(rest.get(1..)?)?);
        let sum = rest.starts_with('+');
        let known =
            |(low, high): &(u8, u8)| (a, b) == (*low, *high) || (!sum && (b, a) == (*low, *high));
        PAIRS.iter().any(known).then_some(if sum {
            Self::Sum(a, b)
        } else {
            Self::Difference(a, b)
        })
    }

    /// Whether channel `number` is needed for it.
    pub fn uses(self, number: u8) -> bool {
        match self {
            Self::Sum(a, b) | Self::Difference(a, b) => a == number || b == number,
            Self::Fft(channel, _) => channel == number,
        }
    }

    /// The definition as the instrument writes it.
    pub fn definition(self) -> String {
        match self {
            Self::Sum(a, b) => format!("CH{a} + CH{b}"),
            Self::Difference(a, b) => format!("CH{a} - CH{b}"),
            Self::Fft(channel, window) => {
                format!("FFT(CH{channel},{})", window.word().to_ascii_uppercase())
            }
        }
    }
}

/// The math trace's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Math {
    /// Whether it is displayed.
    pub displayed: bool,
    /// Its function.
    pub function: MathFunction,
    /// Screen's centre in the spectrum, percent of it (1).
    pub fft_horizontal_position: f64,
    /// Horizontal zoom of the spectrum: 1, 2, 5 or 10 (1).
    pub fft_horizontal_scale: f64,
    /// Vertical position of the spectrum (div).
    pub fft_vertical_position: f64,
    /// Vertical zoom of the spectrum: 0.5, 1, 2, 5 or 10 (1).
    pub fft_vertical_scale: f64,
}

impl Default for Math {
    fn default() -> Self {
        Self {
            displayed: false,
            function: MathFunction::Difference(1, 2),
            fft_horizontal_position: 50.0,
            fft_horizontal_scale: 1.0,
            fft_vertical_position: 0.0,
            fft_vertical_scale: 1.0,
        }
    }
}

/// The cursors' part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cursor {
    /// Which are shown.
    pub function: CursorFunction,
    /// The waveform that they read.
    pub source: Source,
    /// Seconds or hertz.
    pub vertical_units: BarUnits,
    /// Vertical bars after the trigger (s).
    pub vertical: [f64; 2],
    /// Horizontal bars (V).
    pub horizontal: [f64; 2],
}

impl Default for Cursor {
    /// Bars 3.2 divisions to either side of the centre, at the factory's scales.
    fn default() -> Self {
        Self {
            function: CursorFunction::Off,
            source: Source::Channel(1),
            vertical_units: BarUnits::Seconds,
            vertical: [-1.6e-3, 1.6e-3],
            horizontal: [-3.2, 3.2],
        }
    }
}

/// One measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Measurement {
    /// Type of the measurement.
    pub kind: MeasurementType,
    /// On which waveform.
    pub source: Source,
}

impl Default for Measurement {
    fn default() -> Self {
        Self { kind: MeasurementType::None, source: Source::Channel(1) }
    }
}

/// The screen's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Display {
    /// Display format: YT or XY.
    pub format: DisplayFormat,
    /// How points are drawn.
    pub style: DisplayStyle,
    /// How long a record stays on the screen; infinite for good (s).
    pub persistence: f64,
}

impl Default for Display {
    fn default() -> Self {
        Self { format: DisplayFormat::Yt, style: DisplayStyle::Vectors, persistence: 0.0 }
    }
}

/// The printer's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HardCopy {
    /// Language of the printer.
    pub format: HardCopyFormat,
    /// Where the printer is.
    pub port: Port,
    /// Whether the background stays white.
    pub ink_saver: bool,
}

impl Default for HardCopy {
    fn default() -> Self {
        Self { format: HardCopyFormat::Epson, port: Port::Centronics, ink_saver: true }
    }
}

/// Every setting of the front panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Input channels by number.
    channels: BTreeMap<u8, Channel>,
    /// Time base.
    pub horizontal: Horizontal,
    /// Trigger, whatever its type.
    pub trigger: Trigger,
    /// Type of the trigger.
    pub trigger_type: TriggerType,
    /// Pulse trigger.
    pub pulse: PulseTrigger,
    /// How records are taken.
    pub acquire: AcquireSetup,
    /// Condition that ends an acquisition.
    pub stop_after: StopAfter,
    /// Math trace.
    pub math: Math,
    /// Whether a reference memory is displayed, by letter.
    references: BTreeMap<char, bool>,
    /// Cursors.
    pub cursor: Cursor,
    /// The measurements on the screen by number.
    measurements: BTreeMap<u8, Measurement>,
    /// The measurement of the remote interface.
    pub immediate: Measurement,
    /// Screen.
    pub display: Display,
    /// Settings without effect, by the header of their command: stored and returned.
    pub stored: BTreeMap<&'static str, u32>,
}

/// The factory's trigger.
const FACTORY_TRIGGER: Trigger = Trigger {
    source: TriggerSource::Channel(1),
    level: 0.0,
    slope: Slope::Rise,
    mode: TriggerMode::Auto,
    coupling: EdgeCoupling::Dc,
    holdoff: 500e-9,
};

impl Panel {
    /// The factory set-up of a model.
    pub fn factory(model: &Model) -> Self {
        let channel = |number| (number, Channel { displayed: number == 1, ..Channel::default() });
        Self {
            channels: (1..=model.channels).map(channel).collect(),
            horizontal: Horizontal::default(),
            trigger: FACTORY_TRIGGER,
            trigger_type: TriggerType::Edge,
            pulse: PulseTrigger::default(),
            acquire: AcquireSetup::default(),
            stop_after: StopAfter::RunStop,
            math: Math::default(),
            references: BTreeMap::new(),
            cursor: Cursor::default(),
            measurements: BTreeMap::new(),
            immediate: Measurement { kind: MeasurementType::Period, source: Source::Channel(1) },
            display: Display::default(),
            stored: BTreeMap::new(),
        }
    }

    /// The factory set-up with the settings of `setup`; channels that are off there are off.
    pub fn of(setup: &Setup) -> Self {
        let mut panel = Self::factory(&setup.model);
        for (number, channel) in (1..).zip(&setup.channels) {
            let knobs = panel.channel_mut(number);
            knobs.displayed = channel.is_some();
            let Some(channel) = channel else { continue };
            let factory = knobs.vertical;
            let (scale, probe) = (channel.vertical.scale, channel.vertical.probe);
            let step = limits::vertical_scale(&setup.model, (scale, probe), false);
            knobs.fine = (scale / step - 1.0).abs() > 1e-6;
            knobs.vertical = VerticalSetup {
                coupling: channel.vertical.coupling.or(factory.coupling),
                bandwidth_limited: channel.vertical.bandwidth_limited.or(factory.bandwidth_limited),
                inverted: channel.vertical.inverted.or(factory.inverted),
                ..channel.vertical
            };
        }
        panel.horizontal.scale = setup.time_base;
        panel.horizontal.position = setup.horizontal_position;
        panel.trigger = setup.trigger;
        panel.acquire = setup.acquisition;
        panel
    }

    /// Brings settings back within the limits of the model where those have moved: the position
    /// follows the scale, the trigger level the channel that it looks at, the window the main time
    /// base, cursors the record. To be called after every change, whatever was changed.
    pub fn fit(&mut self, model: &Model) {
        for channel in self.channels.values_mut() {
            let vertical = &mut channel.vertical;
            let reach = limits::vertical_reach(model, vertical.scale, vertical.probe);
            vertical.position = limits::within(vertical.position, (-reach, reach));
        }
        let horizontal = &mut self.horizontal;
        horizontal.delay_scale = horizontal.delay_scale.min(horizontal.scale);
        for (position, scale) in [
            (&mut horizontal.position, horizontal.scale),
            (&mut horizontal.delay_position, horizontal.delay_scale),
        ] {
            *position = limits::within(*position, limits::horizontal_range(model, scale));
        }
        let level = self.trigger.level;
        let (low, high) = self.level_range(model);
        if !(low..=high).contains(&level) {
            self.trigger.level = self.trigger_level(model, level);
        }
        let (time_base, position) = self.time_window();
        let span = model.record_span(time_base, position);
        for time in &mut self.cursor.vertical {
            *time = limits::within(*time, span);
        }
        if self.display.format == DisplayFormat::Xy {
            self.cursor.function = CursorFunction::Off;
        }
    }

    /// Settings of channel `number`, counted from 1.
    pub fn channel(&self, number: u8) -> Channel {
        self.channels.get(&number).copied().unwrap_or_default()
    }

    /// Settings of channel `number`, counted from 1.
    pub fn channel_mut(&mut self, number: u8) -> &mut Channel {
        self.channels.entry(number).or_default()
    }

    /// Measurement `number` of the screen, counted from 1.
    pub fn measurement(&self, number: u8) -> Measurement {
        self.measurements.get(&number).copied().unwrap_or_default()
    }

    /// Measurement `number` of the screen, counted from 1.
    pub fn measurement_mut(&mut self, number: u8) -> &mut Measurement {
        self.measurements.entry(number).or_default()
    }

    /// Whether a waveform is displayed.
    pub fn displays(&self, source: Source) -> bool {
        match source {
            Source::Channel(number) => self.channel(number).displayed,
            Source::Math => self.math.displayed,
            Source::Reference(letter) => self.references.get(&letter).is_some_and(|on| *on),
        }
    }

    /// The switch that displays a waveform.
    pub fn displayed_mut(&mut self, source: Source) -> &mut bool {
        match source {
            Source::Channel(number) => &mut self.channel_mut(number).displayed,
            Source::Math => &mut self.math.displayed,
            Source::Reference(letter) => self.references.entry(letter).or_default(),
        }
    }

    /// Whether channel `number` is recorded: it is displayed, or the displayed math trace needs it.
    pub fn records(&self, number: u8) -> bool {
        let displayed = self.displays(Source::Channel(number));
        displayed || (self.math.displayed && self.math.function.uses(number))
    }

    /// The trigger level nearest to `level` within the reach of its source (V).
    pub fn trigger_level(&self, model: &Model, level: f64) -> f64 {
        limits::rounded(limits::within(level, self.level_range(model)), 7)
    }

    /// Lowest and highest trigger level; the mains have none (V).
    fn level_range(&self, model: &Model) -> (f64, f64) {
        let source = self.trigger.source;
        match source.channel() {
            Some(number) => {
                let vertical = self.channel(number).vertical;
                let volts = |divisions: f64| (divisions - vertical.position) * vertical.scale;
                (volts(-model.trigger_range), volts(model.trigger_range))
            }
            None if source == TriggerSource::Line => (f64::NEG_INFINITY, f64::INFINITY),
            None => (-source.reach(model), source.reach(model)),
        }
    }

    /// Time base (s/div) and position (s) of records: those of the window where it is shown alone.
    fn time_window(&self) -> (f64, f64) {
        let horizontal = &self.horizontal;
        match horizontal.view {
            View::Window => (horizontal.delay_scale, horizontal.delay_position),
            View::Main | View::Zone => (horizontal.scale, horizontal.position),
        }
    }

    /// The settings of front end and digitiser: channels that are recorded or trigger are on. Free
    /// of errors and noise.
    pub fn setup(&self, model: &Model) -> Setup {
        let trigger_source = self.trigger.source.channel();
        let channel = |number: u8| {
            let on = self.records(number) || trigger_source == Some(number);
            let (vertical, deviation) = (self.channel(number).vertical, Deviation::default());
            on.then_some(ChannelSetup { vertical, input: None, offset: 0.0, deviation })
        };
        let (time_base, horizontal_position) = self.time_window();
        Setup {
            model: model.clone(),
            channels: (1..=model.channels).map(channel).collect(),
            external: None,
            time_base,
            horizontal_position,
            trigger: self.trigger,
            acquisition: self.acquire,
            noise: 0.0,
        }
    }
}
