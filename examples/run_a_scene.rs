//! Runs an included scene and reads first peaks, arrivals and speeds.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use hertzscope::{Scene, run_to_accuracy};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::load("magnet-0.61g")?;
    let outcome = run_to_accuracy(&scene, scene.accuracy, 1, &mut |_| ())?;
    for reading in &outcome.summary.sensors {
        if let (Some(peak), Some(half)) = (reading.first_peak, reading.half_rise_s) {
            let (name, force) = (&reading.name, peak.dynamic_n);
            println!("{name}: {force:.2} N, half of it after {:.2} us", 1e6 * half);
        }
    }
    for speed in outcome.summary.speeds.iter().filter(|speed| speed.estimator == "half_rise") {
        println!("particles {} to {}: {:.1} m/s", speed.from, speed.to, speed.m_per_s);
    }
    if let Some(error) = &outcome.summary.error_estimate {
        println!("peaks and arrivals to {:.0e}", error.worst());
    }
    // What the scope recorded: levels of its converter, with the scale to volts.
    for capture in &outcome.shot.captures {
        let waveform = &capture.waveform;
        let highest = waveform.codes.iter().copied().max().unwrap_or_default();
        println!("{}: highest sample {:.3} V", waveform.source, waveform.volts_of(highest));
    }
    Ok(())
}
