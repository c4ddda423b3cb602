//! The bench on a thread of its own: strikes the chain when told to, and hands over what arrives at the scope's inputs.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;

use tokio::sync::mpsc;

use super::ServeError;
use crate::experiment::RunError;
use crate::experiment::inputs::{InputWindow, inputs};
use crate::instrument::{SampleWindow, Signals};
use crate::scene::Scene;
use crate::trace::Trace;

/// A strike to be made.
struct StrikeOrder {
    scene: Arc<Scene>,
    wanted: SampleWindow,
    shot: u32,
}

/// The far end of the bench.
pub struct BenchHandle {
    orders: SyncSender<StrikeOrder>,
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
}

/// Ground truth of a shot (forces, displacements).
pub struct GroundTruth {
    /// Time of the signals' first sample after the striker's first contact (s).
    pub start: f64,
    /// Forces and motions.
    pub traces: Vec<Trace>,
}

impl BenchHandle {
    /// Starts the thread; it ends when the handle is dropped, after the simulation that is under way.
    ///
    /// # Errors
    /// The system's error if no thread can be started.
    pub fn start() -> io::Result<Self> {
        let (orders, inbox) = sync_channel::<StrikeOrder>(1);
        let (sender, signals) = mpsc::channel(1);
        thread::Builder::new().name("bench".to_owned()).spawn(move || {
            for order in inbox {
                if sender.blocking_send(strike(&order)).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { orders, signals, under_way: false, shots: 0 })
    }

    /// Strikes with the next shot number, unless a strike is under way. Whether it does.
    pub fn strike(&mut self, scene: &Arc<Scene>, wanted: SampleWindow) -> bool {
        let shot = self.shots.saturating_add(1);
        let order = StrikeOrder { scene: Arc::clone(scene), wanted, shot };
        let free = !self.under_way && self.orders.try_send(order).is_ok();
        if free {
            self.shots = shot;
            self.under_way = true;
        }
        free
    }

    /// Waits for what a strike brings.
    ///
    /// # Errors
    /// [`ServeError::BenchLost`] where the thread is no more.
    pub async fn struck(&mut self) -> Result<StrikeSignals, ServeError> {
        let struck = self.signals.recv().await;
        self.under_way = false;
        struck.ok_or(ServeError::BenchLost)
    }
}

fn strike(order: &StrikeOrder) -> StrikeSignals {
    let StrikeOrder { scene, wanted, shot } = order;
    let SampleWindow { interval, before, after } = *wanted;
    let window = InputWindow { interval, before, after };
    let signals = inputs(scene, window, *shot).map(|arrived| {
        let truth = GroundTruth { start: arrived.start, traces: arrived.truth };
        let signals = Signals {
            interval: arrived.interval,
            automatic: arrived.contact,
            volts: arrived.volts,
            external: arrived.external,
            shot: *shot,
        };
        (signals, truth)
    });
    StrikeSignals { shot: *shot, scene: Arc::clone(scene), wanted: *wanted, signals }
}
