//! The verdicts in words.

use std::fmt::Write as _;

use super::PaperPicture;
use crate::experiment::paper_speeds::PaperSpeed;
use crate::quantity::Uncertain;
use crate::report::page::Part;
use crate::report::table;
use crate::studies::paper::tables::{SpeedRow, SpeedStudy};
use crate::studies::paper::{ClaimFinding, ClaimVerdict, PaperStudy, PrintedValue, Slip};

/// Five significant digits: band edges are printed with as many.
fn number(value: f64, unit: &str) -> String {
    let digits: f64 = format!("{value:.4e}").parse().unwrap_or(value);
    format!("{digits} {unit}").trim_end().to_owned()
}

fn printed(finding: &ClaimFinding) -> String {
    match &finding.paper {
        PrintedValue::Number(value) => format!("{value} {}", finding.unit).trim_end().to_owned(),
        PrintedValue::Words(words) => words.clone(),
    }
}

/// The paper's calculations, then its own measurements: claims that a calculation can hold against,
/// and data.
fn split(findings: &[ClaimFinding]) -> [Vec<&ClaimFinding>; 2] {
    let (measured, calculated) = findings.iter().partition(|finding| finding.measured);
    [calculated, measured]
}

fn tally(findings: &[ClaimFinding]) -> String {
    let [calculated, measured] = split(findings);
    let count = |verdict| calculated.iter().filter(|finding| finding.verdict == verdict).count();
    let mut text = format!(
        "{} statements: {} agree, {} agree under a convention that the paper does not name, {} do not hold",
        calculated.len(),
        count(ClaimVerdict::Agrees),
        count(ClaimVerdict::AgreesUnder),
        count(ClaimVerdict::DoesNotHold)
    );
    if !measured.is_empty() {
        let _ = write!(text, "; {} numbers that it measured stand apart", measured.len());
    }
    text
}

/// `+1.3 %`: how far the computed number is from the printed one.
fn difference(finding: &ClaimFinding) -> String {
    finding.difference.map_or("-".to_owned(), |off| format!("{:+.1} %", 100.0 * off))
}

/// The page that `paper` prints.
pub fn paper(study: &PaperStudy) -> String {
    let mut page = vec!["Herbold et al. (2009), recomputed".to_owned()];
    let [calculated, measured] = split(&study.findings);
    for (title, findings) in [("statement", calculated), ("measured by the paper", measured)] {
        if findings.is_empty() {
            continue;
        }
        if title != "statement" {
            page.push(String::new());
        }
        let heading = [title, "paper", "here", "differs by", "verdict", "convention"];
        let rows = table::titled(
            heading,
            findings.into_iter().map(|finding| {
                vec![
                    finding.item.clone(),
                    printed(finding),
                    number(finding.here, &finding.unit),
                    difference(finding),
                    finding.verdict.words().to_owned(),
                    finding.convention.clone(),
                ]
            }),
        );
        page.extend(table::lines(&rows, &[0, 4, 5]));
    }
    page.push(String::new());
    page.push(tally(&study.findings));
    if let Some(tables) = &study.tables {
        page.push(String::new());
        page.extend(table::lines(&speeds_rows(tables), &[0]));
        page.push(best_dashpot(tables));
        page.push(String::new());
        page.extend(table::lines(&interval_rows(tables), &[0]));
        page.push(agreement(tables));
    }
    page.join("\n")
}

/// Tables 1 and 2 with intervals on both sides: normalised errors by half-rise and first peak.
fn interval_rows(study: &SpeedStudy) -> Vec<Vec<String>> {
    let heading = ["m/s, ± is 95 %", "half-rise", "peak", "numerics", "E_n", "experiment", "E_n"];
    table::titled(
        heading,
        study.rows.iter().map(|row| {
            let shown = |speed: Uncertain| format!("{:.1} ± {:.1}", speed.value, speed.expanded());
            let paper = |printed: f64| {
                let [half_rise, peak] = row.normalised_errors(printed);
                [format!("{printed} ± 0.5"), format!("{half_rise:.1}, {peak:.1}")]
            };
            let [numerics, numerics_error] = paper(row.paper.numerics_m_per_s);
            let [experiment, experiment_error] = paper(row.paper.experiment_m_per_s);
            let here = [shown(row.half_rise), shown(row.peak)];
            let row = [row.paper.scene.clone()].into_iter().chain(here);
            row.chain([numerics, numerics_error, experiment, experiment_error]).collect()
        }),
    )
}

fn agreement(study: &SpeedStudy) -> String {
    let agrees = |printed: fn(&PaperSpeed) -> f64, estimator: usize| {
        let holds = |row: &&SpeedRow| row.normalised_errors(printed(&row.paper))[estimator] <= 1.0;
        study.rows.iter().filter(holds).count()
    };
    let [numerics, experiment] =
        [|row: &PaperSpeed| row.numerics_m_per_s, |row: &PaperSpeed| row.experiment_m_per_s]
            .map(|of| [agrees(of, 0), agrees(of, 1)]);
    format!(
        "E_n by half-rise, by peak; up to 1 both sides agree within what the paper states: of {} calculated speeds {} by half-rise and {} by peak, of the measured ones {} and {}",
        study.rows.len(),
        numerics[0],
        numerics[1],
        experiment[0],
        experiment[1]
    )
}

