//! Reads a recording on its own thread: shots that are asked for first, the rest of the file in between.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant};

use super::{News, guarded};
use crate::recording::mcap::indexed_recording::{End, IndexedRecording};

/// A file that may grow is looked at so often.
const LOOK: Duration = Duration::from_millis(50);
/// How much is found is told so often.
const TELL: Duration = Duration::from_millis(100);

/// Starts the thread; it takes places of shots.
pub fn start(tape: IndexedRecording, follow: bool, news: &Sender<News>) -> Sender<usize> {
    let (orders, received) = channel();
    let news = news.clone();
    thread::spawn(move || {
        let last = news.clone();
        let player = Player { tape, follow, news, told: None, brought: None };
        // An error means that the screen is gone.
        if let Err(words) = guarded(|| Ok(player.play(&received))) {
            let _ = last.send(News::Told(words));
        }
    });
    orders
}

struct Player {
    tape: IndexedRecording,
    follow: bool,
    news: Sender<News>,
    /// When it was last told how much there is, and what.
    told: Option<(Instant, usize, End)>,
    /// The shot that was brought last, and of how many pieces of the file it was made.
    brought: Option<(usize, usize)>,
}

/// The other end is gone.
struct Gone;

impl Player {
    fn play(mut self, orders: &Receiver<usize>) -> Result<(), Gone> {
        loop {
            if let Some(place) = latest(orders)? {
                self.apply(place)?;
            }
            let end = self.tape.read_on();
            let end = match end {
                Ok(end) => end,
                Err(error) => {
                    self.say(News::Told(error.to_string()))?;
                    End::Finished
                }
            };
            self.tell(end)?;
            self.bring_rest()?;
            let place = match end {
                End::More => None,
                End::Open if self.follow => match orders.recv_timeout(LOOK) {
                    Ok(place) => Some(place),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return Err(Gone),
                },
                End::Open | End::Finished => Some(orders.recv().map_err(|_| Gone)?),
            };
            if let Some(place) = place {
                let place = latest(orders)?.unwrap_or(place);
                self.apply(place)?;
            }
        }
    }

    fn say(&self, news: News) -> Result<(), Gone> {
        self.news.send(news).map_err(|_| Gone)
    }

    /// The shot on screen again, where more of it has come since: its last pieces may not have been written yet.
    fn bring_rest(&mut self) -> Result<(), Gone> {
        match self.brought {
            Some((place, pieces)) if self.tape.pieces(place) > pieces => self.apply(place),
            _ => Ok(()),
        }
    }

    fn apply(&mut self, place: usize) -> Result<(), Gone> {
        self.brought = Some((place, self.tape.pieces(place)));
        match self.tape.shot(place) {
            Ok(Some(shot)) => self.say(News::Shot(place, Box::new(shot))),
            Ok(None) => self.say(News::Told(format!("shot {} cannot be read", place + 1))),
            Err(error) => self.say(News::Told(error.to_string())),
        }
    }

    /// Tells how much there is: the first shot at once, then now and then, and whenever an end is reached.
    fn tell(&mut self, end: End) -> Result<(), Gone> {
        let count = self.tape.shots();
        let due = match self.told {
            None => count > 0 || end != End::More,
            Some((at, told, before)) => {
                (told, before) != (count, end) && (end != End::More || at.elapsed() >= TELL)
            }
        };
        if !due {
            return Ok(());
        }
        self.told = Some((Instant::now(), count, end));
        let mut facts = self.tape.facts();
        if end == End::Open && !self.follow {
            facts.problems.push("the file has no end: it was not finished, or cut".to_owned());
        }
        let open = end == End::More || (end == End::Open && self.follow);
        self.say(News::Read(count, open, Box::new(facts)))
    }
}

/// The newest order, the others are stale.
fn latest(orders: &Receiver<usize>) -> Result<Option<usize>, Gone> {
    let mut latest = None;
    loop {
        match orders.try_recv() {
            Ok(place) => latest = Some(place),
            Err(TryRecvError::Empty) => return Ok(latest),
            Err(TryRecvError::Disconnected) => return Err(Gone),
        }
    }
}
