//! hertzscope in Python, in process: `python/hertzscope` is what users see of this.
//!
//! Commands run as the program runs them and give the program's own JSON, so that no number can
//! differ; runs and recordings cross as arrays.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use hertzscope::cli;
use hertzscope::experiment::accuracy::run_to_accuracy;
use hertzscope::experiment::auto_effects::resolve_auto_effects;
use hertzscope::experiment::{Integration, facts};
use hertzscope::recording::true_signal::topic;
use hertzscope::recording::{self, Capture, Origin, Shot, TraceSet};
use hertzscope::report::to_json;
use hertzscope::scene::adjust::Adjustable;
use hertzscope::scope::Source;
use hertzscope::scope::waveform::{PointFormat, Preamble, VerticalSetup, Waveform};
use hertzscope::trace::Trace;
use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

pyo3::create_exception!(
    hertzscope,
    HertzscopeError,
    pyo3::exceptions::PyValueError,
    "What could not be done: the program's own sentences, with the place in a scene or file."
);

/// Longest time between two looks for signals, Ctrl-C among them.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(20);
/// Stack of a thread that integrates (bytes).
const STACK: usize = 32 << 20;

/// What unwinds a run that is to stop.
struct Stopped;

/// Does a job beside Python: other threads of Python go on, and a signal ends it.
fn interruptible<T: Send>(
    py: Python<'_>,
    job: impl FnOnce(&Arc<AtomicBool>) -> Option<T> + Send,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let waited = py.detach(|| {
        let (sender, done) = channel();
        thread::scope(|scope| {
            let work = || {
                let made = catch_unwind(AssertUnwindSafe(|| job(&stop)));
                // The other side waits until this arrives.
                let _ = sender.send(made);
            };
            let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
            if let Err(error) = worker {
                return Err(PyErr::from(error));
            }
            let mut signal = None;
            loop {
                match done.recv_timeout(SIGNAL_INTERVAL) {
                    Ok(made) => return Ok((made, signal)),
                    Err(RecvTimeoutError::Timeout) if signal.is_none() => {
                        signal = Python::attach(|py| py.check_signals()).err();
                        stop.store(signal.is_some(), Ordering::Relaxed);
                    }
                    Err(_) => (),
                }
            }
        })
    });
    match waited? {
        (_, Some(signal)) => Err(signal),
        (Ok(Some(made)), None) => Ok(made),
        (Ok(None), None) => Err(PyKeyboardInterrupt::new_err(())),
        (Err(fault), None) if fault.is::<Stopped>() => Err(PyKeyboardInterrupt::new_err(())),
        (Err(fault), None) => resume_unwind(fault),
    }
}

/// The sentences of an error and of what caused it.
fn sentences(error: &(dyn std::error::Error + 'static)) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let mut told: Vec<String> = Vec::new();
    for cause in causes.map(ToString::to_string) {
        if told.last().is_none_or(|last| !last.contains(&cause)) {
            told.push(cause);
        }
    }
    told.join(": ")
}

/// A recording in memory.
#[pyclass(frozen, name = "Recording", module = "hertzscope._hertzscope")]
struct RecordingInMemory {
    set: TraceSet,
    /// Of runs, each shot's summary as JSON.
    summaries: Vec<String>,
}

#[pymethods]
impl RecordingInMemory {
    /// Each shot's summary as JSON; empty for what was read.
    #[getter]
    fn summaries(&self) -> Vec<String> {
        self.summaries.clone()
    }

    /// How many shots there are.
    fn __len__(&self) -> usize {
        self.set.shots.len()
    }

    /// Shot `index`, counted from 0, with its arrays.
    fn shot<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        let found = self.set.shots.get(index);
        shot_of(py, found.ok_or_else(|| HertzscopeError::new_err("there is no such shot"))?)
    }

    /// Facts by group and name.
    #[getter]
    fn metadata(&self) -> BTreeMap<String, BTreeMap<String, String>> {
        self.set.metadata.clone()
    }

    /// Parts of the file that were not read, each with its reason.
    #[getter]
    fn problems(&self) -> Vec<String> {
        self.set.problems.clone()
    }

    /// Lines of the log.
    #[getter]
    fn log(&self) -> Vec<String> {
        self.set.log.clone()
    }

    /// Files carried along, by name.
    #[getter]
    fn attachments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for attachment in &self.set.attachments {
            files.set_item(&attachment.name, PyBytes::new(py, &attachment.data))?;
        }
        Ok(files)
    }

    /// Writes it as an MCAP file.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| recording::write(&path, &self.set))
            .map_err(|error| HertzscopeError::new_err(sentences(&error)))
    }
}

