//! `HARDCopy`: pictures of the screen, dot by dot, and in every format.

use hertzscope::instrument::Instrument;
use hertzscope::scope::Source;
use hertzscope::screen::{HEIGHT, Ink, Picture, PictureFormat, Screen, WIDTH, draw, file};

use super::bench::Bench;

/// Left edge and centre of the graticule, in dots; a division is 25, a level one.
const LEFT: usize = 11;
const CENTRE: usize = 117;

fn picture(instrument: &Instrument) -> Picture {
    draw(&Screen::of(instrument))
}

/// Rows from above in which the column shows an ink.
fn column(picture: &Picture, x: usize, ink: Ink) -> Vec<usize> {
    (17..218).filter(|y| picture.dot(x, *y) == ink).collect()
}

/// Red, green, blue of every dot, row by row from above.
fn colours(picture: &Picture) -> Vec<[u8; 3]> {
    let palette: Vec<[u8; 3]> = picture.palette().collect();
    picture.rows().flatten().map(|dot| palette[usize::from(dot)]).collect()
}

fn number(bytes: &[u8], at: usize, length: usize) -> usize {
    bytes[at..at + length].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte))
}

/// A step of two divisions at the trigger, position 1 div: two lines of dots and the edge between
/// them.
#[test]
fn a_trace_stands_where_its_levels_are() {
    let mut bench = Bench::new();
    let settings = "CH1:POS 1;:HOR:SCA 1E-3;:TRIG:MAI:LEV 1";
    bench.record(settings, |t| if t < 0.0 { 0.0 } else { 2.0 });
    let picture = picture(&bench.instrument);
    for x in LEFT + 1..LEFT + 124 {
        assert_eq!(column(&picture, x, Ink::Channel1), [CENTRE - 25], "column {x}");
    }
    // Column 125 shows points 1240 to 1249, the next one the step.
    assert_eq!(column(&picture, LEFT + 126, Ink::Channel1), (42..=92).collect::<Vec<_>>());
    for x in LEFT + 127..=LEFT + 250 {
        assert_eq!(column(&picture, x, Ink::Channel1), [CENTRE - 75], "column {x}");
    }
    // The arrows of zero volts at the left, of the level at the right.
    assert_eq!(picture.dot(9, CENTRE - 25), Ink::Channel1);
    assert_eq!(picture.dot(LEFT + 252, CENTRE - 50), Ink::Channel1);
    // Dots instead of lines leave the edge out.
    bench.tell("DIS:STY DOT");
    let dots = draw(&Screen::of(&bench.instrument));
    assert_eq!(column(&dots, LEFT + 126, Ink::Channel1), [CENTRE - 75]);
}

/// Cursors and the window's edges are dashed lines where they are set.
#[test]
fn bars_stand_where_they_are_set() {
    let mut bench = Bench::new();
    let settings = "HOR:SCA 1E-3;:CURS:FUNC VBA;VBA:POSITION1 -2E-3;POSITION2 3E-3";
    bench.record(settings, |_| -1.0);
    let upright = picture(&bench.instrument);
    for (x, dots) in [(LEFT + 75, 134), (LEFT + 200, 134), (LEFT + 100, 0)] {
        let found = column(&upright, x, Ink::Bar).len();
        assert!(found.abs_diff(dots) <= 2, "column {x}: {found}");
    }
    bench.tell("CURS:FUNC HBA;HBA:POSITION1 1;POSITION2 -2");
    let level = picture(&bench.instrument);
    for (y, is_bar) in [(CENTRE - 25, true), (CENTRE + 50, true), (CENTRE + 25, false)] {
        assert_eq!(level.dot(LEFT + 132, y) == Ink::Bar, is_bar, "row {y}");
    }
    bench.tell("CURS:FUNC OFF;:HOR:DEL:SCA 1E-4;POS 1E-3;:HOR:VIE ZONE");
    let zone = picture(&bench.instrument);
    // 0.5 ms before and after 1 ms: half a division around one.
    let edges = (LEFT..LEFT + 250).filter(|x| column(&zone, *x, Ink::Bar).len() > 100);
    assert_eq!(edges.collect::<Vec<_>>(), [LEFT + 138, LEFT + 163]);
}

/// Points that left the screen downward belong to the trace, also in a record that begins at the
/// trigger, as those of a scan do.
#[test]
fn clipped_points_are_no_blank_of_a_scan() {
    let mut bench = Bench::new();
    // 5 div to the right: the first point is the trigger's. 8 div down is below the converter.
    let settings = "HOR:SCA 1E-3;POS 5E-3;:TRIG:MAI:LEV 5";
    bench.record(settings, |t| if t < 5e-3 { 0.0 } else { -8.0 });
    let picture = picture(&bench.instrument);
    let step = (LEFT + 120..LEFT + 130).map(|x| column(&picture, x, Ink::Channel1).len()).max();
    assert_eq!(step, Some(101), "from the centre to the lower edge");
}

