//! Pictures in both formats, and the folder that `paper` fills.

use super::{QUICK, files, hertzscope, printed, refused, says, temporary};

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

#[test]
fn plots_are_svg_or_png_by_their_ending() {
    let folder = temporary();
    printed(folder.path(), &["bands", "--plot", "gap.svg"]);
    printed(folder.path(), &["bands", "--plot", "gap.png"]);
    let svg = std::fs::read_to_string(folder.path().join("gap.svg")).expect("an SVG");
    assert!(svg.starts_with("<svg") && svg.contains("preload"));
    let png = std::fs::read(folder.path().join("gap.png")).expect("a PNG");
    assert!(png.starts_with(PNG) && png.len() > 5_000, "{} bytes", png.len());
    let words = refused(folder.path(), &["bands", "--plot", "gap.jpg"]);
    says(&words, &["gap.jpg", "expected a name that ends in .svg or .png"]);
    assert_eq!(files(folder.path()), ["gap.png", "gap.svg"]);
}

/// A run's picture has all channels; on dark its hues stay, white and black change places.
#[test]
fn runs_are_drawn_light_and_dark() {
    let folder = temporary();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("an SVG");
    printed(folder.path(), &[&["run", "-q", "--plot", "light.svg"][..], &QUICK].concat());
    let dark = ["run", "-q", "--plot", "dark.svg", "--dark", "--bands", "--samples", "20"];
    printed(folder.path(), &dark);
    for (name, ground, other) in [
        ("light.svg", "fill=\"#ffffff\"", "fill=\"rgb(16,16,16)\""),
        ("dark.svg", "fill=\"rgb(16,16,16)\"", "fill=\"#ffffff\""),
    ] {
        let svg = read(name);
        says(&svg, &["CH1 (V)", "CH2 (V)", "CH3 (V)", "CH4 (V)", ground]);
        assert!(!svg.contains(other), "{name}");
        assert_eq!(svg.contains("95 % of the traces"), name == "dark.svg");
    }
    says(&hertzscope(folder.path(), &["run", "--dark"]).stderr, &["--plot"]);
}

#[test]
fn paper_fills_a_folder() {
    let folder = temporary();
    let page = printed(folder.path(), &["paper", "--figure", "9", "--out", "out", "-q"]);
    says(&page, &["magnet_gap_line_2.75g", "7.7 kHz", "agrees", "out/report.html"]);
    let expected = [
        "figure-09-forces.csv",
        "figure-09-spectra.csv",
        "figure-09.mcap",
        "figure-09.png",
        "figure-09.svg",
        "report.html",
        "report.md",
        "verdicts.json",
    ];
    let out = folder.path().join("out");
    assert_eq!(files(&out), expected);
    let recorded = printed(&out, &["info", "figure-09.mcap", "--json"]);
    says(&recorded, &["sensor/p2: dynamic force inside particle 2, PTFE sphere", "magnet-2.75g"]);
    let report = std::fs::read_to_string(out.join("report.html")).expect("a report");
    says(&report, &["<svg", "Fig. 9", "magnet_gap_line_2.75g"]);
    let verdicts = printed(folder.path(), &["paper", "--figure", "9", "--json", "-q"]);
    let verdicts: serde_json::Value = serde_json::from_str(&verdicts).expect("JSON");
    let rows = verdicts.as_array().expect("a list");
    assert_eq!(rows.len(), 2);
    for key in ["item", "paper", "here", "unit", "convention", "verdict", "reason"] {
        assert!(rows.iter().all(|row| row.get(key).is_some()), "{key}");
    }
    let done = hertzscope(folder.path(), &["paper", "--figure", "2"]);
    assert_eq!(done.code, 2, "{}", done.stderr);
    says(&done.stderr, &["2", "3..=13"]);
}
