"""Runs, recordings and the program's commands as functions; `import hertzscope` has their names."""

from __future__ import annotations

import functools
import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from . import _hertzscope
from ._hertzscope import HertzscopeError as HertzscopeError

if TYPE_CHECKING:
    import pandas
    import xarray

Floats = npt.NDArray[np.float64]
#: A value in a scene: a quantity with its unit, "0.5 m/s", or a plain number, a flag, a name.
Value = Union[str, float, int, bool]
#: A recording, a file, a folder of files, or where a scene is meant its name or its text.
Source = Union["Recording", str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Trace:
    """An evenly sampled signal."""

    #: Its name: a channel, `CH2`, or what the truth is of: `sensor/p14`, `contact/3`, `bead/1`.
    name: str
    #: Unit of the values.
    unit: str
    #: Abscissa of the first sample, in `x_unit`.
    start: float
    #: From one sample to the next, in `x_unit`.
    interval: float
    #: The samples in `unit`, shape (samples,).
    values: Floats = field(repr=False)
    #: Unit of the abscissa: `s`, or `Hz` for a spectrum that a scope has saved.
    x_unit: str = "s"
    #: What it is, in words.
    label: str = ""

    @property
    def times(self) -> Floats:
        """Abscissae in `x_unit`, shape (samples,): captures count from the trigger, truth from the striker's first contact."""
        return self.start + self.interval * np.arange(len(self.values), dtype=np.float64)

    def to_pandas(self) -> pandas.Series[float]:
        """A series over its times; `attrs` has the units."""
        import pandas

        index = pandas.Index(self.times, name=f"time ({self.x_unit})" if self.x_unit == "s" else f"frequency ({self.x_unit})")
        series = pandas.Series(self.values, index=index, name=self.name)
        series.attrs["units"] = self.unit
        return series

    def to_xarray(self) -> xarray.DataArray:
        """An array over `time` (or `frequency`); `attrs["units"]` of both have their units."""
        import xarray

        axis = "time" if self.x_unit == "s" else "frequency"
        array = xarray.DataArray(self.values, dims=axis, coords={axis: self.times}, name=self.name, attrs={"units": self.unit})
        array[axis].attrs["units"] = self.x_unit
        return array

    def plot(self, axes: Any = None, **keywords: Any) -> Any:
        """Draws it with matplotlib, on `axes` or new ones, which are returned; `keywords` are those of `Axes.plot`."""
        axes = _axes(axes)
        axes.plot(self.times, self.values, **{"label": self.name, **keywords})
        axes.set_xlabel(f"Time ({self.x_unit})" if self.x_unit == "s" else f"Frequency ({self.x_unit})")
        axes.set_ylabel(f"{self.name} ({self.unit})")
        return axes


@dataclass(frozen=True)
class Capture(Trace):
    """What the scope recorded of one channel."""

    #: Digitiser levels, shape (samples,).
    codes: npt.NDArray[np.int16] = field(repr=False, default_factory=lambda: np.zeros(0, np.int16))
    #: One level, in `unit`.
    level: float = 0.0
    #: Places of samples at the converter's ends, where the true value may lie beyond.
    clipped: npt.NDArray[np.uint64] = field(repr=False, default_factory=lambda: np.zeros(0, np.uint64))
    #: Vertical scale, in `unit` a division.
    scale: float = 0.0
    #: Position of zero, in divisions above the centre.
    position: float = 0.0
    #: Attenuation of the probe.
    probe: float = 1.0
    #: Horizontal scale, in `x_unit` a division.
    time_base: float = 0.0
    #: Model, serial number and firmware of the instrument, if they are known.
    instrument: tuple[str, str, str] | None = None
    #: What is odd about it, or was guessed.
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Shot:
    """One impact, and what the scope recorded of it."""

    #: Counted from 1.
    number: int
    #: Whether it was simulated, not measured.
    is_simulated: bool
    #: When the scope triggered, in nanoseconds since 1970; simulations count from 0.
    timestamp_ns: int
    #: The trigger on the clock of the truth, in s; None for a measurement.
    trigger_time: float | None
    #: What the scope recorded, by channel.
    captures: dict[str, Capture]
    #: Of a simulation, what no sensor saw: forces at sensors and in contacts, displacements of particles.
    truth: dict[str, Trace]

    def to_pandas(self) -> pandas.DataFrame:
        """The captures as columns over their times; `attrs["units"]` has the unit of each."""
        import pandas

        frame = pandas.DataFrame({name: capture.to_pandas() for name, capture in self.captures.items()})
        frame.attrs["units"] = {name: capture.unit for name, capture in self.captures.items()}
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """The captures as variables, each with its `units`."""
        import xarray

        return xarray.Dataset({name: capture.to_xarray() for name, capture in self.captures.items()})

    def plot(self, axes: Any = None) -> Any:
        """Draws all channels with matplotlib, on `axes` or new ones, which are returned."""
        axes = _axes(axes)
        for capture in self.captures.values():
            capture.plot(axes)
        axes.set_ylabel(" / ".join(sorted({capture.unit for capture in self.captures.values()})))
        axes.legend()
        return axes


class Recording(Sequence[Shot]):
    """Shots in order of time, and what is known of their bench: `recording[0]` is the first shot."""

    def __init__(self, inner: _hertzscope.Recording, path: str | None = None) -> None:
        self._inner = inner
        self._path = path
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._shots: dict[int, Shot] = {}

    def __len__(self) -> int:
        return len(self._inner)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[place] for place in range(*index.indices(len(self)))]
        place = index + len(self) if index < 0 else index
        if not 0 <= place < len(self):
            raise IndexError(f"shot {index} of {len(self)}")
        if place not in self._shots:
            self._shots[place] = _shot(self._inner.shot(place))
        return self._shots[place]

    def __iter__(self) -> Iterator[Shot]:
        return (self[place] for place in range(len(self)))

    def __repr__(self) -> str:
        channels = ", ".join(self[0].captures) if len(self) else "none"
        return f"<Recording of {self.metadata.get('hertzscope:recording', {}).get('scene', self._path)}: {len(self)} shots; {channels}>"

    @functools.cached_property
    def summaries(self) -> list[Result]:
        """What `hertzscope run --json` prints of each shot: first peaks, arrivals, speeds, energies, the estimated error. Empty for what was read."""
        return [Result(json.loads(summary)) for summary in self._inner.summaries]

    @property
    def summary(self) -> Result:
        """That of the only shot, or of the first one."""
        if not self.summaries:
            raise HertzscopeError("a recording that was read has no summary: arrivals(recording) finds what its traces say")
        return self.summaries[0]

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """Facts on the bench, by group and name."""
        return self._inner.metadata

    @property
    def problems(self) -> list[str]:
        """Parts of the file that were not read, each with its reason."""
        return self._inner.problems

    @property
    def log(self) -> list[str]:
        """Lines of the log."""
        return self._inner.log

    @property
    def attachments(self) -> dict[str, bytes]:
        """Files that travel with it by name, the scene among them."""
        return self._inner.attachments

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes it as an MCAP file, which the program and other readers of MCAP open."""
        self._inner.save(path)

    def _file(self) -> str:
        """A file that commands can read."""
        if self._path is None:
            self._folder = tempfile.TemporaryDirectory(prefix="hertzscope-")
            scene = self.metadata.get("hertzscope:recording", {}).get("scene", "recording")
            self._path = os.path.join(self._folder.name, f"{Path(scene).name}.mcap")
            self._inner.save(self._path)
        return self._path


class Result(dict[str, Any]):
    """What a command found, with the keys of its `--json`; `result.sensors` is `result["sensors"]`."""

    #: Whether the answer is yes (exit code 0 of the program; `compare`: within the tolerance, `calibrate`: certified).
    is_yes: bool = True
    #: What the program says beside its answer.
    messages: str = ""

    def __getattr__(self, name: str) -> Any:
        try:
            found = self[name]
        except KeyError:
            raise AttributeError(f"there is no '{name}' here, but {', '.join(self)}") from None
        return Result(found) if isinstance(found, dict) else found

    def to_pandas(self, key: str) -> pandas.DataFrame:
        """The list of tables at `key` as a frame, a row for each; nested keys become `a.b`."""
        import pandas

        return pandas.json_normalize(self[key])


def run(
    scene: str | os.PathLike[str],
    overrides: Mapping[str, Value] | None = None,
    *,
    shots: int = 1,
    accuracy: float | None = None,
    seed: int | None = None,
) -> Recording:
    """Runs a scene.

    `scene` is the name of an included scene, a file, or the text of one. `overrides` are values by their paths in the scene, as in
    sweeps: `{"striker.speed": "0.5 m/s", "particles.*.mass": "1 g"}`. `accuracy` is the relative error that first peaks and arrivals may
    have. Ctrl-C ends the run, and other threads of Python go on beside it.

    Raises `HertzscopeError` with all that is wrong in the scene, each with its line.
    """
    text = os.fspath(scene)
    values = [(path, _toml(value)) for path, value in (overrides or {}).items()]
    return Recording(_hertzscope.run(text, values, shots, accuracy, seed))


def open(path: str | os.PathLike[str]) -> Recording:
    """Reads a recording (.mcap), a scope's file (.csv, .isf and others), or a folder of them."""
    return Recording(_hertzscope.open(path), os.fspath(path))


