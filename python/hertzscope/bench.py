"""A bench of `hertzscope serve` for tests of lab programs.

`Bench` starts one on free ports; with pytest, the fixtures `bench` and `start_bench` do. See docs/lab-code.md.
"""

from __future__ import annotations

import array
import contextlib
import json
import os
import shutil
import socket
import struct
import subprocess
import sysconfig
import threading
import time
from collections.abc import Iterable, Sequence
from typing import Any

__all__ = ["Bench", "program"]

#: Longest wait for a bench: its start, a reply, an impact, its end (s).
TIMEOUT = 60.0
#: First and longest time between two queries for an impact (s).
POLL_INTERVALS = (0.0005, 0.02)
#: Channels of the scope.
CHANNELS = (1, 2, 3, 4)


def program() -> str:
    """The path of the program: `HERTZSCOPE` if that is set, the one that was installed with this package, or the one on the path."""
    name = "hertzscope.exe" if os.name == "nt" else "hertzscope"
    installed = os.path.join(sysconfig.get_path("scripts"), name)
    found = os.environ.get("HERTZSCOPE") or (installed if os.path.exists(installed) else shutil.which(name))
    if not found:
        raise FileNotFoundError("the program hertzscope is missing: install it, or set HERTZSCOPE to its path")
    return found


class _Connection:
    """A connection to the scope: commands and replies are lines."""

    def __init__(self, address: tuple[str, int]) -> None:
        self._socket = socket.create_connection(address, TIMEOUT)
        self.replies = self._socket.makefile("rb")

    def write(self, command: str) -> None:
        self._socket.sendall(command.encode() + b"\n")

    def query(self, command: str) -> str:
        self.write(command)
        return self.line().decode().rstrip("\n")

    def line(self) -> bytes:
        line = self.replies.readline()
        if not line:
            raise ConnectionError("the bench has closed its connection")
        return line

    def close(self) -> None:
        self.replies.close()
        self._socket.close()


class Bench:
    """A served bench: `scene` as for `hertzscope serve`, `faults` from the start, `seed` of everything random.

    `resources` has its VISA resource strings by protocol ("socket", "hislip", "vxi11"), `address` the host and port of the raw socket.
    The server ends with this object's `stop`, and also if this process ends in any other way: it reads a pipe of this process.
    """

    def __init__(self, scene: str | os.PathLike[str] = "magnet-0.61g", faults: Iterable[str] = (), seed: int | None = None) -> None:
        command = [program(), "serve", str(scene), "--json", "--listen", "127.0.0.1:0", "--hislip", "0", "--vxi11", "0", "--until-eof"]
        for fault in faults:
            command += ["--fault", fault]
        if seed is not None:
            command += ["--seed", str(seed)]
        self._is_stopped = False
        with contextlib.ExitStack() as started:
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            assert self._process.stdin and self._process.stdout, "both are pipes"
            self._input, self._output = self._process.stdin, self._process.stdout
            started.callback(self._end)
            announced = json.loads(self._announcement(scene))
            self.resources = announced["resources"]
            host, port = announced["listening"].rsplit(":", 1)
            self.address = (host, int(port))
            # Tests write on one connection; what they set there (HEADer, faults) does not reach the other.
            self._control = started.enter_context(contextlib.closing(_Connection(self.address)))
            self._for_tests = started.enter_context(contextlib.closing(_Connection(self.address)))
            self._resources_to_free = started.pop_all()

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _announcement(self, scene: object) -> str:
        """The line that the server prints when it listens."""
        limit = threading.Timer(TIMEOUT, self._process.kill)
        limit.start()
        try:
            line = self._output.readline()
        finally:
            limit.cancel()
        if not line:
            raise RuntimeError(f"hertzscope serve {scene} ended with exit code {self._process.wait()}; its reason is on standard error")
        return line

    def write(self, command: str) -> None:
        """Sends a command, on a connection for tests alone."""
        self._for_tests.write(command)

    def query(self, command: str) -> str:
        """The reply to a query on that connection, without its line end."""
        return self._for_tests.query(command)

    def strike(self, timeout: float = TIMEOUT) -> int:
        """Strikes the chain and waits until its signals are at the scope; returns the number of the impact.

        A scope that is to see it must have been told so before: ask it something after `ACQuire:STATE ON`. Raises `TimeoutError` with the
        scope's events if the signals are not there after `timeout` (s).
        """
        before = int(self._control.query("BENCh:IMPact?"))
        self._control.write("BENCh:IMPact")
        end = time.monotonic() + timeout
        interval, longest = POLL_INTERVALS
        while (impact := int(self._control.query("BENCh:IMPact?"))) == before:
            if time.monotonic() > end:
                raise TimeoutError(f"no signals of impact {before + 1} after {timeout:g} s; events of the scope: {self._events()}")
            time.sleep(interval)
            interval = min(2 * interval, longest)
        return impact

    def _events(self) -> str:
        """The scope's events, from a connection of their own: its replies may be disturbed by faults."""
        try:
            with contextlib.closing(_Connection(self.address)) as connection:
                connection._socket.settimeout(1)
                return f"*ESR? {connection.query('*ESR?')}, ALLEv? {connection.query('ALLEv?')}"
        except OSError as error:
            return f"unknown ({error})"

    def forces(self) -> dict[int, tuple[Any, Any]]:
        """The true forces at the sensors in the last impact: by channel, times in s after the trigger (or, where the scope has not
        triggered, the striker's first contact) and forces in N. Arrays of numpy, or of the standard library where there is no numpy.
        """
        found = {}
        for channel in CHANNELS:
            start, interval = map(float, self._control.query(f"BENCh:CH{channel}:FORCe:TIMe?").split(","))
            self._control.write(f"BENCh:CH{channel}:FORCe?")
            replies = self._control.replies
            digits = int(replies.read(2)[1:])
            data = replies.read(int(replies.read(digits)))
            self._control.line()
            if data:
                times = [start + index * interval for index in range(len(data) // 8)]
                found[channel] = (_array(times), _array(struct.unpack(f"<{len(data) // 8}d", data)))
        return found

    def fault(self, text: str) -> None:
        """Switches a fault on, e.g. "late=500ms" or "noisy@CH2=50mV*1"; `hertzscope serve --help` lists all."""
        quoted = text.replace('"', '""')
        if f"{quoted}" not in self._control.query(f'BENCh:FAUlt "{quoted}";FAUlt?'):
            raise ValueError(f"no such fault: {text} (hertzscope serve --help lists them)")

    def clear_faults(self) -> None:
        """Ends all faults."""
        self._control.write('BENCh:FAUlt "none"')
        self._control.query("BENCh:FAUlt?")

    def stop(self) -> None:
        """Stops the bench.

        Raises `RuntimeError` if it had stopped by itself. A second call does nothing.
        """
        ended = None if self._is_stopped else self._process.poll()
        self._is_stopped = True
        self._resources_to_free.close()
        if ended is not None:
            raise RuntimeError(f"hertzscope serve had ended by itself, with exit code {ended}")

    def _end(self) -> None:
        """Ends the server, whatever state it is in."""
        self._process.terminate()
        try:
            self._process.wait(TIMEOUT)
        finally:
            self._process.kill()
            self._process.wait()
            self._input.close()
            self._output.close()


def _array(values: Sequence[float]) -> Any:
    """Numbers as an array of numpy, if that is installed."""
    try:
        import numpy
    except ImportError:
        return array.array("d", values)
    return numpy.array(values)