fn shot_of<'py>(py: Python<'py>, shot: &Shot) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("number", shot.number)?;
    dict.set_item("is_simulated", shot.origin == Origin::Simulated)?;
    dict.set_item("timestamp_ns", shot.timestamp_ns)?;
    dict.set_item("trigger_time", shot.trigger_time)?;
    let captures: PyResult<Vec<_>> = shot.captures.iter().map(|it| capture_of(py, it)).collect();
    dict.set_item("captures", captures?)?;
    let truth: PyResult<Vec<_>> = shot.truth.iter().map(|trace| trace_of(py, trace)).collect();
    dict.set_item("truth", truth?)?;
    Ok(dict)
}

fn trace_of<'py>(py: Python<'py>, trace: &Trace) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", topic(trace))?;
    let label = trace.name.split_once(": ").map_or(trace.name.as_str(), |(_, label)| label);
    dict.set_item("label", label)?;
    dict.set_item("unit", &trace.unit)?;
    dict.set_item("start", trace.start)?;
    dict.set_item("interval", trace.interval)?;
    dict.set_item("values", trace.values.clone().into_pyarray(py))?;
    Ok(dict)
}

fn capture_of<'py>(py: Python<'py>, capture: &Capture) -> PyResult<Bound<'py, PyDict>> {
    let waveform = &capture.waveform;
    let dict = PyDict::new(py);
    dict.set_item("name", waveform.source.to_string())?;
    dict.set_item("unit", &waveform.preamble.y_unit)?;
    dict.set_item("x_unit", &waveform.preamble.x_unit)?;
    dict.set_item("start", waveform.time(0))?;
    dict.set_item("interval", waveform.preamble.x_incr)?;
    let values: Vec<f64> = waveform.values().collect();
    dict.set_item("values", values.into_pyarray(py))?;
    dict.set_item("codes", waveform.codes.clone().into_pyarray(py))?;
    dict.set_item("level", waveform.preamble.y_mult)?;
    let clipped: Vec<u64> = waveform.clipped_points().map(|place| place as u64).collect();
    dict.set_item("clipped", clipped.into_pyarray(py))?;
    dict.set_item("scale", waveform.vertical.scale)?;
    dict.set_item("position", waveform.vertical.position)?;
    dict.set_item("probe", waveform.vertical.probe)?;
    dict.set_item("time_base", waveform.horizontal_scale)?;
    let instrument = capture.instrument.as_ref();
    let instrument = instrument.map(|it| (&it.model, &it.serial, &it.firmware));
    dict.set_item("instrument", instrument)?;
    dict.set_item("notes", capture.notes.clone())?;
    Ok(dict)
}

/// Runs a scene: a name, a file, or where it has a line end the text itself. Overrides are paths
/// with values as TOML has them.
#[pyfunction]
#[pyo3(signature = (scene, overrides, shots, accuracy, seed))]
fn run(
    py: Python<'_>,
    scene: &str,
    overrides: Vec<(String, String)>,
    shots: u32,
    accuracy: Option<f64>,
    seed: Option<u64>,
) -> PyResult<RecordingInMemory> {
    let made = interruptible(py, |stop| {
        Some(run_scene(scene, &overrides, (shots, accuracy, seed), stop))
    })?;
    made.map_err(|error| HertzscopeError::new_err(sentences(error.as_ref())))
}

fn run_scene(
    scene: &str,
    overrides: &[(String, String)],
    (shots, accuracy, seed): (u32, Option<f64>, Option<u64>),
    stop: &AtomicBool,
) -> Result<RecordingInMemory, Box<dyn std::error::Error + Send + Sync>> {
    let mut adjustable = if scene.contains('\n') {
        Adjustable::from_text("scene", "scene", scene)
    } else {
        Adjustable::load(scene)
    }?;
    let mut scene = adjustable.overridden("overrides", overrides)?;
    scene.seed = seed.unwrap_or(scene.seed);
    let accuracy = accuracy.unwrap_or(scene.accuracy);
    let integration = Integration::Accuracy(accuracy);
    let mut scene = resolve_auto_effects(&scene, integration).into_owned();
    let mut go_on = |_| {
        if stop.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Stopped));
        }
    };
    let (mut outcomes, mut summaries) = (Vec::new(), Vec::new());
    for number in 1..=shots {
        let outcome = run_to_accuracy(&scene, accuracy, number, &mut go_on)?;
        summaries.push(to_json(&outcome.summary)?);
        scene.keep_indentations(&outcome.indentations);
        outcomes.push(outcome);
    }
    let set = facts::recording(&scene, integration, outcomes)?;
    Ok(RecordingInMemory { set, summaries })
}

