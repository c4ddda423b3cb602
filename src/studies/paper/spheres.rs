//! Figs 4 to 7: the top sphere of a long pressed chain is given a speed, once small, once large.

use super::ForceLocation;
use super::dispersion::cell;
use super::record::{ForceRecord, WIDTH_SHARE, nothing, power_between, share_between};
use super::verdict::ClaimResult;
use super::{Arrangement, Figure, IntermediateResults, PaperError, record_run};
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::Spectrum;
use crate::scene::Scene;

/// Top contact, particles of the figures, and the other particle of the sixth cell.
const TOP: ForceLocation = ForceLocation::Below(1);
const SIXTH_CELL: [ForceLocation; 2] = [ForceLocation::Inside(11), ForceLocation::Inside(12)];
const NEAR: [ForceLocation; 3] = [TOP, ForceLocation::Inside(5), ForceLocation::Inside(11)];
const FAR: [ForceLocation; 3] =
    [ForceLocation::Inside(51), ForceLocation::Inside(101), ForceLocation::Inside(151)];
/// Where the leading pulse and the group behind it are told apart: at what particle, and when (s).
const PULSE_SEPARATION: ForceLocation = ForceLocation::Inside(101);
const PARTS: [(f64, f64); 2] = [(0.0, 7e-3), (7e-3, 12e-3)];
/// The component of Fig. 7 (Hz).
const FIGURE_7_FREQUENCY: f64 = 3e3;
/// A line lower than this share of the main one is none that a reader sees (1).
const VISIBLE_SHARE: f64 = 0.1;
/// Contacts near the struck end, the least compressed of which tells whether all stay closed.
const CONTACTS: [ForceLocation; 3] = [TOP, ForceLocation::Below(2), ForceLocation::Below(3)];
/// Length and distance of the windows in which the slow packet is looked for (s).
const PACKET_WINDOWS: (f64, f64) = (1e-3, 0.05e-3);
/// First and last part of the record in which the source is looked for (s).
const SOURCE_WINDOWS: [(f64, f64); 2] = [(0.0, 5e-3), (10e-3, 15e-3)];

/// A run of one of the two scenes.
struct Sphere {
    record: ForceRecord,
    chain: DiatomicChain,
    /// Static force (N).
    force: f64,
    /// Leading pulse and trailing group.
    parts: [Spectrum; 2],
}

/// Figs 4 and 5, 6 and 7.
pub(super) fn figures(
    wanted: &dyn Fn(u8) -> bool,
    found: &mut IntermediateResults,
) -> Result<(), PaperError> {
    for (scene, near, answer) in [
        ("linear-300-cells", 4, linear as fn(&Sphere) -> Result<Vec<ClaimResult>, PaperError>),
        ("nonlinear-300-cells", 6, nonlinear),
    ] {
        if !wanted(near) && !wanted(near + 1) {
            continue;
        }
        let sphere = Sphere::run(&Scene::load(scene)?)?;
        found.answers.extend(answer(&sphere)?);
        for (number, arrangement, places) in
            [(near, Arrangement::Rows, NEAR), (near + 1, Arrangement::Far, FAR)]
        {
            if wanted(number) {
                found.figures.push(sphere.figure(number, arrangement, &places)?);
            }
        }
    }
    Ok(())
}

impl Sphere {
    fn run(scene: &Scene) -> Result<Self, PaperError> {
        let others = [SIXTH_CELL[1], ForceLocation::Inside(21)];
        let places = [&NEAR[..], &FAR, &others, &CONTACTS[1..]].concat();
        let record = ForceRecord::of(scene, &places)?;
        let (chain, force) = cell(scene, 5)?;
        let part = |(from, to): (f64, f64)| record.spectrum(PULSE_SEPARATION, from, to);
        let parts = [part(PARTS[0])?, part(PARTS[1])?];
        Ok(Self { record, chain, force, parts })
    }

    fn figure(
        &self,
        number: u8,
        arrangement: Arrangement,
        places: &[ForceLocation],
    ) -> Result<Figure, PaperError> {
        let signals: Result<Vec<_>, _> = places.iter().map(|p| self.record.signal(*p)).collect();
        let signals = signals?;
        let kind = if number < 6 { "Linear" } else { "Nonlinear" };
        let where_ =
            if arrangement == Arrangement::Rows { "near the end" } else { "far from the end" };
        let named = |((from, to), spectrum): ((f64, f64), &Spectrum)| {
            let name = format!("{:.0} to {:.0} ms", 1e3 * from, 1e3 * to);
            (name, spectrum.clone())
        };
        let far = arrangement == Arrangement::Far;
        let parts = PARTS.into_iter().zip(&self.parts).filter(|_| far).map(named).collect();
        Ok(Figure {
            number,
            title: format!("{kind} chain of 300 cells, {where_}"),
            arrangement,
            chain: self.chain,
            run: Some(record_run(&self.record.scene, &signals)?),
            signals,
            parts,
        })
    }

