//! What a laboratory adds to a signal: mains hum, drift, 1/f noise, white noise, and the high pass
//! of AC coupling.

use super::Random;
use std::f64::consts::TAU;

/// Disturbances of one channel; amplitudes in divisions, so that they go with the scope's range.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disturbance {
    /// Standard deviation of white noise (div)
    pub white: f64,
    /// Amplitude of hum at the mains frequency; its phase is drawn for each record (div)
    pub hum: f64,
    /// Mains frequency (Hz); 50 if zero
    pub hum_frequency: f64,
    /// Largest drift over the whole record; its slope is drawn for each record (div)
    pub drift: f64,
    /// Standard deviation of 1/f noise within one record (div)
    pub pink: f64,
    /// Lower limit of AC coupling (Hz), zero for DC coupling
    pub high_pass: f64,
    /// Largest error of the zero; drawn for each record (div)
    pub zero: f64,
}

impl Disturbance {
    /// White noise alone (div).
    pub fn white(white: f64) -> Self {
        Self { white, ..Self::default() }
    }

    /// Adds everything to `samples` (div), which are `interval` (s) apart and at rest before the
    /// first one.
    pub fn add(&self, samples: &mut [f64], interval: f64, random: &mut Random) {
        if self.high_pass > 0.0 {
            high_pass(samples, interval, self.high_pass);
        }
        let count = samples.len();
        let frequency = if self.hum_frequency > 0.0 { self.hum_frequency } else { 50.0 };
        let phase = random.uniform(0.0, TAU);
        let slope = random.uniform(-self.drift, self.drift);
        let zero = random.uniform(-self.zero, self.zero);
        let pink = if self.pink > 0.0 { pink(count, random) } else { vec![0.0; count] };
        for (index, (sample, pink)) in samples.iter_mut().zip(pink).enumerate() {
            let time = index as f64 * interval;
            *sample += self.hum * (TAU * frequency * time + phase).sin()
                + slope * index as f64 / count as f64
                + zero
                + self.pink * pink
                + self.white * random.normal();
        }
    }
}

/// A first-order high pass at `corner` (Hz): exact for inputs that are linear between samples.
fn high_pass(samples: &mut [f64], interval: f64, corner: f64) {
    let tau = 1.0 / (TAU * corner);
    let decay = (-interval / tau).exp();
    let (mut input, mut output) = (0.0, 0.0);
    for sample in samples {
        output = decay * output + (*sample - input) * tau / interval * (1.0 - decay);
        input = *sample;
        *sample = output;
    }
}

/// Noise whose power density is 1/f from the record's length to the sample interval, with mean zero
/// and standard deviation one within the record.
///
/// A sum of Ornstein-Uhlenbeck processes of equal variance, four in each octave of their time
/// constants (van der Ziel 1950).
fn pink(count: usize, random: &mut Random) -> Vec<f64> {
    let octaves = (count as f64).log2().ceil() as i32 + 2;
    let mut samples = vec![0.0; count];
    for step in -4..4 * octaves {
        let decay = (-1.0 / 2_f64.powf(f64::from(step) / 4.0)).exp();
        let kick = (1.0 - decay * decay).sqrt();
        let mut value = random.normal();
        for sample in &mut samples {
            *sample += value;
            value = decay * value + kick * random.normal();
        }
    }
    let mean = samples.iter().sum::<f64>() / count as f64;
    let square = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count as f64;
    samples.iter().map(|x| (x - mean) / square.sqrt()).collect()
}

#[test]
fn a_step_decays_with_the_high_pass() {
    let (interval, corner) = (1e-5, 7.0);
    let mut samples = vec![1.0; 2000];
    high_pass(&mut samples, interval, corner);
    // The step itself is a ramp of one interval; after that exp(-t / tau), from its middle on.
    let expected = (-1999.5 * interval * TAU * corner).exp();
    assert!((samples[1999] - expected).abs() < 1e-6, "{} {expected}", samples[1999]);
}

#[test]
fn each_octave_of_pink_noise_has_the_same_power() {
    // Differences of means over neighbouring blocks (the Haar variance) are the same for all
    // blocks.
    let mut random = Random::new(7);
    let mut variance = [0.0; 5];
    for _ in 0..200 {
        let samples = pink(4096, &mut random);
        for (level, variance) in variance.iter_mut().enumerate() {
            let block = 8 << level;
            let means: Vec<f64> = samples
                .chunks(block)
                .map(|block| block.iter().sum::<f64>() / block.len() as f64)
                .collect();
            let differences = means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
            *variance += differences.sum::<f64>() / means.len() as f64;
        }
    }
    let mean = variance.iter().sum::<f64>() / 5.0;
    for variance in variance {
        assert!((variance / mean - 1.0).abs() < 0.15, "{variance} of {mean}");
    }
}
