//! What a row of the table of commands consists of.
//!
//! A row says what is behind its command, not how it is executed: a [`Slot`] of the front panel, a
//! setting that is only stored, a group of other rows, or functions.

use super::message::Argument;
use super::reply::Preferences;
use super::value::{ReplyValue, flag, only, real, whole};
use crate::instrument::{Event, Instrument};
use crate::scope::model::nearest;
use crate::scope::panel::{Channel, Measurement};
use crate::scope::word::{WordSetting, abbreviates};
use crate::scope::{Panel, Source};

/// Why a unit was not executed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Deferred {
    /// It failed.
    Event(Event),
    /// It has to wait until the acquisition is done.
    UntilIdle,
    /// These commands are executed instead.
    Execute(String),
}

impl From<Event> for Deferred {
    fn from(event: Event) -> Self {
        Self::Event(event)
    }
}

/// Numbers in a command's header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Suffix {
    /// The number of `CH<x>`, `MEAS<x>`, `POSITION<x>`; 1 without one.
    pub number: u8,
    /// The waveform of `CH<x>`, `REF<x>`, `<wfm>`; channel 1 without one.
    pub source: Source,
}

impl Default for Suffix {
    fn default() -> Self {
        Self { number: 1, source: Source::Channel(1) }
    }
}

/// Context in which a unit is executed.
pub struct Context<'a> {
    /// The instrument.
    pub instrument: &'a mut Instrument,
    /// The connection's headers and terminator.
    pub preferences: &'a mut Preferences,
    /// Numbers in the header.
    pub suffix: Suffix,
    /// Whether a reply of the same message waits.
    pub message_available: bool,
    /// Bytes that are sent as they are, behind the replies to the message.
    pub raw: &'a mut Vec<u8>,
}

impl Context<'_> {
    /// The front panel.
    pub fn panel(&mut self) -> &mut Panel {
        &mut self.instrument.panel
    }

    /// The channel in the header.
    pub fn channel(&mut self) -> &mut Channel {
        self.instrument.panel.channel_mut(self.suffix.number)
    }

    /// The measurement in the header.
    pub fn measurement(&mut self) -> &mut Measurement {
        self.instrument.panel.measurement_mut(self.suffix.number)
    }
}

