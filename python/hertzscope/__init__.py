"""hertzscope in Python, in process: runs of scenes, recordings, comparison, fits and calibrations with NumPy arrays.

    import hertzscope
    recording = hertzscope.run("magnet-0.61g", {"striker.speed": "0.5 m/s"})
    shot = recording[0]
    print(shot.captures["CH2"].values.max(), recording.summary["sensors"][0]["first_peak"])

Units are SI units, in the attribute `unit` of what has one. Errors are `HertzscopeError` with the program's own sentences. See
docs/python.md. `Bench` and the fixtures `bench` and `start_bench` serve a bench for tests of lab programs: docs/lab-code.md.
"""

from typing import TYPE_CHECKING, Any

from .bench import Bench, program

if TYPE_CHECKING:
    from .lab import (
        Capture,
        HertzscopeError,
        Recording,
        Result,
        Shot,
        Trace,
        arrivals,
        bands,
        budget,
        calibrate,
        command,
        compare,
        cost,
        dispersion,
        effects,
        fit,
        force,
        info,
        open,
        recording,
        run,
        scenes,
        spectrogram,
        spectrum,
        sweep,
        transfer,
    )

__all__ = [
    "Bench",
    "Capture",
    "HertzscopeError",
    "Recording",
    "Result",
    "Shot",
    "Trace",
    "arrivals",
    "bands",
    "budget",
    "calibrate",
    "command",
    "compare",
    "cost",
    "dispersion",
    "effects",
    "fit",
    "force",
    "info",
    "open",
    "program",
    "recording",
    "run",
    "scenes",
    "spectrogram",
    "spectrum",
    "sweep",
    "transfer",
]


def __getattr__(name: str) -> Any:
    """What needs NumPy and the compiled module is imported when it is first asked for: fixtures start without."""
    if name not in __all__:
        raise AttributeError(f"module 'hertzscope' has no attribute '{name}'")
    from . import lab

    return getattr(lab, name)
