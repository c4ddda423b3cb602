//! The actions of the user.

use super::Popup;
use super::state::{Page, SidePanel};
use crate::scope::Source;
use crate::tui::axis::TurnDirection;

/// An action of a key or the mouse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Leave the screen.
    Quit,
    /// Close the open panel; without one, leave.
    Back,
    /// Open a panel, or close it when it is open.
    Toggle(Popup),
    /// Move the text of a panel; select another row on a page that is a list.
    Scroll(TurnDirection),
    /// Press a channel's button, counted from 1: selects it and turns it on; if it is selected,
    /// turns it off or on.
    Channel(u8),
    /// The same with any trace.
    Trace(Source),
    /// Select the next trace, or the one before.
    NextTrace(TurnDirection),
    /// Turn the selected trace off or on.
    OnOff,
    /// Turn the selected trace's V/div knob.
    VoltsPerDivision(TurnDirection),
    /// Turn the s/div knob.
    TimePerDivision {
        /// Up is more seconds a division.
        turn: TurnDirection,
        /// The fixed point of the zoom, to the right of the screen's centre (div).
        anchor: f64,
    },
    /// Move the selected trace down or up.
    Position(TurnDirection),
    /// Move the picture left or right.
    Pan(TurnDirection),
    /// The next of several recordings comes to the front.
    NextRecording,
    /// Show another shot.
    Shot(TurnDirection),
    /// Back to how everything was recorded.
    Reset,
    /// The first shot, or the last.
    Ends(TurnDirection),
    /// Play or stop a recording, run or stop a bench.
    RunStop,
    /// Play twice as fast, or half.
    Speed(TurnDirection),
    /// So many seconds have passed (s).
    Tick(f64),
    /// Open a page, or close it when it is open.
    Page(Page),
    /// Open what stands beside the page, or close it.
    Side(SidePanel),
    /// The comparison: its page, its next view, away.
    Compare,
    /// The next kind of cursors.
    Cursors,
    /// The other cursor moves now.
    OtherCursor,
    /// Move the active cursor.
    MoveCursor(TurnDirection),
    /// Move it to the next peak or edge.
    Snap(TurnDirection),
    /// Move it to the first arrival.
    SnapToArrival,
    /// A mouse button goes down.
    Press {
        /// To the right of the graticule's centre (div).
        x: f64,
        /// Above it (div).
        y: f64,
    },
    /// The mouse moves with its button down.
    Drag {
        /// To the right of the graticule's centre (div).
        x: f64,
        /// Above it (div).
        y: f64,
    },
    /// The next math trace.
    Math,
    /// Keep the selected trace as a reference, or empty the selected reference.
    Reference,
    /// Shows or hides the simulated forces at the sensors.
    Truth,
    /// Shows or hides where 95 % of the bench's traces lie.
    Bands,
    /// Volts or newtons.
    Unit,
    /// Earlier shots stay on screen, or not.
    Persistence,
    /// Scales and positions that show everything.
    Autoset,
    /// Wait for one trigger.
    Single,
    /// Take a record without a trigger.
    Force,
    /// Strike the chain.
    Impact,
    /// Turn the trigger level.
    TriggerLevel(TurnDirection),
    /// The trigger's other edge.
    TriggerSlope,
    /// The trigger's other mode.
    TriggerMode,
    /// The selected channel's next coupling.
    Coupling,
    /// The selected channel's next probe.
    Probe,
    /// Select the next knob or effect.
    NextKnob(TurnDirection),
    /// Turn the selected knob.
    TurnKnob(TurnDirection),
    /// Switch the selected effect.
    Switch,
    /// Open the command line, with these words typed already.
    Prompt(&'static str),
    /// Type a letter.
    Type(char),
    /// Take the last letter back.
    Erase,
    /// Do what was typed.
    Submit,
    /// Complete the word that is being typed.
    Complete,
    /// Bring back the line that was typed before, or after.
    Recall(TurnDirection),
    /// Search the help.
    Search,
    /// Type a value for the selected knob.
    TypeKnob,
    /// The selected channel's bandwidth limit, on or off.
    Bandwidth,
    /// The next trigger source.
    TriggerSource,
    /// The next acquisition mode, or number of averages.
    Acquisition,
}
