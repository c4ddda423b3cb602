//! `hertzscope acquire`: a real scope's traces into a recording; and one shot of a scope for other
//! commands.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Serialize;
use signal_hook::consts::TERM_SIGNALS;

use super::overwrite::ending;
use crate::client::{
    AcquisitionEvent, Address, ClientError, ClientTiming, LineEvent, ShotAcquisition,
    create_recording, instruments,
};
use crate::recording::TraceSet;

/// Record the displayed traces of a scope after each of its triggers: over USB, VXI-11, HiSLIP, a
/// socket, a serial line, or GPIB behind a Prologix adapter
#[derive(Debug, Args)]
pub struct Arguments {
    /// The scope: `/dev/usbtmc0` or `USB0::0x0699::0x0363::SERIAL::INSTR`, `tcp://HOST:PORT`,
    /// `TCPIP::HOST::INSTR` (VXI-11), `TCPIP::HOST::hislip0::INSTR`,
    /// `serial:/dev/ttyUSB0?baud=19200` (RTS/CTS flow control), or `prologix://HOST?gpib=1`
    #[arg(value_parser = str::parse::<Address>, required_unless_present = "list")]
    address: Option<Address>,
    /// Recording to write (.mcap); if it exists, a number is appended; it can be read while it
    /// grows (`view FILE --follow`)
    #[arg(short, long, value_name = "FILE.mcap", required_unless_present = "list")]
    output: Option<PathBuf>,
    /// List the instruments on USB and the serial ports that are there
    #[arg(long, conflicts_with_all = ["address", "output", "shots"])]
    list: bool,
    /// End after this many shots [default: at Ctrl-C]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    shots: Option<u32>,
    /// Print what was recorded as JSON
    #[arg(long)]
    json: bool,
    /// Print no status messages
    #[arg(short, long)]
    quiet: bool,
}

/// Set by the first signal that ends programs; the second ends this one.
pub struct StopSignal(pub Arc<AtomicBool>);

impl StopSignal {
    /// Catches these signals from now on.
    pub fn new() -> anyhow::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        #[cfg(unix)]
        let hang_up = Some(signal_hook::consts::SIGHUP);
        #[cfg(not(unix))]
        let hang_up = None;
        for signal in TERM_SIGNALS.iter().copied().chain(hang_up) {
            signal_hook::flag::register_conditional_default(signal, Arc::clone(&stop))?;
            signal_hook::flag::register(signal, Arc::clone(&stop))?;
        }
        Ok(Self(stop))
    }
}

impl Drop for StopSignal {
    /// From now on the first signal ends the program.
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Counts of problems during an acquisition.
#[derive(Debug, Default)]
struct Troubles {
    line_failures: u32,
    dropped: u32,
    contradictions: u32,
}

impl Troubles {
    /// Counts an event of `shot` and reports it to the user.
    fn note(&mut self, event: &AcquisitionEvent, (shot, trigger): (&str, &str), quiet: bool) {
        let (is_trouble, words) = match event {
            AcquisitionEvent::Armed => {
                (false, format!("waiting for a trigger, {trigger} (Ctrl-C ends)"))
            }
            AcquisitionEvent::Triggered => (false, "triggered, reading".to_owned()),
            AcquisitionEvent::Line(LineEvent::Failed(why)) => {
                self.line_failures += 1;
                (true, format!("the line failed ({why}): trying again"))
            }
            AcquisitionEvent::Line(LineEvent::Back) => (true, "the line works again".to_owned()),
            AcquisitionEvent::ArmedAgain(why) => (true, format!("{why}: armed again")),
            AcquisitionEvent::Dropped(why) => {
                self.dropped += 1;
                (true, format!("not recorded: {why}"))
            }
            AcquisitionEvent::ReadAgain(why) => {
                (true, format!("{why}: read again, and consistent now"))
            }
            AcquisitionEvent::Contradiction(why) => {
                self.contradictions += 1;
                (true, format!("{why}: read twice, recorded with this note"))
            }
        };
        if !quiet {
            let warning = if is_trouble { "warning: " } else { "" };
            super::say(&format!("{warning}{shot}: {words}"));
        }
    }
}

/// What was recorded.
#[derive(Serialize)]
struct Acquired<'a> {
    file: &'a Path,
    shots: u32,
    address: String,
    model: &'a str,
    serial: &'a str,
    firmware: &'a str,
    line_failures: u32,
    dropped: u32,
    contradictions: u32,
}

/// Something that a scope may be connected to.
#[derive(Serialize)]
struct Line {
    address: String,
    name: String,
}