fn best_dashpot(study: &SpeedStudy) -> String {
    format!(
        "one dashpot in every contact fits the eight measured speeds best at {:.1} N s/m: rms {:.1} m/s, {:.1} m/s without losses; contacts that yield by the materials' strengths change the calculated speeds by {}",
        study.dashpot,
        study.rms_with_dashpot,
        study.rms_lossless,
        yielding_changes(study)
    )
}

/// What plasticity does to the half-rise speeds: the least and the largest change.
fn yielding_changes(study: &SpeedStudy) -> String {
    let change = |row: &SpeedRow| row.yielding.half_rise / row.lossless.half_rise - 1.0;
    let changes = study.rows.iter().map(change);
    let (least, most) =
        changes.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), c| (l.min(c), m.max(c)));
    format!("{:+.1} % to {:+.1} %", 100.0 * least, 100.0 * most)
}

/// The report's parts; pictures are files of the study's pictures, which stand beside.
pub fn paper_parts(study: &PaperStudy, pictures: &[PaperPicture]) -> Vec<Part> {
    let [calculated, measured] = split(&study.findings);
    let mut parts = vec![
        Part::Heading(1, "Herbold et al. (2009), recomputed".to_owned()),
        Part::Paragraph(
            "E. B. Herbold, J. Kim, V. F. Nesterenko, S. Wang, C. Daraio, Tunable frequency band-gap and pulse propagation in a strongly nonlinear diatomic chain. \
             Every verdict is computed: a printed number agrees with one that rounds to it, a line with one that its record does not tell from it; nothing is tuned. \
             What the paper measured is no claim about a calculation and is listed apart. \
             Measured curves are pictures in the paper and are not drawn; measured speeds stand beside the best single dashpot."
                .to_owned(),
        ),
        Part::Paragraph(tally(&study.findings)),
        Part::Heading(2, "Statements".to_owned()),
        findings_table(&calculated),
    ];
    if !measured.is_empty() {
        parts.push(Part::Heading(2, "What the paper measured".to_owned()));
        parts.push(findings_table(&measured));
    }
    if !study.slips.is_empty() {
        parts.push(Part::Heading(2, "Misprints".to_owned()));
        let slip = |slip: &Slip| format!("{}: {}", slip.place, slip.says);
        parts.push(Part::List("misprint", study.slips.iter().map(slip).collect()));
    }
    if let Some(tables) = &study.tables {
        parts.push(Part::Heading(2, "Tables 1 and 2".to_owned()));
        parts.push(Part::Paragraph(best_dashpot(tables)));
        parts.push(Part::Table(speeds_rows(tables), &[0]));
        parts.push(Part::Paragraph(agreement(tables)));
        parts.push(Part::Table(interval_rows(tables), &[0]));
    }
    parts.push(Part::Heading(2, "Figures".to_owned()));
    for picture in pictures {
        let file = format!("{}.svg", picture.stem);
        parts.push(Part::Picture(file, picture.caption.clone(), picture.sheet.clone()));
    }
    parts
}

fn findings_table(findings: &[&ClaimFinding]) -> Part {
    let heading = [
        "statement",
        "place",
        "says",
        "paper",
        "here",
        "differs by",
        "convention",
        "verdict",
        "reason",
    ];
    let rows = table::titled(
        heading,
        findings.iter().map(|finding| {
            vec![
                finding.item.clone(),
                finding.place.clone(),
                finding.says.clone(),
                printed(finding),
                number(finding.here, &finding.unit),
                difference(finding),
                finding.convention.clone(),
                finding.verdict.words().to_owned(),
                finding.reason.clone(),
            ]
        }),
    );
    Part::Table(rows, &[0])
}

/// Tables 1 and 2 with what comes out here; speeds from particle 14 to 27 in m/s.
fn speeds_rows(study: &SpeedStudy) -> Vec<Vec<String>> {
    let heading = [
        "m/s",
        "experiment",
        "numerics",
        "half-rise",
        "peak",
        "half-rise, dashpot",
        "peak, dashpot",
        "change by it",
        "left to experiment",
        "half-rise, yielding",
    ];
    table::titled(
        heading,
        study.rows.iter().map(|row| {
            let (paper, plain, lossy) = (&row.paper, &row.lossless, &row.with_dashpot);
            let speed = |v: f64| format!("{v:.1}");
            let change = |from: f64, to: f64| format!("{:+.1} %", 100.0 * (to / from - 1.0));
            vec![
                paper.scene.clone(),
                paper.experiment_m_per_s.to_string(),
                paper.numerics_m_per_s.to_string(),
                speed(plain.half_rise),
                speed(plain.peak),
                speed(lossy.half_rise),
                speed(lossy.peak),
                change(plain.half_rise, lossy.half_rise),
                change(paper.experiment_m_per_s, lossy.half_rise),
                speed(row.yielding.half_rise),
            ]
        }),
    )
}
