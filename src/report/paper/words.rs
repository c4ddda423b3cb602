//! The verdicts in words.

use super::PaperPicture;
use crate::report::document::Part;
use crate::report::table;
use crate::studies::paper::tables::SpeedStudy;
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

fn tally(findings: &[ClaimFinding]) -> String {
    let count = |verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
    format!(
        "{} statements: {} agree, {} agree under a convention that the paper does not name, {} do not hold",
        findings.len(),
        count(ClaimVerdict::Agrees),
        count(ClaimVerdict::AgreesUnder),
        count(ClaimVerdict::DoesNotHold)
    )
}

/// The page that `paper` prints.
pub fn paper(study: &PaperStudy) -> String {
    let heading = ["statement", "paper", "here", "verdict", "by which convention"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(study.findings.iter().map(|finding| {
        vec![
            finding.item.clone(),
            printed(finding),
            number(finding.here, &finding.unit),
            finding.verdict.words().to_owned(),
            finding.convention.clone(),
        ]
    }));
    let mut page = vec!["Herbold et al. (2009), computed again".to_owned()];
    page.extend(table::lines(&rows, &[0, 3, 4]));
    page.push(String::new());
    page.push(tally(&study.findings));
    if let Some(tables) = &study.tables {
        page.push(String::new());
        page.extend(table::lines(&speeds_rows(tables), &[0]));
        page.push(best_dashpot(tables));
    }
    page.join("\n")
}

fn best_dashpot(study: &SpeedStudy) -> String {
    format!(
        "one dashpot in every contact fits the eight measured speeds best at {:.1} N s/m: rms {:.1} m/s, {:.1} m/s without losses",
        study.dashpot, study.rms_with_dashpot, study.rms_lossless
    )
}

/// The report's parts; pictures are files of the study's pictures, which stand beside.
pub fn paper_parts(study: &PaperStudy, pictures: &[PaperPicture]) -> Vec<Part> {
    let mut parts = vec![
        Part::Heading(1, "Herbold et al. (2009), computed again".to_owned()),
        Part::Paragraph(
            "E. B. Herbold, J. Kim, V. F. Nesterenko, S. Wang, C. Daraio, Tunable frequency band-gap and pulse propagation in a strongly nonlinear diatomic chain. \
             Every verdict is computed: a printed number agrees with one that rounds to it, or else does not; nothing is tuned. \
             Measured curves are pictures in the paper and are not drawn; measured speeds stand beside the best single dashpot."
                .to_owned(),
        ),
        Part::Paragraph(tally(&study.findings)),
        Part::Heading(2, "Statements".to_owned()),
        findings_table(&study.findings),
    ];
    if !study.slips.is_empty() {
        parts.push(Part::Heading(2, "Misprints".to_owned()));
        let slip = |slip: &Slip| format!("{}: {}", slip.place, slip.says);
        parts.push(Part::List(study.slips.iter().map(slip).collect()));
    }
    if let Some(tables) = &study.tables {
        parts.push(Part::Heading(2, "Tables 1 and 2".to_owned()));
        parts.push(Part::Paragraph(best_dashpot(tables)));
        parts.push(Part::Table(speeds_rows(tables)));
    }
    parts.push(Part::Heading(2, "Figures".to_owned()));
    for picture in pictures {
        let file = format!("{}.svg", picture.stem);
        parts.push(Part::Picture(file, picture.caption.clone(), picture.svg.clone()));
    }
    parts
}

fn findings_table(findings: &[ClaimFinding]) -> Part {
    let heading =
        ["statement", "place", "says", "paper", "here", "convention", "verdict", "reason"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(findings.iter().map(|finding| {
        vec![
            finding.item.clone(),
            finding.place.clone(),
            finding.says.clone(),
            printed(finding),
            number(finding.here, &finding.unit),
            finding.convention.clone(),
            finding.verdict.words().to_owned(),
            finding.reason.clone(),
        ]
    }));
    Part::Table(rows)
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
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(study.rows.iter().map(|row| {
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
        ]
    }));
    rows
}
