//! The bench on a thread of its own: strikes the chain when told to, and hands over what arrives at the scope's inputs.

use std::io;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread;

use tokio::sync::mpsc;

use super::ServeError;
use crate::experiment::inputs::{Window, inputs};
use crate::instrument::{Signals, Wanted};
use crate::scene::Scene;

/// The far end of the bench.
pub struct Handle {
    orders: SyncSender<(Wanted, u32)>,
    signals: mpsc::Receiver<Result<Signals, ServeError>>,
    under_way: bool,
    shots: u32,
}

impl Handle {
    /// Starts the thread; it ends when the handle is dropped, after the simulation that is under way.
    ///
    /// # Errors
    /// What the system says when there is no thread to be had.
    pub fn start(scene: Scene) -> io::Result<Self> {
        let (orders, inbox) = sync_channel::<(Wanted, u32)>(1);
        let (sender, signals) = mpsc::channel(1);
        thread::Builder::new().name("bench".to_owned()).spawn(move || {
            for (wanted, shot) in inbox {
                if sender.blocking_send(strike(&scene, wanted, shot)).is_err() {
                    break;
                }
            }
        })?;
        Ok(Self { orders, signals, under_way: false, shots: 0 })
    }

    /// Strikes with the next shot number, unless a strike is under way.
    pub fn strike(&mut self, wanted: Wanted) {
        if !self.under_way && self.orders.try_send((wanted, self.shots.saturating_add(1))).is_ok() {
            self.shots = self.shots.saturating_add(1);
            self.under_way = true;
        }
    }

    /// Waits for what a strike brings.
    ///
    /// # Errors
    /// [`ServeError`] where the chain could not be followed, and where the thread is no more.
    pub async fn signals(&mut self) -> Result<Signals, ServeError> {
        let signals = self.signals.recv().await;
        self.under_way = false;
        signals.unwrap_or(Err(ServeError::BenchLost))
    }
}

fn strike(scene: &Scene, wanted: Wanted, shot: u32) -> Result<Signals, ServeError> {
    let Wanted { interval, before, after } = wanted;
    let arrived = inputs(scene, Window { interval, before, after }, shot)
        .map_err(|reason| ServeError::Impact { shot, reason })?;
    Ok(Signals {
        interval: arrived.interval,
        automatic: arrived.contact,
        volts: arrived.volts,
        external: arrived.external,
        shot,
    })
}
