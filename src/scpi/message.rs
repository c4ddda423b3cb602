//! From a message to its units: header, question mark, arguments.

use crate::instrument::Event;

/// Longest text in quotation marks (programmer manual, syntax of commands).
const MAX_TEXT_LENGTH: usize = 1000;

/// One argument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Argument {
    /// A word or a number.
    Word(String),
    /// Text in quotation marks, without them.
    Text(String),
    /// Content of a block.
    Block(Vec<u8>),
}

/// One command or query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MessageUnit {
    /// Whether the header begins with a colon.
    pub from_root: bool,
    /// The header's words, `*` included in the first.
    pub header: Vec<String>,
    /// Whether it asks.
    pub is_query: bool,
    /// The arguments.
    pub arguments: Vec<Argument>,
}

/// Splits a message into units; each is a unit, or the event of its syntax error.
pub fn units(message: &[u8]) -> Vec<Result<MessageUnit, Event>> {
    let mut cursor = Cursor { bytes: message, at: 0 };
    let mut units = Vec::new();
    loop {
        cursor.skip_space();
        match cursor.peek() {
            None => return units,
            Some(b';') => cursor.at += 1,
            Some(_) => {
                let unit = cursor.unit();
                if unit.is_err() {
                    cursor.skip_unit();
                }
                units.push(unit);
            }
        }
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn skip_space(&mut self) {
        self.take_while(|byte| byte <= b' ');
    }

    fn skip_unit(&mut self) {
        self.take_while(|byte| byte != b';');
    }

    fn take_while(&mut self, wanted: impl Fn(u8) -> bool) -> &'a [u8] {
        let start = self.at;
        while self.peek().is_some_and(&wanted) {
            self.at += 1;
        }
        self.bytes.get(start..self.at).unwrap_or_default()
    }

    fn unit(&mut self) -> Result<MessageUnit, Event> {
        let from_root = self.peek() == Some(b':');
        if from_root {
            self.at += 1;
        }
        let text = self.take_while(|b| b.is_ascii_alphanumeric() || b":*_".contains(&b));
        let header: Vec<String> =
            text.split(|byte| *byte == b':').map(|word| text_of(word).to_owned()).collect();
        if header.iter().any(String::is_empty) {
            return Err(Event::Syntax);
        }
        let is_query = self.peek() == Some(b'?');
        if is_query {
            self.at += 1;
        }
        let arguments = match self.peek() {
            None | Some(b';') => Vec::new(),
            Some(byte) if byte <= b' ' => self.arguments()?,
            Some(_) => return Err(Event::InvalidCharacter),
        };
        Ok(MessageUnit { from_root, header, is_query, arguments })
    }

    fn arguments(&mut self) -> Result<Vec<Argument>, Event> {
        let mut arguments = Vec::new();
        self.skip_space();
        if matches!(self.peek(), None | Some(b';')) {
            return Ok(arguments);
        }
        loop {
            self.skip_space();
            arguments.push(self.argument()?);
            self.skip_space();
            match self.peek() {
                None | Some(b';') => return Ok(arguments),
                Some(b',') => self.at += 1,
                Some(_) => return Err(Event::InvalidCharacter),
            }
        }
    }

    fn argument(&mut self) -> Result<Argument, Event> {
        match self.peek() {
            Some(mark @ (b'"' | b'\'')) => self.quoted(mark),
            Some(b'#') => self.block(),
            _ => {
                let word = self.take_while(|b| b.is_ascii_graphic() && !b";,\"'#".contains(&b));
                if word.is_empty() {
                    return Err(Event::Syntax);
                }
                Ok(Argument::Word(text_of(word).to_owned()))
            }
        }
    }

    /// Text up to its quotation mark; two marks in a row mean one.
    fn quoted(&mut self, mark: u8) -> Result<Argument, Event> {
        self.at += 1;
        let mut text = Vec::new();
        loop {
            text.extend_from_slice(self.take_while(|byte| byte != mark));
            if self.peek().is_none() || text.len() > MAX_TEXT_LENGTH {
                return Err(Event::InvalidString);
            }
            self.at += 1;
            if self.peek() != Some(mark) {
                return Ok(Argument::Text(String::from_utf8_lossy(&text).into_owned()));
            }
            text.push(mark);
            self.at += 1;
        }
    }

    /// A block, `#<n><length><bytes>`.
    fn block(&mut self) -> Result<Argument, Event> {
        let content = |cursor: &Self| {
            let digits = usize::from(cursor.bytes.get(cursor.at + 1)?.checked_sub(b'0')?);
            let start = cursor.at + 2 + digits;
            let length: usize = text_of(cursor.bytes.get(cursor.at + 2..start)?).parse().ok()?;
            let end = start.checked_add(length)?;
            Some((cursor.bytes.get(start..end)?, end))
        };
        let (bytes, end) = content(self).ok_or(Event::InvalidBlock)?;
        self.at = end;
        Ok(Argument::Block(bytes.to_vec()))
    }
}

fn text_of(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap_or_default()
}
