//! Windows: what a record is multiplied with before it is transformed.
//!
//! A record cut out of a longer signal has ends that do not meet; a window takes them to zero, and pays with wider lines.
//! All windows here are periodic cosine sums, `w[i] = sum over j of (-1)^j a[j] cos(2 pi j i/M)`, `i` from 0 to `M - 1`.
//! Source: F. J. Harris, Proc. IEEE 66, 51 (1978); flat top: G. Heinzel, A. Ruediger, R. Schilling, MPI report (2002), the
//! five-term window that Matlab and `SciPy` call `flattop`. Valid for any record of at least two samples.

use std::f64::consts::TAU;
use std::fmt;

/// A window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Window {
    /// None: the samples as they are, as the paper takes them. Right for pulses that end before the record does.
    #[default]
    Rectangular,
    /// Raised cosine: for lines close to each other in a signal that goes on.
    Hann,
    /// Flat top: reads a line's height to 0.05 %, wherever it falls between bins, and blurs it over ten of them.
    FlatTop,
}

const RECTANGULAR: [f64; 1] = [1.0];
const HANN: [f64; 2] = [0.5, 0.5];
const FLAT_TOP: [f64; 5] =
    [0.215_578_95, 0.416_631_58, 0.277_263_158, 0.083_578_947, 0.006_947_368];

impl Window {
    /// All windows.
    pub const ALL: [Self; 3] = [Self::Rectangular, Self::Hann, Self::FlatTop];

    /// Amplitudes of the cosines.
    fn terms(self) -> &'static [f64] {
        match self {
            Self::Rectangular => &RECTANGULAR,
            Self::Hann => &HANN,
            Self::FlatTop => &FLAT_TOP,
        }
    }

    /// The weight of sample `index` of `length` (1).
    pub fn weight(self, index: usize, length: usize) -> f64 {
        let angle = TAU * index as f64 / length.max(1) as f64;
        let mut sum = 0.0;
        let (mut order, mut sign) = (0.0, 1.0);
        for term in self.terms() {
            sum += sign * term * (order * angle).cos();
            order += 1.0;
            sign = -sign;
        }
        sum
    }

    /// Half the width of a line's main lobe, in units of the resolution `1/(M dt)` (1).
    pub fn half_lobe(self) -> f64 {
        match self {
            Self::Rectangular => 1.0,
            Self::Hann => 2.0,
            Self::FlatTop => 5.0,
        }
    }
}

impl fmt::Display for Window {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rectangular => "rectangular",
            Self::Hann => "Hann",
            Self::FlatTop => "flat top",
        })
    }
}
