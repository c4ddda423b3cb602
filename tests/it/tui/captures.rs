//! Every real capture on the screen, alone, in folders and against others, where
//! `HERTZSCOPE_CAPTURES` names their folder.

use std::path::{Path, PathBuf};

use super::bench::{after, draw, model};
use super::live::Session;
use hertzscope::measurement::compare::score_limits::ScoreLimits;
use hertzscope::measurement::compare::{Align, ComparedShot, compare};
use hertzscope::recording::format::open;
use hertzscope::recording::{Origin, TraceSet};
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::model::{Action, JobState, SidePanel as Beside};
use hertzscope::tui::pages;

/// The captures and their names.
fn captures() -> Vec<(String, TraceSet)> {
    let folder = std::env::var_os("HERTZSCOPE_CAPTURES").expect("the folder of captures");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the captures")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| {
            let ending = path.extension().map(std::ffi::OsStr::to_ascii_lowercase);
            ending.is_some_and(|ending| ending == "csv" || ending == "isf")
        })
        .collect();
    files.sort();
    let mut sets = Vec::new();
    for file in files {
        let set = open(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert_eq!(set.shots[0].origin, Origin::Measured);
        sets.push((file.display().to_string(), set));
    }
    assert!(sets.len() >= 18, "{} captures", sets.len());
    sets
}

/// All pages and panels, zoomed and not, small and large: a picture each, with the trace's name on
/// it.
fn look_at(name: &str, set: &TraceSet) {
    let source = set.shots[0].captures[0].waveform.source.to_string();
    let ways: [&[Action]; 9] = [
        &[],
        &[Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 }, Action::Autoset],
        &[Action::Side(Beside::Measurements)],
        &[
            Action::Cursors,
            Action::Snap(TurnDirection::Up),
            Action::OtherCursor,
            Action::Snap(TurnDirection::Up),
        ],
        &[Action::Page(pages::spectrum::SPECTRUM)],
        &[Action::Page(pages::spectrum::MAP)],
        &[Action::Page(pages::xy::PAGE)],
        &[Action::Page(pages::bench::PAGE)],
        &[Action::Unit, Action::Math, Action::Truth, Action::Persistence],
    ];
    for way in ways {
        let model = after(model(set.clone()), way);
        for (width, height) in [(80, 24), (200, 60)] {
            let screen = draw(&model, width, height);
            assert!(screen.has(&source) && screen.has("measured"), "{name} {way:?}");
        }
    }
}

#[test]
#[ignore = "needs HERTZSCOPE_CAPTURES"]
fn every_capture_is_shown_on_every_page() {
    for (name, set) in captures() {
        look_at(&name, &set);
    }
}

/// Folders as the instruments saved them, the set-up beside the curves.
#[test]
#[ignore = "needs HERTZSCOPE_CAPTURES"]
fn every_capture_folder_is_opened() {
    let all = std::env::var_os("HERTZSCOPE_CAPTURES").expect("the folder of captures");
    for (folder, files) in [
        (
            "ALL0001",
            &[
                ("tds2004c-v24.26-F0001CH1.CSV", "F0001CH1.CSV"),
                ("tds2004c-v24.26-F0001CH3.CSV", "F0001CH3.CSV"),
                ("tds2004c-v24.26-F0001TEK.SET", "F0001TEK.SET"),
            ][..],
        ),
        (
            "ALL0022",
            &[
                ("fft-tds1012c-edu-F0022MTH.CSV", "F0022MTH.CSV"),
                ("fft-tds1012c-edu-F0022TEK.SET", "F0022TEK.SET"),
            ][..],
        ),
    ] {
        let place = tempfile::tempdir().expect("a folder");
        let place = place.path().join(folder);
        std::fs::create_dir(&place).expect("a folder");
        for (from, to) in files {
            std::fs::copy(Path::new(&all).join(from), place.join(to)).expect("a copy");
        }
        let set = open(&place).expect("a folder of captures");
        assert_eq!(set.shots[0].captures.len(), files.len() - 1);
        look_at(folder, &set);
    }
}

fn side<'a>(name: &'a str, set: &'a TraceSet) -> ComparedShot<'a> {
    ComparedShot { name, set, shot: &set.shots[0], scene: None }
}

/// Itself is itself; another one is scored with numbers that are numbers, or refused with a reason.
#[test]
#[ignore = "needs HERTZSCOPE_CAPTURES"]
fn every_capture_is_held_against_itself_and_another() {
    let sets = captures();
    let (mut scored, mut refused) = (0, 0);
    for (place, (name, set)) in sets.iter().enumerate() {
        let (other_name, other) = &sets[(place + 1) % sets.len()];
        let tolerance = ScoreLimits::parse("rms=1lsb").expect("a tolerance");
        for (against, held) in [(name, set), (other_name, other)] {
            match compare(side(name, set), side(against, held), (Align::default(), &[]), &tolerance)
            {
                Ok(found) => {
                    let same = against == name;
                    for channel in &found.comparison.channels {
                        let numbers = [channel.rms_lsb, channel.max_lsb, channel.gain.value];
                        assert!(numbers.iter().all(|n| n.is_finite()), "{name}: {channel:?}");
                        assert!(!same || channel.max_lsb == 0.0, "{name}: {channel:?}");
                    }
                    // What a clipped channel hides cannot be judged.
                    let clipped = set.shots[0].captures.iter().any(|c| c.waveform.clipped() > 0);
                    assert!(!same || (found.comparison.verdict == "pass") != clipped, "{name}");
                    scored += 1;
                }
                Err(error) => {
                    assert!(error.to_string().contains("expected"), "{name}: {error}");
                    refused += 1;
                }
            }
        }
    }
    assert!(sets.is_empty() || (scored > sets.len() && refused > 0), "{scored}, {refused}");
}

/// On the screen: the bench of a scene held against each, scores or the reason on the page.
#[test]
fn a_bench_is_held_against_every_capture() {
    let sets = captures();
    if sets.is_empty() {
        return;
    }
    let mut session = Session::bench("magnet-0.61g");
    for (name, _) in sets {
        session.command(&format!("compare {name}"));
        while matches!(session.model.jobs.comparison, JobState::Busy(_)) {
            session.next();
        }
        let screen = draw(&session.model, 80, 24);
        match &session.model.jobs.comparison {
            JobState::Done(found) => {
                assert_eq!(found.comparison.verdict, "fail", "{name}");
                assert!(screen.has("FAIL") && screen.has("corr"), "{name}");
            }
            JobState::Failed(reason) => {
                assert!(reason.contains("expected"), "{name}: {reason}");
                assert!(screen.has("cannot compare"), "{name}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}