    /// Static force over `force` (1).
    fn ratio(&self, force: f64) -> f64 {
        self.force / force
    }

    /// Amplitude of the top contact's force and what the paper may have called so.
    fn amplitude(&self, item: &str, value: &dyn Fn(f64) -> f64) -> Result<ClaimResult, PaperError> {
        let contact = self.record.first_peak(TOP)?.dynamic_n;
        let top = self.record.trace(TOP)?;
        let (low, high) =
            top.values.iter().fold((0.0, 0.0), |(l, h): (f64, f64), v| (l.min(*v), h.max(*v)));
        Ok(ClaimResult::to(item)
            .or("inside the top sphere, half of the contact", value(0.5 * contact))
            .or("half of peak to peak inside the top sphere", value(0.25 * (high - low)))
            .plain("in the contact", value(contact)))
    }

    /// Least overlap of the contacts near the struck end over the static one, by Hertz's law (1).
    fn least_overlap(&self) -> Result<f64, PaperError> {
        let mut least = f64::INFINITY;
        for place in CONTACTS {
            let lowest = self.record.trace(place)?.values.iter().copied().fold(0.0, f64::min);
            least = least.min(1.0 + lowest / self.force);
        }
        Ok(least.max(0.0).powf(2.0 / 3.0))
    }

    /// Speed of the packet from the optical branch over that of the leading pulse, from particle 51
    /// to 101: when the branch has most power in a window.
    fn packet(&self, item: &str) -> Result<ClaimResult, PaperError> {
        let [from, to] = [FAR[0], FAR[1]];
        let (length, step) = PACKET_WINDOWS;
        let (f2, f3) = (self.chain.gap_top(), self.chain.cutoff());
        let strongest = |place: ForceLocation| -> Result<f64, PaperError> {
            let (mut best, mut at) = (0.0, 0.0);
            let mut start = 0.0;
            while start + length < self.record.scene.duration {
                let part = self.record.windowed(place, start, start + length)?;
                let power = power_between(&part, f2, f3);
                if power > best {
                    (best, at) = (power, start);
                }
                start += step;
            }
            Ok(at)
        };
        let packet = strongest(to)? - strongest(from)?;
        let leading = self.record.half_rise(to)? - self.record.half_rise(from)?;
        Ok(ClaimResult::to(item).plain(
            "most power of the optical branch in 1 ms, particles 51 to 101, over the half-rises'",
            leading / packet,
        ))
    }

    /// First pulse of the sixth cell and what the paper may have called so.
    fn first_pulse(
        &self,
        item: &str,
        value: &dyn Fn(f64) -> f64,
    ) -> Result<ClaimResult, PaperError> {
        let [upper, lower] = SIXTH_CELL;
        let peaks = [upper, lower].map(|place| self.record.first_peak(place));
        let [first, second] = peaks.map(|peak| peak.map(|peak| peak.dynamic_n));
        let (first, second) = (first?, second?);
        Ok(ClaimResult::to(item).plain("inside particle 11", value(first)).or(
            "mean of the first peaks inside particles 11 and 12",
            value(0.5 * (first + second)),
        ))
    }

    /// Width inside `particle` in cells at the long waves' speed.
    fn width(&self, item: &str, particle: usize) -> Result<ClaimResult, PaperError> {
        let cells = |foot: f64| {
            let time = self.record.width(ForceLocation::Inside(particle), foot)?;
            Ok::<_, PaperError>(time * self.chain.sound_speed() / self.chain.cell)
        };
        let convention = format!(
            "inside particle {particle}, from 0.5 % of the first peak to the first minimum, times the speed of long waves"
        );
        let later = cells(2.0 * WIDTH_SHARE)?;
        let note = format!(
            "the paper does not say where a pulse begins: from 1 % on it is {later:.2} cells"
        );
        Ok(ClaimResult::to(item).or(&convention, cells(WIDTH_SHARE)?).note(note))
    }

    fn highest(&self, spectrum: &Spectrum, low: f64, high: f64) -> Result<(f64, f64), PaperError> {
        let highest = spectrum.highest_between(low, high);
        let (bin, amplitude) = highest.ok_or_else(|| nothing(&self.record.scene, "line"))?;
        Ok((spectrum.frequency(bin), amplitude))
    }

    /// Highest line of the trailing group around the gap's lower edge (Hz).
    fn trailing_bottom(&self) -> Result<f64, PaperError> {
        let f1 = self.chain.gap_bottom();
        Ok(self.highest(&self.parts[1], 0.5 * f1, 1.5 * f1)?.0)
    }
}

const HIGHEST_LINE: &str = "highest line";

