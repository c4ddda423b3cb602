//! Pictures in both formats, and the folder that `paper` fills.

use super::{QUICK, files, hertzscope, printed, refused, says, temporary};

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The points of a path `M1 2L3 4`.
fn points(path: &str) -> Vec<(f64, f64)> {
    let numbers = path.split(['M', 'L']).filter_map(|point| {
        let (x, y) = point.trim().split_once(' ')?;
        Some((x.parse().ok()?, y.parse().ok()?))
    });
    numbers.collect()
}

/// The abscissa of the picture's point is the logarithm of the preload, its ordinate the band edge
/// in the printed table: both are read back through the ticks of the axes, by their own text and
/// place. `resvg`'s parser `usvg` parses the SVG.
#[test]
fn a_plot_shows_the_points_of_the_table() {
    let folder = temporary();
    let json = printed(folder.path(), &["bands", "--plot", "gap.svg", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let text = std::fs::read_to_string(folder.path().join("gap.svg")).expect("an SVG");
    #[cfg(feature = "png")]
    resvg::usvg::Tree::from_str(&text, &resvg::usvg::Options::default()).expect("valid SVG");
    // Names of ticks with their places, along one axis.
    let ticks = |anchor: &str, axis: &str| -> Vec<(f64, f64)> {
        let lines = text.lines().filter(|line| line.contains(&format!("text-anchor=\"{anchor}\"")));
        let ticks = lines.filter_map(|line| {
            let (_, at) = line.split_once(&format!(" {axis}=\""))?;
            let (at, _) = at.split_once('"')?;
            let (_, name) = line.split_once('>')?;
            let name = name.split('<').next()?;
            Some((name.parse::<f64>().ok()?, at.parse::<f64>().ok()?))
        });
        ticks.collect()
    };
    let to_value = |ticks: &[(f64, f64)], at: f64| {
        let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
        first.0 + (at - first.1) * (last.0 - first.0) / (last.1 - first.1)
    };
    let (across, up) = (ticks("middle", "x"), ticks("end", "y"));
    let across: Vec<(f64, f64)> = across.into_iter().map(|(name, at)| (name.ln(), at)).collect();
    let path = text
        .lines()
        .filter(|line| line.contains("stroke=\"#1060b0\""))
        .find_map(|line| line.split_once("d=\"")?.1.split('"').next())
        .expect("the curve");
    let drawn = points(path);
    let bands = json["bands"].as_array().expect("rows");
    assert_eq!(drawn.len(), bands.len());
    for ((x, y), row) in drawn.into_iter().zip(bands) {
        let [preload, edge] = ["preload_n", "f1_hz"].map(|key| row[key].as_f64().expect(key));
        // Ticks of the ordinate are kilohertz, 4 pixels above their names; a pixel of the frame,
        // which is 780 wide, is 0.9 % of the preload and 80 Hz, and places are rounded to 0.1.
        assert!((to_value(&across, x) - preload.ln()).abs() < 2e-3, "{preload} N at {x}");
        let height = 1e3 * to_value(&up, y + 4.0);
        assert!((height - edge).abs() < 30.0, "{edge} Hz at {y}: {height}");
    }
}

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
    says(&words, &["gap.jpg", "expected a name that ends in .svg, .png or .pdf"]);
    assert_eq!(files(folder.path()), ["gap.png", "gap.svg"]);
}

/// A picture has the width and the title asked for in each format, and a PDF the words of the SVG.
#[cfg(feature = "png")]
#[test]
fn a_picture_is_as_wide_as_a_column() {
    let folder = temporary();
    let column = ["--width", "86mm", "--font-size", "7", "--title", "a − b"];
    for name in ["gap.svg", "gap.png", "gap.pdf"] {
        printed(folder.path(), &[&["bands", "--plot", name][..], &column].concat());
    }
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a file");
    let svg = String::from_utf8(read("gap.svg")).expect("text");
    says(&svg, &["width=\"86.000mm\"", ">a − b<", ">frequency (kHz)<"]);
    let png = read("gap.png");
    let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().expect("four bytes"));
    // 600 dots per inch are 23622 per metre; 86 mm are 2031.5 dots.
    assert!((2031..=2032).contains(&side(16)), "{} dots", side(16));
    assert_eq!((&png[37..41], side(41), side(45), png[49]), (&b"pHYs"[..], 23622, 23622, 1));
    let pdf = String::from_utf8_lossy(&read("gap.pdf")).into_owned();
    // 86 mm are 243.780 points of 1/72 inch.
    says(&pdf, &["/MediaBox [0 0 243.780 ", "/ToUnicode"]);
    for (wrong, expected) in [
        (["--width", "1mm"], "from 30 mm to 1 m"),
        (["--width", "86 kg"], "a mass"),
        (["--font-size", "big"], "from 3 to 72 points"),
    ] {
        let words = refused(folder.path(), &[&["bands", "--plot", "x.svg"][..], &wrong].concat());
        says(&words, &[expected]);
    }
}

/// A run's picture has all channels; on dark its hues stay, white and black change places.
#[test]
fn runs_are_drawn_light_and_dark() {
    let folder = temporary();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("an SVG");
    printed(folder.path(), &[&["run", "-q", "--plot", "light.svg"][..], &QUICK].concat());
    let dark = ["run", "-q", "--plot", "dark.svg", "--theme", "dark", "--bands", "--samples", "20"];
    printed(folder.path(), &dark);
    for (name, ground, other) in [
        ("light.svg", "fill=\"#ffffff\"", "fill=\"#101010\""),
        ("dark.svg", "fill=\"#101010\"", "fill=\"#ffffff\""),
    ] {
        let svg = read(name);
        says(&svg, &["CH1 (V)", "CH2 (V)", "CH3 (V)", "CH4 (V)", ground]);
        assert!(!svg.contains(other), "{name}");
        assert_eq!(svg.contains("95 % of the traces"), name == "dark.svg");
    }
    says(&hertzscope(folder.path(), &["run", "--theme", "dark"]).stderr, &["--plot"]);
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

/// `--x-range` and `--y-range` show a part of the axes, with a prefix that fits it; rows, maps and
/// what is no range are refused.
#[test]
fn axes_show_the_part_asked_for() {
    let folder = temporary();
    let part = ["--x-range", "-20 us..80 us", "--y-range", "-5 mV .. 5 mV"];
    printed(folder.path(), &[&["run", "-q", "--plot", "part.svg"][..], &part, &QUICK].concat());
    let svg = std::fs::read_to_string(folder.path().join("part.svg")).expect("an SVG");
    says(&svg, &[">time after the trigger (µs)<", ">−20<", ">80<", ">CH1 (mV)<", ">−4<", ">4<"]);
    assert!(!svg.contains(">100<"), "{svg}");
    for (arguments, expected) in [
        (
            &["bands", "--plot", "x.svg", "--x-range", "5 N..1 N"][..],
            "from the lower to the higher",
        ),
        (&["bands", "--plot", "x.svg", "--x-range", "0 N..1 N"], "expected one of curves"),
        (&["effects", "--plot", "x.svg", "--y-range", "0..1"], "expected one of curves"),
    ] {
        says(&refused(folder.path(), arguments), &[expected]);
    }
}