/// Reads a recording, a scope's file, or a folder of them.
#[pyfunction]
fn open(py: Python<'_>, path: PathBuf) -> PyResult<RecordingInMemory> {
    let set = interruptible(py, |_| Some(recording::open(&path)))?;
    let set = set.map_err(|error| HertzscopeError::new_err(sentences(&error)))?;
    Ok(RecordingInMemory { set, summaries: Vec::new() })
}

/// A recording of one shot of other data: name, samples and unit of each channel.
#[pyfunction]
fn of_arrays(
    channels: Vec<(String, PyReadonlyArray1<'_, f64>, String)>,
    interval: f64,
    start: f64,
) -> PyResult<RecordingInMemory> {
    let captures = channels.into_iter().map(|(name, values, unit)| {
        let source = Source::from_name(&name).ok_or_else(|| {
            HertzscopeError::new_err(format!("found the channel `{name}`, expected CH1 to CH4"))
        })?;
        let waveform = waveform(source, &values.as_array().to_vec(), unit, (interval, start));
        Ok(Capture { waveform, instrument: None, notes: Vec::new() })
    });
    let captures: PyResult<Vec<Capture>> = captures.collect();
    let shot = Shot {
        number: 1,
        origin: Origin::Measured,
        timestamp_ns: 0,
        captures: captures?,
        truth: Vec::new(),
        trigger_time: None,
    };
    let set = TraceSet { shots: vec![shot], ..TraceSet::default() };
    Ok(RecordingInMemory { set, summaries: Vec::new() })
}

/// Levels on each side of zero into which arrays are divided: what 16 bits hold, with some room.
const LEVELS: f64 = 32_000.0;

/// Samples as a record of 16 bits, zero in their middle.
fn waveform(
    source: Source,
    values: &[f64],
    unit: String,
    (interval, start): (f64, f64),
) -> Waveform {
    const DIVISIONS: f64 = 10.0;
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let level = if largest > 0.0 { largest / LEVELS } else { 1.0 };
    Waveform {
        source,
        codes: values.iter().map(|value| (value / level).round() as i16).collect(),
        as_read: values.to_vec(),
        preamble: Preamble {
            x_zero: start,
            x_incr: interval,
            pt_off: 0,
            x_unit: "s".to_owned(),
            y_mult: level,
            y_zero: 0.0,
            y_off: 0.0,
            y_unit: unit,
            pt_fmt: PointFormat::Sample,
        },
        vertical: VerticalSetup {
            // Eight divisions are the whole screen.
            scale: 2.0 * level * LEVELS / 8.0,
            position: 0.0,
            coupling: None,
            bandwidth_limited: None,
            inverted: None,
            probe: 1.0,
        },
        horizontal_scale: interval * values.len() as f64 / DIVISIONS,
        trigger_point: -start / interval,
    }
}

/// Runs one of the program's commands: its exit code, what it prints, what it says beside that.
#[pyfunction]
fn command(py: Python<'_>, words: Vec<OsString>) -> PyResult<(u8, String, String)> {
    let answer = interruptible(py, |stop| cli::answer(&words, stop))?;
    Ok((answer.code, answer.output, answer.messages))
}

/// Runs the program as from a command line; returns its exit code.
#[pyfunction]
fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| cli::main(words))
}

#[pymodule]
fn _hertzscope(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("HertzscopeError", module.py().get_type::<HertzscopeError>())?;
    module.add_class::<RecordingInMemory>()?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(open, module)?)?;
    module.add_function(wrap_pyfunction!(of_arrays, module)?)?;
    module.add_function(wrap_pyfunction!(command, module)?)?;
    module.add_function(wrap_pyfunction!(main, module)?)
}