/// A spectrum of one line: zoomed by ten around it, it stands in the centre; shifted by the
/// position.
#[test]
fn a_spectrum_is_zoomed() {
    let mut bench = Bench::new();
    // 100 us/div: 2.5 MS/s, bins of 1220.7 Hz; bin 256 is a quarter of the way.
    let frequency = 256.0 * 2.5e6 / 2048.0;
    let settings =
        "HOR:SCA 1E-4;:TRIG:MAI:LEV 5;:MATH:DEFINE \"FFT(CH1,RECT)\";:SEL:MATH ON;CH1 OFF";
    bench.record(settings, |t| (std::f64::consts::TAU * frequency * t).sin());
    let top = |picture: &Picture| {
        let highest = |x: usize| column(picture, x, Ink::Math).into_iter().find(|y| *y > 30);
        // The scale is written in the upper left corner.
        (LEFT + 1..LEFT + 251).filter_map(|x| Some((highest(x)?, x))).min()
    };
    let (_, x) = top(&picture(&bench.instrument)).expect("a line");
    assert!(x.abs_diff(LEFT + 63) <= 1, "a quarter of 250 dots: {x}");
    bench.tell("MATH:FFT:HOR:SCA 10;POS 25");
    let (y, x) = top(&picture(&bench.instrument)).expect("a line");
    assert!(x.abs_diff(LEFT + 125) <= 2, "in the centre: {x}");
    bench.tell("MATH:FFT:VER:POS -1");
    let (lower, _) = top(&picture(&bench.instrument)).expect("a line");
    assert_eq!(lower, y + 25);
    bench.tell("MATH:FFT:VER:POS 0;SCA 0.5");
    let (half, _) = top(&picture(&bench.instrument)).expect("a line");
    assert!(half.abs_diff(usize::midpoint(y, CENTRE)) <= 1, "half as high over the centre: {half}");
}

/// Every format, decoded by its own rules, holds the same dots.
#[test]
fn every_format_holds_the_same_picture() {
    let mut bench = Bench::new();
    bench.record("HOR:SCA 1E-3", |t| (t * 2000.0).sin());
    let picture = picture(&bench.instrument);
    let wanted = colours(&picture);
    let bmp = file(&picture, PictureFormat::Bmp);
    assert_eq!((&bmp[..2], number(&bmp, 2, 4)), (&b"BM"[..], bmp.len()));
    assert_eq!((number(&bmp, 18, 4), number(&bmp, 22, 4)), (WIDTH, HEIGHT));
    let start = number(&bmp, 10, 4);
    let colour = |dot: u8| {
        let at = 54 + 4 * usize::from(dot);
        [bmp[at + 2], bmp[at + 1], bmp[at]]
    };
    let upright = |dots: &[u8]| -> Vec<[u8; 3]> {
        dots.chunks(WIDTH).rev().flatten().map(|dot| colour(*dot)).collect()
    };
    assert_eq!(upright(&bmp[start..]), wanted);

    let tiff = file(&picture, PictureFormat::Tiff);
    let entry = |tag: usize| {
        let at = (0..10).map(|n| 10 + 12 * n).find(|at| number(&tiff, *at, 2) == tag);
        number(&tiff, at.expect("a tag") + 8, 4)
    };
    let (dots, map) = (&tiff[entry(273)..], entry(320));
    let part = |dot: u8, part: usize| tiff[map + 512 * part + 2 * usize::from(dot)];
    let found: Vec<[u8; 3]> = dots.iter().map(|d| [0, 1, 2].map(|n| part(*d, n))).collect();
    assert_eq!(found, wanted);
}

/// `STARt` sends bare bytes: no block header, no terminator; the next reply follows as ever.
#[test]
fn the_picture_comes_over_the_connection() {
    let mut bench = Bench::new();
    bench.tell("HARDC:FORM BMP;PORT RS232");
    let bytes = bench.bytes("HARDC STAR");
    assert_eq!(bytes, file(&picture(&bench.instrument), PictureFormat::Bmp));
    assert_eq!(bench.bytes("HARDC:PORT?;:HARDC STAR")[..6], *b"RS232\n");
    assert_eq!(bench.ask("HARDC?"), "BMP;RS232;PORTRAIT;ON");
    bench.tell("HARDC ABO");
    bench.tell("HARDC:INKS OFF");
    let dark = bench.bytes("HARDC STAR");
    assert_eq!(dark.len(), bytes.len());
    assert_ne!(dark, bytes, "light on black");
    assert_eq!(bench.ask("*ESR?"), "0");
}

