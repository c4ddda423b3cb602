//! How waveforms travel: the settings of `DATa`, and the preamble that comes with a waveform sent
//! in.

use crate::scope::waveform::FAMILY_BITS;
use crate::scope::word::words;
use crate::scope::{PointFormat, Source};

words! {
    /// Encoding of a curve: one view of [`Transfer`]'s ASCII, sign and byte order.
    Encoding {
        /// Numbers as text.
        Ascii = "ASCIi",
        /// Signed, high byte first.
        SignedHighFirst = "RIBinary",
        /// Positive, high byte first.
        PositiveHighFirst = "RPBinary",
        /// Signed, low byte first.
        SignedLowFirst = "SRIbinary",
        /// Positive, low byte first.
        PositiveLowFirst = "SRPbinary",
    }

    /// Whether a curve is text.
    CurveFormat {
        /// Numbers as text.
        Ascii = "ASC",
        /// A block of bytes.
        Binary = "BIN",
    }

    /// Whether levels have a sign.
    NumberFormat {
        /// Signed.
        Signed = "RI",
        /// From zero.
        Positive = "RP",
    }

    /// Order of two bytes.
    ByteOrder {
        /// High byte first.
        HighFirst = "MSB",
        /// Low byte first.
        LowFirst = "LSB",
    }

    /// Encoding of a waveform's points.
    Points {
        /// One sample each.
        Samples = "Y",
        /// Lowest and highest in turn.
        Envelope = "ENV",
    }
}

impl From<Points> for PointFormat {
    fn from(points: Points) -> Self {
        match points {
            Points::Samples => Self::Sample,
            Points::Envelope => Self::Envelope,
        }
    }
}

/// Bits of a point of one byte.
const BITS_OF_BYTE: i32 = 8;
/// Offset of a positive point of one byte (1).
const BYTE_OFFSET: f64 = 128.0;

/// Settings of `DATa`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transfer {
    /// Text or block.
    pub format: CurveFormat,
    /// Signed or positive.
    pub numbers: NumberFormat,
    /// Order of bytes.
    pub byte_order: ByteOrder,
    /// Bytes in a point, 1 or 2.
    pub width: usize,
    /// The waveform that is sent out.
    pub source: Source,
    /// The reference memory that takes waveforms in.
    pub destination: Source,
    /// First point, counted from 1.
    pub start: usize,
    /// Last point, counted from 1.
    pub stop: usize,
}

impl Transfer {
    /// The settings after `DATa INIT`, for records of `points`.
    pub fn initial(points: usize) -> Self {
        Self {
            format: CurveFormat::Binary,
            numbers: NumberFormat::Signed,
            byte_order: ByteOrder::HighFirst,
            width: 1,
            source: Source::Channel(1),
            destination: Source::Reference('A'),
            start: 1,
            stop: points,
        }
    }

    /// Text, sign and byte order in one word.
    pub fn encoding(&self) -> Encoding {
        match (self.format, self.numbers, self.byte_order) {
            (CurveFormat::Ascii, ..) => Encoding::Ascii,
            (_, NumberFormat::Signed, ByteOrder::HighFirst) => Encoding::SignedHighFirst,
            (_, NumberFormat::Positive, ByteOrder::HighFirst) => Encoding::PositiveHighFirst,
            (_, NumberFormat::Signed, ByteOrder::LowFirst) => Encoding::SignedLowFirst,
            (_, NumberFormat::Positive, ByteOrder::LowFirst) => Encoding::PositiveLowFirst,
        }
    }

    /// Sets text, sign and byte order; text leaves the other two as they are.
    pub fn set_encoding(&mut self, encoding: Encoding) {
        let (numbers, byte_order) = match encoding {
            Encoding::Ascii => {
                self.format = CurveFormat::Ascii;
                return;
            }
            Encoding::SignedHighFirst => (NumberFormat::Signed, ByteOrder::HighFirst),
            Encoding::PositiveHighFirst => (NumberFormat::Positive, ByteOrder::HighFirst),
            Encoding::SignedLowFirst => (NumberFormat::Signed, ByteOrder::LowFirst),
            Encoding::PositiveLowFirst => (NumberFormat::Positive, ByteOrder::LowFirst),
        };
        (self.format, self.numbers, self.byte_order) = (CurveFormat::Binary, numbers, byte_order);
    }

    /// Steps of a sent point in a level of a converter of `bits`, whose highest bit is the point's
    /// (1).
    pub fn steps(&self, bits: u8) -> f64 {
        f64::from(self.bits() - i32::from(bits)).exp2()
    }

    /// Bits of a point.
    fn bits(&self) -> i32 {
        if self.width == 2 { 2 * BITS_OF_BYTE } else { BITS_OF_BYTE }
    }

    /// Offset of sent points: positive numbers begin at the lowest level, text is signed (1).
    pub fn offset(&self) -> f64 {
        if self.format == CurveFormat::Ascii { 0.0 } else { self.binary_offset() }
    }

    /// The same for blocks (1).
    pub fn binary_offset(&self) -> f64 {
        let is_positive = self.numbers == NumberFormat::Positive;
        if is_positive { BYTE_OFFSET * self.steps(FAMILY_BITS) } else { 0.0 }
    }

    /// First and last point of a record of `points` that are sent, as indices in the right order.
    pub fn range(&self, points: usize) -> std::ops::Range<usize> {
        let (low, high) = (self.start.min(self.stop), self.start.max(self.stop));
        low.saturating_sub(1).min(points)..high.min(points)
    }
}

/// The preamble that the next waveform sent in will have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Incoming {
    /// Points in it.
    pub nr_pt: usize,
    /// Sample or envelope.
    pub pt_fmt: Points,
    /// From one point to the next (s).
    pub x_incr: f64,
    /// Time of the first point (s).
    pub x_zero: f64,
    /// One level (V).
    pub y_mult: f64,
    /// Value added after scaling (V).
    pub y_zero: f64,
    /// Level of zero volts (1).
    pub y_off: f64,
    /// One step of the abscissa in XY, which is kept and told (V).
    pub x_mult: f64,
}

impl Incoming {
    /// A record of `points` at the factory's scales.
    pub fn initial(points: usize) -> Self {
        Self {
            nr_pt: points,
            pt_fmt: Points::Samples,
            x_incr: 2e-6,
            x_zero: -2.5e-3,
            y_mult: 0.04,
            y_zero: 0.0,
            y_off: 0.0,
            x_mult: 0.04,
        }
    }
}
