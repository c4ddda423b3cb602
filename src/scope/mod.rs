//! The virtual oscilloscope: front end, time base, edge trigger, digitiser, record with
//! preamble.
//!
//! Stands between `sensor`, which delivers volts on a sample grid, and `recording`, which keeps
//! what was taken. No I/O. A model's limits are data, `instruments/<model>.toml`; behaviour follows
//! Tektronix' TDS2000 manuals (user manual 071-1064, programmer manual 071-1075) and is marked in
//! the data file where it is from memory.

pub mod acquire;
pub mod front_end;
pub mod limits;
pub mod model;
pub mod panel;
pub mod set_up;
pub mod setup;
pub mod waveform;
pub mod word;

pub use model::Model;
pub use panel::Panel;
pub use setup::{
    AcquireMode, AcquireSetup, ChannelSetup, Deviation, EdgeCoupling, Setup, Slope, Trigger,
    TriggerMode, TriggerSource,
};
pub use waveform::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