/// Prints the instruments on USB and the serial ports.
fn list(json: bool) -> anyhow::Result<()> {
    let usb = instruments().into_iter().map(|found| {
        let serial = found.identity.map(|identity| identity.serial).filter(|text| !text.is_empty());
        let serial = serial.map_or(String::new(), |serial| format!(", serial number {serial}"));
        Line { address: found.device.display().to_string(), name: format!("{}{serial}", found.name) }
    });
    let ports = serial2::SerialPort::available_ports().unwrap_or_default();
    let ports = ports.into_iter().map(|port| Line {
        address: format!("serial:{}", port.display()),
        name: "serial port".to_owned(),
    });
    let lines: Vec<Line> = usb.chain(ports).collect();
    super::show(&lines, json, |lines| {
        let rows = lines.iter().map(|line| format!("{}  {}", line.address, line.name));
        let rows: Vec<String> = rows.collect();
        if rows.is_empty() {
            "no instrument on USB (/dev/usbtmc*) and no serial port is there; instruments on the network are not searched for"
                .to_owned()
        } else {
            rows.join("\n")
        }
    })
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (Some(address), Some(output)) = (&arguments.address, &arguments.output) else {
        return list(arguments.json);
    };
    ending(output, &["mcap"])?;
    let stop = StopSignal::new()?;
    let mut scope = begin(address, &stop, arguments.quiet)?;
    let mut troubles = Troubles::default();
    let recorded = record(arguments, (address, output), &mut scope, &mut troubles);
    let instrument = scope.instrument().clone();
    // The scope is restored in every case; the first error is reported.
    let restored = scope.end();
    let (file, shots) = recorded?;
    restored?;
    let found = Acquired {
        file: &file,
        shots,
        address: address.to_string(),
        model: &instrument.model,
        serial: &instrument.serial,
        firmware: &instrument.firmware,
        line_failures: troubles.line_failures,
        dropped: troubles.dropped,
        contradictions: troubles.contradictions,
    };
    super::show(&found, arguments.json, |found| {
        let plural = if shots == 1 { "" } else { "s" };
        format!("recorded    {}: {shots} shot{plural}", found.file.display())
    })?;
    if let Some(wanted) = arguments.shots.filter(|wanted| *wanted > shots) {
        bail!("stopped after {shots} of {wanted} shots");
    }
    Ok(())
}

/// Connects, and prints what is there.
fn begin(
    address: &Address,
    stop: &StopSignal,
    quiet: bool,
) -> Result<ShotAcquisition, ClientError> {
    let scope = ShotAcquisition::begin(address, ClientTiming::default(), &stop.0)?;
    if !quiet {
        let model = &scope.instrument().model;
        let traces: Vec<String> = scope.displayed().iter().map(ToString::to_string).collect();
        super::say(&format!("{model} at {address}: {}", traces.join(", ")));
        if let Some(mode) = scope.replaced_trigger_mode() {
            super::say(&format!("note: the trigger mode {mode} is NORMAL until the end"));
        }
    }
    Ok(scope)
}

/// Records until it is stopped or has all shots: the file, and how many it has.
fn record(
    arguments: &Arguments,
    (address, output): (&Address, &Path),
    scope: &mut ShotAcquisition,
    troubles: &mut Troubles,
) -> anyhow::Result<(PathBuf, u32)> {
    let quiet = arguments.quiet;
    let mut recorder = create_recording(output, address, scope.instrument())?;
    if !quiet {
        super::say(&format!("recording   {}", recorder.file().display()));
    }
    let trigger = scope.trigger().to_owned();
    let mut shots = 0;
    while arguments.shots.is_none_or(|wanted| shots < wanted) {
        let number = shots + 1;
        let of = arguments.shots.map_or_else(String::new, |wanted| format!(" of {wanted}"));
        let name = format!("shot {number}{of}");
        let mut tell = |event: AcquisitionEvent| troubles.note(&event, (&name, &trigger), quiet);
        let taken = match scope.shot(&mut tell) {
            Ok(Some(taken)) => taken,
            Ok(None) => break,
            Err(error) => {
                // What was recorded stays.
                recorder.finish()?;
                return Err(error.into());
            }
        };
        let (shot, notes) = taken.numbered(number, address);
        recorder.add(&shot, &notes)?;
        shots = number;
        if !quiet {
            let traces: Vec<String> =
                shot.captures.iter().map(|c| c.waveform.source.to_string()).collect();
            super::say(&format!("{name}: recorded {}", traces.join(", ")));
        }
    }
    Ok((recorder.finish()?, shots))
}

/// One shot of the scope at `path`, if that is an address.
pub fn one_shot(path: &Path) -> anyhow::Result<Option<TraceSet>> {
    let Some(address) = path.to_str().map(Address::recognise).transpose()?.flatten() else {
        return Ok(None);
    };
    let stop = StopSignal::new()?;
    let mut scope = begin(&address, &stop, false)?;
    let mut troubles = Troubles::default();
    let trigger = scope.trigger().to_owned();
    let mut tell = |event| troubles.note(&event, ("one shot", &trigger), false);
    let taken = scope.shot(&mut tell);
    let instrument = scope.instrument().clone();
    let restored = scope.end();
    let taken = taken?;
    restored?;
    let taken = taken.with_context(|| format!("{address}: stopped before a trigger"))?;
    Ok(Some(taken.into_set(&address, &instrument)))
}