/// There is no printer, and no printer's language.
#[test]
fn printers_are_refused() {
    for settings in [
        "FORM BMP;PORT CEN",
        "FORM EPSO;PORT RS232",
        "FORM INTERL;PORT GPIB",
        "FORM PCX;PORT RS232",
    ] {
        let mut bench = Bench::new();
        bench.tell(&format!("HARDC:{settings}"));
        bench.tell("HARDC STAR");
        bench.transcript(&[("*ESR?", "16"), ("EVENT?", "241")]);
    }
}

/// One message cannot make replies grow without end.
#[test]
fn pictures_of_one_message_are_limited() {
    let mut bench = Bench::new();
    bench.tell("HARDC:FORM TIF;PORT GPIB");
    let message = vec!["HARDC STAR"; 1000].join(";:");
    assert!(bench.bytes(&message).len() <= hertzscope::scpi::MAXIMUM_REPLY);
    bench.transcript(&[("*ESR?", "4"), ("EVENT?", "430")]);
}

/// Every source that the instrument saves: channel, math, spectrum, reference; as files and back,
/// byte for byte.
#[test]
fn every_source_is_saved_as_a_native_file() {
    use hertzscope::recording::{Capture, InstrumentIdentity as Maker, tek_csv};
    let mut bench = Bench::new();
    bench.record("HOR:SCA 1E-3;:CH2:SCA 2;:SEL:CH2 ON;MATH ON", |t| (t * 2000.0).sin());
    bench.tell("SAV:WAVE CH1,REFC;:SEL:REFC ON");
    let maker = Maker { model: "TDS2014".into(), serial: "0".into(), firmware: "FV:v4.12".into() };
    let check = |bench: &Bench, source: Source, rows: [(usize, &str); 3]| {
        let waveform = bench.instrument.waveform(source).expect("displayed").into_owned();
        let capture = Capture { waveform, instrument: Some(maker.clone()), notes: Vec::new() };
        let text = tek_csv::write(&capture).expect("a native file");
        for (row, start) in rows {
            let found = text.lines().nth(row).expect("a row");
            assert!(found.starts_with(start), "{source}: {found}");
        }
        let back = tek_csv::read(text.as_bytes(), "F.CSV").expect("native");
        assert_eq!(back.waveform.codes, capture.waveform.codes, "{source}");
        assert_eq!(tek_csv::write(&back).expect("a native file"), text, "{source}");
    };
    let volts = (8, "Vertical Scale,1.000000e+00,,");
    let time = (0, "Record Length,2.500000e+03,,");
    check(&bench, Source::Channel(1), [time, (6, "Source,CH1,,"), volts]);
    check(&bench, Source::Reference('C'), [time, (6, "Source,REFC,,"), volts]);
    let math = (8, "Vertical Scale,2.000000e+00,,");
    check(&bench, Source::Math, [time, (6, "Source,MATH,,"), math]);
    bench.tell("MATH:DEFINE \"FFT(CH1,HANNING)\"");
    let bins = (0, "Record Length,1.024000e+03,,          0.00000,");
    // 20 log10(1 V) - 20.9691 dB; 10 dB a division.
    check(
        &bench,
        Source::Math,
        [bins, (8, "Vertical Scale,1.000000e+01,,"), (13, "Yzero,-2.096910e+01,,")],
    );
}

/// A saved set-up is a message: sent to another instrument it sets all of it, and that one saves
/// the same.
#[test]
fn a_saved_set_up_sets_another_instrument() {
    use hertzscope::recording::set_file::SetFile;
    let mut bench = Bench::new();
    bench.tell(
        "CH2:SCA 0.2;POS -1.4;COUP AC;INV ON;BAN ON;:SEL:CH2 ON;MATH ON;:HOR:SCA 5E-4;POS 1E-3",
    );
    bench
        .tell("MATH:DEFINE \"FFT(CH2,FLATTOP)\";:TRIG:MAI:MOD NORM;LEV 0.25;EDGE:SLO FALL;SOU CH2");
    bench.tell("MEASU:MEAS3:TYP RIS;SOU CH2;:CURS:FUNC VBA;VBA:UNI HER;:ACQ:MOD AVE;NUMAV 64;:ACQ:STATE STOP");
    let text = bench.ask("SET?") + "\n";
    let mut other = Bench::new();
    other.tell(text.trim_end());
    assert_eq!(other.ask("SET?") + "\n", text);
    assert_eq!(other.ask("*ESR?"), "0");
    let read = SetFile::read(text.as_bytes(), "F.SET").expect("a set-up");
    assert_eq!(read.write(), text);
}
