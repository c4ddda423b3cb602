//! Random draws and coverage.

/// Coverage factor of a normal distribution's 95 % (1).
pub const COVERAGE_95: f64 = 1.959_963_984_540_054;

/// How the Monte-Carlo part is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    /// Seed.
    pub seed: u64,
    /// Number of draws; 0 leaves the Monte-Carlo part out.
    pub count: usize,
}
