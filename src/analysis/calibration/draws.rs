//! Random draws.

/// How the Monte-Carlo part is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    /// Seed.
    pub seed: u64,
    /// Number of draws; 0 leaves the Monte-Carlo part out.
    pub count: usize,
}