def recording(
    arrays: Mapping[str, npt.ArrayLike],
    interval: float,
    *,
    start: float = 0.0,
    units: Mapping[str, str] | str = "V",
    scene: str | os.PathLike[str] | None = None,
) -> Recording:
    """A recording of any data, for instance a digitiser's: `arrays` by channel, `CH1` to `CH4`, each of shape (samples,).

    `interval` is the time from one sample to the next, `start` that of the first after the trigger, in s. `units` is one unit, or one for
    each channel. `scene` names the bench: its sensors turn volts into newtons. Values are kept in 16 bits, as all captures are: to 1/64,000
    of a channel's largest.
    """
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in arrays.items()}
    shapes = {values.shape for values in columns.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1:
        raise HertzscopeError(f"found arrays of shapes {sorted(shapes)}, expected one or more of the same shape (samples,)")
    for name, values in columns.items():
        if not np.isfinite(values).all():
            place = int(np.flatnonzero(~np.isfinite(values))[0])
            raise HertzscopeError(f"{name}: found {values[place]} at sample {place}, expected finite numbers")
    if not (np.isfinite(interval) and interval > 0 and np.isfinite(start)):
        raise HertzscopeError(f"found an interval of {interval} s from {start} s on, expected finite numbers and an interval above 0")
    channels = [(name, values, units if isinstance(units, str) else units[name]) for name, values in columns.items()]
    made = Recording(_hertzscope.of_arrays(channels, interval, start))
    if scene is None:
        return made
    with tempfile.TemporaryDirectory(prefix="hertzscope-") as folder:
        target = os.path.join(folder, "with-scene.mcap")
        command("convert", made, target, scene=scene)
        return Recording(_hertzscope.open(target))


def command(name: str, *inputs: Source | float, **options: Any) -> Result:
    """Runs one of the program's commands and returns its `--json`; `hertzscope help COMMAND` has the options.

    An option's name is that of the program with `_` for `-`: `free=["striker.speed"]` is `--free striker.speed`; lists are joined by
    commas, `True` is an option without a value, `None` none. Where nothing is printed as JSON, the result is empty, and `messages` has
    what is said.
    """
    words = ["hertzscope", name]
    keep: list[tempfile.TemporaryDirectory[str]] = []
    words += [_word(given, keep) for given in inputs]
    for option, value in options.items():
        if value is None or value is False:
            continue
        words.append(f"--{option.replace('_', '-')}")
        if value is True:
            continue
        items = value if isinstance(value, (list, tuple)) else [value]
        # With the option in one word, a value may begin with a minus sign.
        words[-1] += "=" + ",".join(_word(item, keep) for item in items)
    if name not in _WITHOUT_JSON:
        words.append("--json")
    if name in _WITH_PROGRESS:
        words.append("--quiet")
    code, output, messages = _hertzscope.command(words)
    if code == 2:
        raise HertzscopeError(messages.strip().removeprefix("error: "))
    found = json.loads(output) if output.lstrip().startswith(("{", "[")) else {}
    result = Result(found if isinstance(found, dict) else {"rows": found})
    result.is_yes = code == 0
    result.messages = messages
    return result


#: Commands that print no JSON.
_WITHOUT_JSON = {"convert"}
#: Commands that show their progress unless they are told not to.
_WITH_PROGRESS = {"budget", "calibrate", "compare", "convert", "cost", "effects", "fit", "sweep"}


def _wrapped(name: str, inputs: str, finds: str) -> Any:
    def wrapper(*given: Source | float, **options: Any) -> Result:
        return command(name, *given, **options)

    wrapper.__name__ = wrapper.__qualname__ = name
    wrapper.__doc__ = f"""{finds}

    `{name}({inputs})`: `hertzscope {name}` in this process. Options are keywords, `hertzscope {name} --help` lists them. Returns a `Result` with the
    keys of `--json`; raises `HertzscopeError` with the command's sentences.
    """
    return wrapper


arrivals = _wrapped("arrivals", "recording", "First peaks, arrivals and speeds with uncertainties.")
force = _wrapped("force", "recording", "Forces of the sensors' voltages.")
spectrum = _wrapped("spectrum", "recording, channel=...", "Spectra, by FFT or Welch's method.")
spectrogram = _wrapped("spectrogram", "recording, channel=...", "Spectra over time.")
transfer = _wrapped("transfer", "recording, between=...", "Transfer function and coherence between two channels.")
dispersion = _wrapped("dispersion", "recording", "Frequency over wave number.")
bands = _wrapped("bands", "scene", "Bands and gaps of a scene's chain.")
compare = _wrapped("compare", "measured, simulated", "Measurement against simulation; `is_yes` tells whether all is within the tolerance.")
fit = _wrapped("fit", "measured, scene, free=[...]", "Numbers of a scene fitted to measured traces.")
calibrate = _wrapped("calibrate", "plan", "A sensor's sensitivity by momentum tests; `is_yes` tells whether it is certified.")
budget = _wrapped("budget", "scene", "Uncertainty of first peaks and arrivals by the inputs that are stated.")
effects = _wrapped("effects", "scene", "Effects of a scene: on or off, why, and what each changes.")
cost = _wrapped("cost", "scene", "Error over computing time.")
info = _wrapped("info", "recording", "What a recording or file contains.")
scenes = _wrapped("scenes", "", "The included scenes.")


def sweep(plan: str | os.PathLike[str], **options: Any) -> pandas.DataFrame:
    """Runs the sweep that `plan` describes, a file or its text; returns a row for each run, `attrs["summary"]` has the command's result.

    Units are in the names of the columns. Ctrl-C ends it.
    """
    import pandas

    with tempfile.TemporaryDirectory(prefix="hertzscope-") as folder:
        text = os.fspath(plan)
        if "\n" in text:
            plan = Path(folder, "plan.toml")
            plan.write_text(text, encoding="utf-8")
        table = Path(folder, "table.csv")
        options.setdefault("folder", os.path.join(folder, "runs"))
        summary = command("sweep", plan, output=table, **options)
        frame = pandas.read_csv(table)
    frame.attrs["summary"] = dict(summary)
    return frame


def _toml(value: Value) -> str:
    """A value as TOML has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float, np.integer, np.floating)):
        return repr(value.item() if isinstance(value, np.generic) else value)
    return json.dumps(str(value))


def _word(given: Any, keep: list[tempfile.TemporaryDirectory[str]]) -> str:
    """An input as a word of the command line; a text of several lines as a file."""
    if isinstance(given, Recording):
        return given._file()
    if isinstance(given, str) and "\n" in given:
        keep.append(tempfile.TemporaryDirectory(prefix="hertzscope-"))
        file = Path(keep[-1].name, "scene.toml")
        file.write_text(given, encoding="utf-8")
        return str(file)
    return str(os.fspath(given) if isinstance(given, os.PathLike) else given)


def _shot(found: dict[str, Any]) -> Shot:
    captures = {entry["name"]: Capture(**{**entry, "notes": tuple(entry["notes"])}) for entry in found.pop("captures")}
    truth = {entry["name"]: Trace(**entry) for entry in found.pop("truth")}
    return Shot(captures=captures, truth=truth, **found)


def _axes(axes: Any) -> Any:
    if axes is not None:
        return axes
    from matplotlib import pyplot

    return pyplot.subplots()[1]
