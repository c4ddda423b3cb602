//! The threads behind the screen: one reads the recording or watches a served scope, one strikes the bench, two answer long questions.
//! All they say goes through one channel to the screen's loop, and so do the terminal's events.

mod bench;
mod clerk;
mod player;
mod save;
pub mod served;

use std::io::IsTerminal as _;
use std::panic::{self, AssertUnwindSafe};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use ratatui::crossterm::event::{self, Event};
use ratatui::layout::Size;

use super::model::questions::Answer;
use super::model::served::Heard;
use super::model::{Model, Request, Strike, Struck};
use crate::recording::mcap::tape::Tape;
use crate::recording::{Shot, TraceSet};
use clerk::{Comparison, Research};

/// What reaches the screen's loop.
#[derive(Debug)]
pub enum News {
    /// A key, the mouse, another size.
    Terminal(Event),
    /// The terminal is gone.
    Closed,
    /// How far the recording was read: shots, whether there may be more, and what holds for all.
    Read(usize, bool, Box<TraceSet>),
    /// A shot, with its place.
    Shot(usize, Box<Shot>),
    /// The answer to a strike, with its number.
    Struck(u64, Result<Box<Struck>, String>),
    /// The answer to a question.
    Answer(Answer),
    /// What a served scope told.
    Heard(Box<Heard>),
    /// The served scope is gone, and why.
    Lost(String),
    /// Something went wrong that the user should know.
    Told(String),
}

impl News {
    /// Brings this to the model; terminal events are the keys' business.
    pub fn bring(self, model: &mut Model) {
        match self {
            Self::Terminal(_) | Self::Closed => {}
            Self::Read(count, open, facts) => model.tape_read(count, open, *facts),
            Self::Shot(place, shot) => model.tape_shot(place, *shot),
            Self::Struck(turn, answer) => model.struck(turn, answer),
            Self::Answer(answer) => model.answered(answer),
            Self::Heard(heard) => model.heard(*heard),
            Self::Lost(why) => model.lost(why),
            Self::Told(words) => model.tell(words),
        }
    }
}

/// How often it is looked whether the terminal is still there.
const LOOK: Duration = Duration::from_millis(500);

/// Does a piece of work; a panic in it becomes words, and the thread goes on with the next.
///
/// # Errors
/// What the work says, or the panic.
pub fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<&str>().map(|words| (*words).to_owned());
        let words = words.or_else(|| panic.downcast_ref::<String>().cloned());
        let words = words.unwrap_or_else(|| "no words about it".to_owned());
        Err(format!("an error of this program, please report it: {words}"))
    })
}

/// In debug builds this panics where `HERTZSCOPE_VIEW_PANIC` is `place`, so that tests can see what comes of it.
///
/// # Panics
/// As asked.
pub fn provoked(place: &str) {
    let asked = cfg!(debug_assertions)
        && std::env::var("HERTZSCOPE_VIEW_PANIC").is_ok_and(|asked| asked == place);
    assert!(!asked, "provoked");
}

/// Starts a thread that does `work` for each order, with a way to send news; it ends when nobody can order any more.
fn worker<Order: Send + 'static>(
    news: &Sender<News>,
    mut work: impl FnMut(Order, &Receiver<Order>, &Sender<News>) + Send + 'static,
) -> Sender<Order> {
    let (orders, received) = channel::<Order>();
    let news = news.clone();
    thread::spawn(move || {
        while let Ok(order) = received.recv() {
            work(order, &received, &news);
        }
    });
    orders
}

/// Everyone who works for the screen.
pub struct Staff {
    news: Sender<News>,
    player: Option<Sender<usize>>,
    served: Option<Sender<String>>,
    bench: Sender<Strike>,
    comparison: Sender<Comparison>,
    research: Sender<Research>,
}

impl Staff {
    /// Starts the threads; a recording that is read as it is looked at comes as `tape`, and may be followed.
    #[must_use]
    pub fn start(tape: Option<Tape>, follow: bool) -> (Self, Receiver<News>) {
        let (news, receiver) = channel();
        let player = tape.map(|tape| player::start(tape, follow, &news));
        let staff = Self {
            player,
            served: None,
            bench: worker(&news, bench::strike),
            comparison: worker(&news, clerk::comparer()),
            research: worker(&news, clerk::research),
            news,
        };
        (staff, receiver)
    }

    /// Watches a scope that is served somewhere else.
    pub fn watch(&mut self, scope: served::Scope) {
        self.served = Some(served::start(scope, &self.news));
    }

    /// Listens to the terminal.
    pub fn listen(&self) {
        let news = self.news.clone();
        let end = news.clone();
        thread::spawn(move || {
            while let Ok(event) = event::read() {
                if news.send(News::Terminal(event)).is_err() {
                    return;
                }
            }
            // Nobody is left to hear it if this fails.
            let _ = news.send(News::Closed);
        });
        // Reading from a terminal that has gone never ends, and a hang-up signal need not come.
        thread::spawn(move || {
            while std::io::stdout().is_terminal() {
                thread::sleep(LOOK);
            }
            let _ = end.send(News::Closed);
        });
    }

    /// Has everything done that the model asks for.
    pub fn serve(&self, model: &mut Model, size: Size) {
        for request in model.take_requests() {
            // A worker that is gone has panicked; the screen's hook has told why.
            let sent = match request {
                Request::Load(place) => {
                    self.player.as_ref().is_none_or(|player| player.send(place).is_ok())
                }
                Request::Strike(strike) => self.bench.send(strike).is_ok(),
                Request::Send(command) => {
                    self.served.as_ref().is_none_or(|scope| scope.send(command).is_ok())
                }
                Request::Compare(other) => {
                    Comparison::of(model, other).is_none_or(|c| self.comparison.send(c).is_ok())
                }
                Request::Study => {
                    let scene = model.scene().cloned().map(Box::new);
                    scene.is_none_or(|scene| self.research.send(Research::Study(scene)).is_ok())
                }
                Request::Ledger => {
                    let scene = model.scene().cloned().map(Box::new);
                    scene.is_none_or(|scene| self.research.send(Research::Ledger(scene)).is_ok())
                }
                Request::Save(file) => {
                    model.tell(save::save(model, size, &file).unwrap_or_else(|problem| problem));
                    true
                }
            };
            if !sent {
                model.tell("the thread that does this has stopped; please restart".to_owned());
            }
        }
    }
}
