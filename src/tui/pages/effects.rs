//! What each effect changes and costs: the table of the command `effects`.

use ratatui::Frame;
use ratatui::style::{Color, Style};

use super::list::{self, List};
use super::study;
use crate::report;
use crate::studies::effects::{self, EffectState, Ledger};
use crate::tui::job::with_reasons;
use crate::tui::model::{Action, Page, PageSpec, ScreenState};
use crate::tui::view::colours::colour;
use crate::tui::view::layout::ScreenLayout;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "effects",
    key: 'y',
    help: "what each effect changes and costs",
    keys: list::KEYS,
    hints: &[
        ("?", "help"),
        ("Esc", "traces"),
        ("↑ ↓", "effect"),
        ("o", "on, off"),
        ("h", "hard cases"),
        ("k", "accuracy"),
        ("w", "save"),
    ],
    is_wide: true,
    rows: Some(|model| model.jobs.ledger.done().map_or(0, |ledger| ledger.entries.len())),
    opened,
    bench_changed: opened,
    act,
    draw,
    ..PageSpec::PLAIN
});

/// Asks for the ledger of effects, unless it is there.
fn opened(model: &mut ScreenState) {
    let Some(scene) = study::scene(model) else { return };
    study::ask(
        model,
        |jobs| &mut jobs.ledger,
        move |progress| {
            let ledger = effects::ledger(&scene, scene.accuracy, progress);
            ledger.map(Box::new).map_err(|error| with_reasons(&error))
        },
    );
}

/// The selected effect is switched.
fn act(model: &mut ScreenState, action: Action) -> bool {
    if action != Action::Switch {
        return false;
    }
    let ledger = model.jobs.ledger.done();
    let selected = ledger.and_then(|ledger| ledger.entries.get(model.row));
    let effect = selected.map(|entry| entry.effect);
    model.switch_effect(effect);
    true
}

fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let words =
        ("effects, each with and without", "the bench has changed: press y twice to compute it");
    if let Some(ledger) = study::done(&model.jobs.ledger, words, layout.page, frame) {
        list::draw(model, table(model, ledger), layout.page, frame);
    }
}

fn table(model: &ScreenState, ledger: &Ledger) -> List {
    let mut list = List::from(report::effects_table(ledger));
    for (row, entry) in list.rows.iter_mut().zip(&ledger.entries) {
        let tint = match entry.state {
            EffectState::On => Color::LightGreen,
            EffectState::Auto => Color::Yellow,
            EffectState::Off => Color::Gray,
        };
        row.style = Style::new().fg(colour(model.palette(), tint));
    }
    let entry = ledger.entries.get(model.row);
    list.selected = entry.map_or_else(String::new, |entry| {
        let value = entry.value.map_or("not known".to_owned(), |value| match value.abs() {
            size if size == 0.0 || (1e-2..1e3).contains(&size) => format!("{value:.3}"),
            _ => format!("{value:.1e}"),
        });
        format!("{}: {} = {value}; {}", entry.effect, entry.criterion, entry.reason)
    });
    list
}
