//! The bench on a thread of its own: strikes the chain when told to, and hands over what arrives at
//! the scope's inputs, with the records that the scope makes of it. Where the scope was set
//! otherwise meanwhile, the records are made again.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;

use tokio::sync::mpsc;

use super::ServeError;
use crate::chain::Indentations;
use crate::experiment::RunError;
use crate::experiment::inputs::{InputWindow, inputs};
use crate::instrument::{Fault, Instrument, Preparation, Prepared, SampleWindow, Signals};
use crate::scene::Scene;
use crate::trace::Trace;

/// Work for the thread.
enum BenchOrder {
    /// A strike to be made.
    Strike {
        scene: Arc<Scene>,
        wanted: SampleWindow,
        shot: u32,
        faults: (Vec<Fault>, u64),
        preparation: Box<Preparation>,
    },
    /// Records to be made again, with other settings.
    Prepare { struck: Box<StrikeSignals>, preparation: Box<Preparation> },
}

/// The far end of the bench.
pub struct BenchHandle {
    orders: SyncSender<BenchOrder>,
    signals: mpsc::Receiver<StrikeSignals>,
    under_way: bool,
    shots: u32,
}

/// Signals from one impact.
pub struct StrikeSignals {
    /// Number of the shot.
    pub shot: u32,
    /// The bench that was struck.
    pub scene: Arc<Scene>,
    /// The grid that the signals were made for.
    pub wanted: SampleWindow,
    /// The signals at the scope's inputs, and the ground truth.
    pub signals: Result<(Signals, GroundTruth), RunError>,
    /// Whether the scope does not trigger on them.
    pub is_hidden: bool,
    /// The records of the signals.
    pub prepared: Option<Prepared>,
    /// How often records were made of them.
    pub attempts: u32,
}

/// Ground truth of a shot (forces, displacements).
pub struct GroundTruth {
    /// Time of the signals' first sample after the striker's first contact (s).
    pub start: f64,
    /// Forces and motions.
    pub traces: Vec<Trace>,
}

impl BenchHandle {
    /// Starts the thread; it ends when the handle is dropped, after the simulation that is under
    /// way.
    ///
    /// # Errors
    /// The system's error if no thread can be started.
    pub fn start() -> io::Result<Self> {
        let (orders, inbox) = sync_channel::<BenchOrder>(1);
        let (sender, signals) = mpsc::channel(1);
        thread::Builder::new().name("bench".to_owned()).spawn(move || {
            let mut left = Indentations::default();
            for order in inbox {
                let (struck, preparation) = match order {
                    BenchOrder::Strike { scene, wanted, shot, faults, preparation } => {
                        (strike(scene, wanted, shot, faults, &mut left), preparation)
                    }
                    BenchOrder::Prepare { struck, preparation } => (*struck, preparation),
                };
                if sender.blocking_send(prepared(struck, *preparation)).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { orders, signals, under_way: false, shots: 0 })
    }

    /// Strikes with the next shot number, unless a strike is under way. Whether it does.
    pub fn strike(&mut self, scene: &Arc<Scene>, instrument: &Instrument) -> bool {
        let shot = self.shots.saturating_add(1);
        if self.under_way {
            return false;
        }
        let (wanted, preparation) = (instrument.sample_window(), instrument.preparation());
        let preparation = Box::new(preparation);
        let faults = (instrument.bench.faults.of_impact(), scene.seed);
        let scene = Arc::clone(scene);
        let order = BenchOrder::Strike { scene, wanted, shot, faults, preparation };
        let free = self.orders.try_send(order).is_ok();
        if free {
            self.shots = shot;
            self.under_way = true;
        }
        free
    }

    /// Has records made of signals again, with the settings of now.
    pub fn prepare_again(&mut self, struck: StrikeSignals, instrument: &Instrument) {
        let preparation = Box::new(instrument.preparation());
        let order = BenchOrder::Prepare { struck: Box::new(struck), preparation };
        self.under_way = self.orders.try_send(order).is_ok();
    }

    /// Waits for the signals of a strike.
    ///
    /// # Errors
    /// [`ServeError::BenchLost`] if the thread has ended.
    pub async fn signals(&mut self) -> Result<StrikeSignals, ServeError> {
        let signals = self.signals.recv().await;
        self.under_way = false;
        signals.ok_or(ServeError::BenchLost)
    }
}

fn strike(
    scene: Arc<Scene>,
    wanted: SampleWindow,
    shot: u32,
    (faults, seed): (Vec<Fault>, u64),
    left: &mut Indentations,
) -> StrikeSignals {
    let mut indented = Scene::clone(&scene);
    indented.keep_indentations(left);
    let SampleWindow { time_base, interval, before, after } = wanted;
    let window = InputWindow { interval, before, after };
    let signals = inputs(&indented, window, shot).map(|arrived| {
        *left = arrived.indentations;
        let truth = GroundTruth { start: arrived.start, traces: arrived.truth };
        let mut signals = Signals {
            time_base: Some(time_base),
            interval: arrived.interval,
            automatic: arrived.contact,
            volts: arrived.volts,
            external: arrived.external,
            shot,
        };
        for fault in &faults {
            fault.disturb(&mut signals, seed);
        }
        (signals, truth)
    });
    let is_hidden = faults.iter().any(Fault::hides_impact);
    StrikeSignals { shot, scene, wanted, signals, is_hidden, prepared: None, attempts: 0 }
}

/// `struck` with records of its signals.
fn prepared(mut struck: StrikeSignals, preparation: Preparation) -> StrikeSignals {
    struck.attempts += 1;
    struck.prepared = match &struck.signals {
        Ok((signals, _)) => Some(preparation.take(signals)),
        Err(_) => None,
    };
    struck
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strike that is asked for during another is not made: it would be recorded with the
    /// settings of now, and its order would keep the first one's from being recorded again.
    #[tokio::test]
    async fn a_second_strike_waits_for_the_signals_of_the_first() {
        let mut scene = Scene::load("magnet-0.61g").expect("a shipped scene");
        scene.accuracy = 1e-3;
        let instrument = Instrument::of(&scene.scope, scene.seed);
        let scene = Arc::new(scene);
        let mut bench = BenchHandle::start().expect("a thread");
        assert!(bench.strike(&scene, &instrument));
        assert!(!bench.strike(&scene, &instrument), "the first is under way");
        assert_eq!(bench.signals().await.expect("a bench").shot, 1);
        assert!(bench.strike(&scene, &instrument));
        assert_eq!(bench.signals().await.expect("a bench").shot, 2);
    }
}
