//! Random numbers: `xoshiro256**` (Blackman and Vigna 2018) and the polar method of Marsaglia.

/// A generator of random numbers.
pub struct Random {
    state: [u64; 4],
}

impl Random {
    /// A generator whose stream is fixed by `seed` (`splitmix64` fills the state).
    pub fn new(seed: u64) -> Self {
        let mut mixed = seed;
        let state = std::array::from_fn(|_| {
            mixed = mixed.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut value = mixed;
            value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            value ^ (value >> 31)
        });
        Self { state }
    }

    fn next(&mut self) -> u64 {
        let state = &mut self.state;
        let result = state[1].wrapping_mul(5).rotate_left(7).wrapping_mul(9);
        let shifted = state[1] << 17;
        state[2] ^= state[0];
        state[3] ^= state[1];
        state[1] ^= state[2];
        state[0] ^= state[3];
        state[2] ^= shifted;
        state[3] = state[3].rotate_left(45);
        result
    }

    /// A uniform number from `low` to `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.next() >> 11) as f64 * f64::EPSILON / 2.0;
        low + share * (high - low)
    }

    /// A normal number of mean zero and standard deviation one.
    pub fn normal(&mut self) -> f64 {
        loop {
            let (x, y) = (self.uniform(-1.0, 1.0), self.uniform(-1.0, 1.0));
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                return x * (-2.0 * square.ln() / square).sqrt();
            }
        }
    }
}

#[test]
fn moments_are_those_of_the_distributions() {
    let mut random = Random::new(1);
    let count = 200_000;
    let (mut first, mut second, mut fourth, mut uniform) = (0.0, 0.0, 0.0, 0.0);
    for _ in 0..count {
        let x = random.normal();
        first += x;
        second += x * x;
        fourth += x.powi(4);
        uniform += random.uniform(0.0, 1.0).powi(2);
    }
    // Four standard errors: 1, sqrt(2), sqrt(96) and sqrt(4/45) over the root of the count.
    let limit = 4.0 / f64::from(count).sqrt();
    let mean = |sum: f64| sum / f64::from(count);
    assert!(mean(first).abs() < limit);
    assert!((mean(second) - 1.0).abs() < limit * 2_f64.sqrt());
    assert!((mean(fourth) - 3.0).abs() < limit * 96_f64.sqrt());
    assert!((mean(uniform) - 1.0 / 3.0).abs() < limit * (4.0_f64 / 45.0).sqrt());
}