/// A setting in the instrument or the connection, with its type.
pub enum Slot<'a> {
    /// One of several words.
    Word(&'a mut dyn WordSetting),
    /// A flag, written as 1 or 0.
    Flag(&'a mut bool),
    /// A flag, written as ON or OFF.
    Switch(&'a mut bool),
    /// A number with decimals (unit).
    Real(&'a mut f64),
    /// A register of eight bits; numbers that do not fit are refused.
    Register(&'a mut u8),
    /// A whole number, clamped into this range.
    Whole(&'a mut usize, (u32, u32)),
}

impl Slot<'_> {
    /// Sets it from `arguments`, on a model with `channels` channels.
    fn set(self, arguments: &[Argument], channels: u8) -> Result<(), Event> {
        match self {
            Self::Word(slot) => match only(arguments)? {
                Argument::Word(typed) if slot.choose(typed, channels) => {}
                Argument::Word(_) => return Err(Event::IllegalParameter),
                Argument::Text(_) | Argument::Block(_) => return Err(Event::DataType),
            },
            Self::Flag(slot) | Self::Switch(slot) => *slot = flag(arguments)?,
            Self::Real(slot) => *slot = real(arguments)?,
            Self::Register(slot) => {
                if !(0.0..=255.0).contains(&real(arguments)?.round()) {
                    return Err(Event::OutOfRange);
                }
                *slot = u8::try_from(whole(arguments, 0, 255)?).unwrap_or(u8::MAX);
            }
            Self::Whole(slot, (least, most)) => {
                *slot = usize::try_from(whole(arguments, least, most)?).unwrap_or(*slot);
            }
        }
        Ok(())
    }

    fn get(self) -> ReplyValue {
        match self {
            Self::Word(slot) => ReplyValue::Word(slot.spelling()),
            Self::Flag(slot) => ReplyValue::flag(*slot),
            Self::Switch(slot) => ReplyValue::on_or_off(*slot),
            Self::Real(slot) => ReplyValue::Number(*slot),
            Self::Register(slot) => ReplyValue::integer(*slot),
            Self::Whole(slot, _) => ReplyValue::Plain(slot.to_string()),
        }
    }
}

/// Values of a setting without effect; the first is the one after power on.
#[derive(Clone, Copy)]
pub enum Stored {
    /// These words.
    Words(&'static [&'static str]),
    /// `OFF` or `ON`.
    Switch,
    /// A whole number in a range, and the one after power on.
    Whole((u32, u32), u32),
    /// The nearest of these numbers (1), and the one after power on (1).
    OneOf(&'static [f64], u32),
}

impl Stored {
    fn read(self, arguments: &[Argument]) -> Result<u32, Event> {
        match self {
            Self::Words(words) => match only(arguments)? {
                Argument::Word(typed) => {
                    let mut numbered = (0..).zip(words);
                    let found = numbered.find(|(_, word)| abbreviates(typed, word));
                    found.map(|(index, _)| index).ok_or(Event::IllegalParameter)
                }
                Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
            },
            Self::Switch => flag(arguments).map(u32::from),
            Self::Whole((least, most), _) => whole(arguments, least, most),
            Self::OneOf(choices, _) => {
                let chosen = nearest(real(arguments)?, choices);
                Ok(chosen as u32)
            }
        }
    }

    fn write(self, value: Option<u32>) -> ReplyValue {
        match self {
            Self::Words(words) => {
                let index = usize::try_from(value.unwrap_or(0)).unwrap_or(0);
                ReplyValue::Word(words.get(index).copied().unwrap_or(""))
            }
            Self::Switch => ReplyValue::on_or_off(value == Some(1)),
            Self::Whole(_, first) | Self::OneOf(_, first) => {
                ReplyValue::integer(value.unwrap_or(first))
            }
        }
    }
}

/// Parts of the reply to a group's query.
#[derive(Debug, Clone, Copy)]
pub enum Parts {
    /// The rows below the group.
    Below,
    /// These headers, as typed.
    Of(&'static [&'static str]),
}

/// A function that finds a slot.
pub type SlotFunction = for<'c, 'i> fn(&'c mut Context<'i>) -> Slot<'c>;
/// A function that finds a number (unit).
pub type NumberFunction = for<'c, 'i> fn(&'c mut Context<'i>) -> &'c mut f64;
/// A function that makes the nearest setting of any number.
pub type FitFunction = fn(&Instrument, Suffix, f64) -> f64;
/// A function that executes a command.
pub type SetFunction = fn(&mut Context<'_>, &[Argument]) -> Result<(), Deferred>;
/// A function that answers a query.
pub type GetFunction = fn(&mut Context<'_>) -> Result<ReplyValue, Deferred>;

/// What is behind a row of the table.
#[derive(Clone, Copy)]
pub enum Setting {
    /// Nothing: the row is an alias.
    Alias,
    /// A slot.
    Slot(SlotFunction),
    /// A number, and how typed ones are snapped to what the instrument has.
    Number(NumberFunction, FitFunction),
    /// A setting without effect, which belongs to the set-up.
    StoredInSetup(Stored),
    /// A setting without effect that set-ups do not hold.
    Stored(Stored),
    /// A query without a command.
    Query(GetFunction),
    /// A command without a query.
    Command(SetFunction),
    /// Both.
    Both(SetFunction, GetFunction),
    /// A query that other rows answer.
    Group(Parts),
    /// The same with a command.
    GroupAndCommand(Parts, SetFunction),
}

impl Setting {
    /// Whether there is a command.
    pub fn is_command(&self) -> bool {
        !matches!(self, Self::Alias | Self::Query(_) | Self::Group(_))
    }

    /// Whether there is a query.
    pub fn is_query(&self) -> bool {
        !matches!(self, Self::Alias | Self::Command(_))
    }

    /// The rows that answer the query.
    pub fn parts(&self) -> Option<Parts> {
        match self {
            Self::Group(parts) | Self::GroupAndCommand(parts, _) => Some(*parts),
            _ => None,
        }
    }
}

/// How far a command is supported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// Implemented as in the manual.
    Implemented,
    /// Implemented here, unknown to the real oscilloscope.
    Extension,
    /// The value is stored and returned without further effect.
    Stub,
    /// Rejected with an event.
    Unsupported,
    /// Another spelling of the row that is named.
    Alias(&'static str),
}

/// One command.
pub struct CommandRow {
    /// Header as in the manual: short forms in capitals, `<x>` for a number, `<wfm>` for a
    /// waveform.
    pub header: &'static str,
    /// What is behind it.
    pub setting: Setting,
    /// How far it is supported.
    pub support: Support,
    /// Whether it is part of the reply to its group's query.
    pub in_group: bool,
    /// One line about it.
    pub about: &'static str,
}

/// Rows that belong together.
pub struct Group {
    /// Heading in the manual.
    pub title: &'static str,
    /// Its commands, in the order of replies to a group's query.
    pub rows: &'static [CommandRow],
}

/// A command that does what the manual says.
pub const fn acts(header: &'static str, setting: Setting, about: &'static str) -> CommandRow {
    CommandRow { header, setting, support: Support::Implemented, in_group: true, about }
}

/// A command that acts and that no real oscilloscope has.
pub const fn own(header: &'static str, setting: Setting, about: &'static str) -> CommandRow {
    CommandRow { support: Support::Extension, ..acts(header, setting, about) }
}

/// A command whose value is stored and returned.
pub const fn stub(header: &'static str, setting: Setting, about: &'static str) -> CommandRow {
    CommandRow { support: Support::Stub, ..acts(header, setting, about) }
}

/// A command that is refused.
pub const fn refused(header: &'static str, setting: Setting, about: &'static str) -> CommandRow {
    CommandRow { support: Support::Unsupported, in_group: false, ..acts(header, setting, about) }
}

/// Another spelling of the row `of`.
pub const fn alias(header: &'static str, of: &'static str) -> CommandRow {
    CommandRow { support: Support::Alias(of), in_group: false, ..acts(header, Setting::Alias, "") }
}

impl CommandRow {
    /// The same, left out of the reply to its group's query.
    pub const fn apart(self) -> Self {
        Self { in_group: false, ..self }
    }

    /// The header's words.
    pub fn nodes(&self) -> impl Iterator<Item = &'static str> {
        self.header.split(':')
    }

    /// Executes the command.
    ///
    /// # Errors
    /// [`Deferred`] if it is not executed.
    pub fn set(&self, context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
        let channels = context.instrument.model.channels;
        match self.setting {
            Setting::Slot(slot) => slot(context).set(arguments, channels)?,
            Setting::Number(slot, fit) => {
                let fitted = fit(context.instrument, context.suffix, real(arguments)?);
                *slot(context) = fitted;
            }
            Setting::StoredInSetup(values) => {
                let value = values.read(arguments)?;
                context.instrument.panel.stored.insert(self.header, value);
            }
            Setting::Stored(values) => {
                let value = values.read(arguments)?;
                context.instrument.service.stored.insert(self.header, value);
            }
            Setting::Command(set) | Setting::Both(set, _) | Setting::GroupAndCommand(_, set) => {
                set(context, arguments)?;
            }
            Setting::Alias | Setting::Query(_) | Setting::Group(_) => {
                return Err(Event::UndefinedHeader.into());
            }
        }
        context.instrument.apply_panel();
        Ok(())
    }

    /// Answers the query.
    ///
    /// # Errors
    /// [`Deferred`] if there is no reply.
    pub fn get(&self, context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
        Ok(match self.setting {
            Setting::Slot(slot) => slot(context).get(),
            Setting::Number(slot, _) => ReplyValue::Number(*slot(context)),
            Setting::StoredInSetup(values) => {
                values.write(context.instrument.panel.stored.get(self.header).copied())
            }
            Setting::Stored(values) => {
                values.write(context.instrument.service.stored.get(self.header).copied())
            }
            Setting::Query(get) | Setting::Both(_, get) => get(context)?,
            Setting::Alias
            | Setting::Command(_)
            | Setting::Group(_)
            | Setting::GroupAndCommand(..) => return Err(Event::UndefinedHeader.into()),
        })
    }
}
