//! Background jobs: the comparison, the work-precision study, the ledger of effects. Requests start
//! here; worker threads answer them.

use super::ScreenState;
use super::state::{JobState, Overlay, Page, Request, StrikeRequest, ordinate_unit};
use crate::measurement::compare::Compared;
use crate::predict::TraceBand;
use crate::scope::Waveform;
use crate::studies::cost::CostStudy;
use crate::studies::effects::Ledger;
use crate::studies::hard_cases::CaseResult;
use crate::trace::Trace;

/// The answer to a question, or how far it is.
#[derive(Debug, Clone, PartialEq)]
pub enum JobAnswer {
    /// To [`Request::Compare`].
    Comparison(JobState<Box<Compared>>),
    /// The bands of an uncertain scene that is compared with; empty for others.
    Bands(Vec<TraceBand>),
    /// To [`Request::Study`].
    Study(JobState<Box<CostStudy>>),
    /// To [`Request::Ledger`].
    Ledger(JobState<Box<Ledger>>),
    /// To [`Request::HardCases`].
    HardCases(JobState<Vec<CaseResult>>),
    /// To [`Request::LiveBands`].
    LiveBands(JobState<Vec<[Trace; 2]>>),
}

impl ScreenState {
    /// Takes an answer.
    pub fn apply_answer(&mut self, answer: JobAnswer) {
        match answer {
            JobAnswer::Comparison(job) => self.questions.comparison = job,
            JobAnswer::Bands(bands) => self.questions.bands = bands,
            JobAnswer::Study(job) => self.questions.study = job,
            JobAnswer::Ledger(job) => self.questions.ledger = job,
            JobAnswer::HardCases(job) => self.questions.hard_cases = job,
            // They may have been switched off meanwhile.
            JobAnswer::LiveBands(job) if self.questions.live_bands != JobState::Idle => {
                if let JobState::Failed(problem) = &job {
                    self.notice = Some(format!("no bands: {problem}"));
                }
                self.questions.live_bands = job;
            }
            JobAnswer::LiveBands(_) => {}
        }
    }

    /// Shows or hides where 95 % of the bench's traces lie; they follow the knobs.
    pub(super) fn switch_bands(&mut self) {
        if self.questions.live_bands != JobState::Idle {
            self.questions.live_bands = JobState::Idle;
            self.notice = Some("bands off".to_owned());
            return;
        }
        if self.bench().is_none_or(|live| live.served.is_some()) {
            return;
        }
        self.questions.live_bands = JobState::Busy(0.0);
        self.notice = Some("dotted: 95 % of the traces, by the scene's [uncertainty]".to_owned());
        self.request_bands();
    }

    /// Has the bands of the bench computed as it is tuned now, where they are on.
    pub(super) fn request_bands(&mut self) {
        let Some(live) = self.live.as_ref().filter(|_| self.questions.live_bands != JobState::Idle)
        else {
            return;
        };
        let name = self.title.clone();
        let bench = StrikeRequest { name, text: live.text(), shot: live.shot, turn: live.asked };
        self.requests.retain(|request| !matches!(request, Request::LiveBands(_)));
        self.requests.push(Request::LiveBands(bench));
    }

    /// Lower and upper edge of where 95 % of the traces of `waveform` lie, in volts.
    pub fn bands(&self, waveform: &Waveform) -> Option<&[Trace; 2]> {
        let name = waveform.source.to_string();
        let bands = self.questions.live_bands.done()?.iter();
        bands.into_iter().find(|[low, _]| low.name == name && ordinate_unit(waveform) == low.unit)
    }

    /// Holds what is on screen against `other`: a recording, a folder, or a scene.
    pub fn compare_with(&mut self, other: String) {
        self.compared_with = Some(other);
        self.questions.comparison = JobState::Busy(0.0);
        self.page = Page::Compare;
        self.compare_again();
    }

    /// Holds another shot against what the last one was held against; without a shot that waits for
    /// one.
    pub(super) fn compare_again(&mut self) {
        if let (Some(other), Some(_)) = (self.compared_with.clone(), self.shot()) {
            // The other side is sent again until the first answer.
            let unknown = self.questions.comparison.done().is_none();
            self.requests.push(Request::Compare(unknown.then_some(other)));
        }
    }

    /// The other side of the comparison, if any.
    pub fn compared_with(&self) -> Option<&str> {
        self.compared_with.as_deref()
    }

    /// The comparison's page, its next view, and away again.
    pub(super) fn next_overlay(&mut self) {
        if self.page != Page::Compare {
            self.open_page(Page::Compare);
            self.overlay = Overlay::Both;
            self.compare_again();
            return;
        }
        match self.overlay {
            Overlay::Both => self.overlay = Overlay::Traces,
            Overlay::Traces => self.overlay = Overlay::Difference,
            Overlay::Difference => self.open_page(Page::Compare),
        }
    }

    /// Opens or closes a page that shows a study; its question is asked the first time.
    pub(super) fn open_study(&mut self, page: Page) {
        self.open_page(page);
        if self.page != page {
            return;
        }
        if self.scene.is_none() && page != Page::HardCases {
            self.notice = Some("no scene is known: nothing can be run".to_owned());
            return;
        }
        let jobs = &mut self.questions;
        let (begins, request) = match page {
            Page::Accuracy => (jobs.study.begin(), Request::Study),
            Page::Effects => (jobs.ledger.begin(), Request::Ledger),
            _ => (jobs.hard_cases.begin(), Request::HardCases),
        };
        self.requests.extend(begins.then_some(request));
    }

    /// Another bench: what was found out about the last one is gone, and what is on screen is asked
    /// again.
    pub(super) fn invalidate_studies(&mut self) {
        self.questions.study = JobState::Idle;
        self.questions.ledger = JobState::Idle;
        if self.page == Page::Effects && self.questions.ledger.begin() {
            self.requests.push(Request::Ledger);
        }
    }

    /// Name of the effect that is selected in the ledger.
    pub fn selected_effect(&self) -> Option<&'static str> {
        let ledger = self.questions.ledger.done()?;
        ledger.entries.get(self.row).map(|entry| entry.effect)
    }
}