fn linear(sphere: &Sphere) -> Result<Vec<ClaimResult>, PaperError> {
    let Sphere { record, chain, parts, .. } = sphere;
    let (f1, f2, f3) = (chain.gap_bottom(), chain.gap_top(), chain.cutoff());
    let source = record.signal(TOP)?.spectrum;
    let line_at = |place: ForceLocation| -> Result<f64, PaperError> {
        Ok(sphere.highest(&record.signal(place)?.spectrum, f1, f2)?.1)
    };
    let [early, late] = SOURCE_WINDOWS.map(|(from, to)| {
        record.spectrum(TOP, from, to).and_then(|part| Ok(sphere.highest(&part, f1, f2)?.1))
    });
    let left = 2.0 * line_at(ForceLocation::Inside(11))? / line_at(TOP)?;
    let fifth = record.signal(ForceLocation::Inside(5))?.spectrum;
    let (upper, (_, main)) = (sphere.highest(&fifth, f2, f3)?, sphere.highest(&fifth, 1.0, f3)?);
    let mode = format!(
        "it is the mode of a light end at {:.2} kHz, which falls by m/M = {:.3} a cell, never enters the chain and stays at its end; at particle 11 the line has {:.2} % of its height inside the top sphere",
        1e-3 * chain.surface_mode(),
        chain.light_mass / chain.heavy_mass,
        100.0 * left
    );
    Ok(vec![
        sphere.amplitude("linear_amplitude", &|force| force)?,
        sphere.amplitude("linear_amplitude_ratio", &|force| sphere.ratio(force))?,
        ClaimResult::to("linear_source_line").plain(HIGHEST_LINE, sphere.highest(&source, 1.0, f3)?.0),
        ClaimResult::to("linear_source_in_gap")
            .plain("squared amplitudes up to 20 kHz", share_between(&source, f1, f2)),
        ClaimResult::to("linear_source_transformed")
            .plain("height of the line in the top contact", late? / early?)
            .note(mode),
        ClaimResult::to("linear_source_gone").plain("height of the line inside particle 11 over that inside the top sphere", left),
        sphere.first_pulse("linear_first_pulse", &|force| force)?,
        sphere.first_pulse("linear_first_pulse_ratio", &|force| sphere.ratio(force))?,
        sphere.width("linear_width_5", 5)?,
        sphere.width("linear_width_cell_6", 11)?,
        sphere.width("linear_width_11", 11)?,
        sphere.width("linear_width_21", 21)?,
        ClaimResult::to("linear_upper_line")
            .plain("highest line above the gap", upper.0)
            .only_if(upper.1 >= VISIBLE_SHARE * main)
            .note(format!(
                "it has {:.1} % of the main line's height, too little for a main frequency; the optical branch goes from {:.2} to {:.2} kHz, and the line stands in its middle",
                100.0 * upper.1 / main,
                1e-3 * f2,
                1e-3 * f3
            )),
        sphere.packet("linear_slow_packet")?,
        ClaimResult::to("linear_leading_below_gap")
            .plain("squared amplitudes up to 20 kHz", share_between(&parts[0], 0.0, f1)),
        ClaimResult::to("linear_trailing_bottom").plain(HIGHEST_LINE, sphere.trailing_bottom()?),
        ClaimResult::to("linear_trailing_top")
            .plain("highest line above the gap", sphere.highest(&parts[1], f2, f3)?.0)
            .note("what has the top of the gap's frequency itself does not travel: at particle 101 the optical branch arrives from its middle"),
    ])
}

fn nonlinear(sphere: &Sphere) -> Result<Vec<ClaimResult>, PaperError> {
    let trailing = &sphere.parts[1];
    let (_, main) = sphere.highest(trailing, 1.0, sphere.chain.cutoff())?;
    let (leading, _) = sphere.highest(&sphere.parts[0], 1.0, 5e3)?;
    let (upper, height) =
        sphere.highest(trailing, sphere.chain.gap_top(), sphere.chain.cutoff())?;
    let half = 0.5 * trailing.step;
    let (_, extra) =
        sphere.highest(trailing, FIGURE_7_FREQUENCY - half, FIGURE_7_FREQUENCY + half)?;
    Ok(vec![
        sphere.amplitude("nonlinear_amplitude_ratio", &|force| sphere.ratio(force))?,
        sphere.first_pulse("nonlinear_first_pulse", &|force| force)?,
        sphere.first_pulse("nonlinear_first_pulse_ratio", &|force| sphere.ratio(force))?,
        sphere.width("nonlinear_width_cell_6", 11)?,
        sphere.width("nonlinear_width_21", 21)?,
        ClaimResult::to("nonlinear_3_khz")
            .plain("height at 3 kHz over the highest line", extra / main)
            .note(format!(
                "it is the flank of the main line, as in the linear chain; the leading pulse's spectrum, flat there, is highest at {:.1} kHz here",
                1e-3 * leading
            )),
        ClaimResult::to("nonlinear_trailing_bottom").plain(HIGHEST_LINE, sphere.trailing_bottom()?),
        ClaimResult::to("nonlinear_trailing_top")
            .plain("highest line above the gap", upper)
            .note(format!("it is {:.1} mN high", 1e3 * height)),
        ClaimResult::to("nonlinear_contact")
            .plain("least compressed of the first three contacts", sphere.least_overlap()?),
        sphere.packet("nonlinear_slow_packet")?,
    ])
}
