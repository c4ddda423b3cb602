//! The whole front panel: everything that a set-up memory holds and `SET?` tells.

mod acquire;
mod cursor;
mod display;
mod horizontal;
mod math;
mod measurement;
mod trigger;
mod vertical;

pub use acquire::{Acquire, StopAfter};
pub use cursor::{BarUnits, Cursor, CursorFunction};
pub use display::{Display, DisplayFormat, DisplayStyle, HardCopy, HardCopyFormat, Layout, Port};
pub use horizontal::{Horizontal, View};
pub use math::{FftWindow, Math, MathFunction};
pub use measurement::{Measurement, MeasurementType};
pub use trigger::{
    Polarity, PulsePolarity, PulseWhen, TriggerPanel, TriggerType, VideoStandard, VideoSync,
};
pub use vertical::Channel;

use super::limits;
use crate::scope::{
    AcquireSetup, ChannelSetup, Deviation, Model, Setup, Source, Trigger, VerticalSetup,
};

/// Every setting of the front panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Input channels, whether displayed, and their vertical settings.
    channels: [Channel; 4],
    /// Time base.
    pub horizontal: Horizontal,
    /// Trigger.
    pub trigger: TriggerPanel,
    /// Acquisition.
    pub acquire: Acquire,
    /// Math trace.
    pub math: Math,
    /// Which reference memories are displayed, A to D.
    references: [bool; 4],
    /// Cursors.
    pub cursor: Cursor,
    /// The five measurements on the screen.
    measurements: [Measurement; 5],
    /// The measurement of the remote interface.
    pub immediate: Measurement,
    /// Screen.
    pub display: Display,
    /// Printer.
    pub hard_copy: HardCopy,
}

impl Default for Panel {
    /// The factory set-up.
    fn default() -> Self {
        let off = Channel::default();
        Self {
            channels: [Channel { displayed: true, ..off }, off, off, off],
            horizontal: Horizontal::default(),
            trigger: TriggerPanel::default(),
            acquire: Acquire::default(),
            math: Math::default(),
            references: [false; 4],
            cursor: Cursor::default(),
            measurements: [Measurement::default(); 5],
            immediate: Measurement { kind: MeasurementType::Period, source: Source::Channel(1) },
            display: Display::default(),
            hard_copy: HardCopy::default(),
        }
    }
}

impl Panel {
    /// The factory set-up with all that `setup` tells; channels that it leaves off are off.
    pub fn of(setup: &Setup) -> Self {
        let mut panel = Self::default();
        for (number, channel) in (1..=4).zip(&setup.channels) {
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
        let Trigger { source, level, slope, mode, coupling, holdoff } = setup.trigger;
        panel.trigger =
            TriggerPanel { mode, source, holdoff, level, slope, coupling, ..panel.trigger };
        let AcquireSetup { mode, averages } = setup.acquisition;
        panel.acquire = Acquire { mode, averages, ..panel.acquire };
        panel
    }

    /// Settings of channel `number`, counted from 1; numbers beyond the last mean the last.
    pub fn channel(&self, number: u8) -> &Channel {
        let [one, two, three, four] = &self.channels;
        match number {
            0 | 1 => one,
            2 => two,
            3 => three,
            _ => four,
        }
    }

    /// Settings of channel `number`, counted from 1; numbers beyond the last mean the last.
    pub fn channel_mut(&mut self, number: u8) -> &mut Channel {
        let [one, two, three, four] = &mut self.channels;
        match number {
            0 | 1 => one,
            2 => two,
            3 => three,
            _ => four,
        }
    }

    /// Measurement `number` of the screen, counted from 1; numbers beyond the last mean the last.
    pub fn measurement_mut(&mut self, number: u8) -> &mut Measurement {
        let [one, two, three, four, five] = &mut self.measurements;
        match number {
            0 | 1 => one,
            2 => two,
            3 => three,
            4 => four,
            _ => five,
        }
    }

    /// Whether a waveform is displayed.
    pub fn displays(&self, source: Source) -> bool {
        let [a, b, c, d] = self.references;
        match source {
            Source::Channel(number) => self.channel(number).displayed,
            Source::Math => self.math.displayed,
            Source::Reference('A') => a,
            Source::Reference('B') => b,
            Source::Reference('C') => c,
            Source::Reference(_) => d,
        }
    }

    /// Whether channel `number` is recorded: it is displayed, or the displayed math trace needs it.
    pub fn records(&self, number: u8) -> bool {
        let displayed = self.displays(Source::Channel(number));
        displayed || (self.math.displayed && self.math.function.uses(number))
    }

    /// The switch that displays a waveform.
    pub fn displayed_mut(&mut self, source: Source) -> &mut bool {
        if let Source::Channel(number) = source {
            return &mut self.channel_mut(number).displayed;
        }
        let [a, b, c, d] = &mut self.references;
        match source {
            Source::Math => &mut self.math.displayed,
            Source::Reference('A') => a,
            Source::Reference('B') => b,
            Source::Reference('C') => c,
            Source::Reference(_) | Source::Channel(_) => d,
        }
    }

    /// The trigger level nearest to `level` within the reach of its source (V).
    pub fn trigger_level(&self, model: &Model, level: f64) -> f64 {
        let source = self.trigger.source;
        let (low, high) = if let Some(number) = source.channel() {
            let vertical = self.channel(number).vertical;
            let volts = |divisions: f64| (divisions - vertical.position) * vertical.scale;
            (volts(-model.trigger_range), volts(model.trigger_range))
        } else {
            let reach = source.reach(model);
            (-reach, reach)
        };
        limits::rounded(level.clamp(low, high), 7)
    }

    /// The settings of front end and digitiser: channels that are recorded or trigger are on. Free
    /// of errors and noise.
    pub fn setup(&self, model: &Model) -> Setup {
        let trigger_source = self.trigger.source.channel();
        let channel = |number: u8| {
            let channel = self.channel(number);
            let on = self.records(number) || trigger_source == Some(number);
            let vertical: VerticalSetup = channel.vertical;
            let deviation = Deviation::default();
            on.then_some(ChannelSetup { vertical, input: None, offset: 0.0, deviation })
        };
        let horizontal = &self.horizontal;
        let (time_base, horizontal_position) = match horizontal.view {
            View::Window => (horizontal.delay_scale, horizontal.delay_position),
            View::Main | View::Zone => (horizontal.scale, horizontal.position),
        };
        Setup {
            model: model.clone(),
            channels: (1..=model.channels).map(channel).collect(),
            external: None,
            time_base,
            horizontal_position,
            trigger: Trigger {
                source: self.trigger.source,
                level: self.trigger.level,
                slope: self.trigger.slope,
                mode: self.trigger.mode,
                coupling: self.trigger.coupling,
                holdoff: self.trigger.holdoff,
            },
            acquisition: self.acquire.scope(),
            noise: 0.0,
        }
    }
}
