//! From bytes to messages.
//!
//! A message ends with a line feed or a carriage return; the second one of a pair ends an empty
//! message. Inside a block, `#<n><length><bytes>`, every byte is content. A message that grows
//! beyond [`MAXIMUM_BYTES`] is lost to its end.

/// Longest message. A curve of 2500 points as text has at most 12 500 bytes.
pub const MAXIMUM_BYTES: usize = 32_768;

/// Part of a message that the next byte belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Place {
    /// In plain text.
    #[default]
    Text,
    /// In a text in quotation marks.
    Quoted(u8),
    /// After a `#`.
    BlockStart,
    /// In the digits of a block's length: digits to come, and the length so far.
    BlockLength(u8, usize),
    /// In a block; the number of its bytes that are still to come.
    Block(usize),
}

/// A piece of input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum InputPiece {
    /// A message without its end.
    Message(Vec<u8>),
    /// A message was too long, and is lost.
    Overrun,
}

/// Collects bytes until a message is complete.
#[derive(Debug, Clone, Default)]
pub struct InputBuffer {
    message: Vec<u8>,
    place: Place,
    overrun: bool,
}

impl InputBuffer {
    /// Takes one byte; returns what it completes.
    pub fn push(&mut self, byte: u8) -> Option<InputPiece> {
        let ends = match self.place {
            Place::Text | Place::Quoted(_) | Place::BlockStart | Place::BlockLength(..) => {
                matches!(byte, b'\n' | b'\r')
            }
            Place::Block(_) => false,
        };
        if ends {
            return self.finish();
        }
        self.place = self.after(byte);
        if self.message.len() < MAXIMUM_BYTES {
            self.message.push(byte);
        } else {
            self.overrun = true;
        }
        None
    }

    /// Ends the message where the protocol marks its end; returns it, unless it is empty.
    pub fn finish(&mut self) -> Option<InputPiece> {
        self.place = Place::Text;
        let message = std::mem::take(&mut self.message);
        if std::mem::take(&mut self.overrun) {
            return Some(InputPiece::Overrun);
        }
        (!message.is_empty()).then_some(InputPiece::Message(message))
    }

    /// Forgets an incomplete message.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    fn after(&self, byte: u8) -> Place {
        match self.place {
            Place::Text => match byte {
                b'"' | b'\'' => Place::Quoted(byte),
                b'#' if self.argument_begins() => Place::BlockStart,
                _ => Place::Text,
            },
            Place::Quoted(mark) if byte != mark => Place::Quoted(mark),
            Place::BlockStart if (b'1'..=b'9').contains(&byte) => {
                Place::BlockLength(byte - b'0', 0)
            }
            Place::BlockLength(digits, length) if byte.is_ascii_digit() => {
                let length = length.saturating_mul(10).saturating_add(usize::from(byte - b'0'));
                match digits {
                    2.. => Place::BlockLength(digits - 1, length),
                    // A block that cannot fit is no block: its message ends at the next line.
                    _ if (1..=MAXIMUM_BYTES).contains(&length) => Place::Block(length),
                    _ => Place::Text,
                }
            }
            Place::Block(left) if left > 1 => Place::Block(left - 1),
            Place::Quoted(_) | Place::BlockStart | Place::BlockLength(..) | Place::Block(_) => {
                Place::Text
            }
        }
    }

    /// Whether the byte before the next one lets an argument begin.
    fn argument_begins(&self) -> bool {
        self.message.last().is_some_and(|byte| matches!(byte, b' ' | b'\t' | b','))
    }
}
