"""A bench of `hertzscope serve` for tests of lab programs.

`Bench` starts one on free ports; with pytest, the fixtures `bench` and `start_bench` do. See docs/lab-code.md.
"""

import array
import json
import os
import shutil
import socket
import struct
import subprocess
import sysconfig

__all__ = ["Bench", "program"]

#: What a bench is waited for at most (s).
TIMEOUT = 60.0
#: Channels of the scope.
CHANNELS = (1, 2, 3, 4)


def program():
    """The path of the program: `HERTZSCOPE` if that is set, the one that was installed with this package, or the one on the path."""
    name = "hertzscope.exe" if os.name == "nt" else "hertzscope"
    installed = os.path.join(sysconfig.get_path("scripts"), name)
    found = os.environ.get("HERTZSCOPE") or (installed if os.path.exists(installed) else shutil.which(name))
    if not found:
        raise FileNotFoundError("the program hertzscope is missing: install it, or set HERTZSCOPE to its path")
    return found


class Bench:
    """A served bench: `scene` as for `hertzscope serve`, `faults` from the start, `seed` of everything random.

    `resources` has its VISA resource strings by protocol ("socket", "hislip", "vxi11"), `address` the host and port of the raw socket.
    """

    def __init__(self, scene="magnet-0.61g", faults=(), seed=None):
        command = [program(), "serve", str(scene), "--json", "--listen", "127.0.0.1:0", "--hislip", "0", "--vxi11", "0"]
        for fault in faults:
            command += ["--fault", fault]
        if seed is not None:
            command += ["--seed", str(seed)]
        self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"hertzscope serve {scene} ended with exit code {self._process.wait()}; its reason is on standard error")
        told = json.loads(line)
        self.resources = told["resources"]
        host, port = told["listening"].rsplit(":", 1)
        self.address = (host, int(port))
        self._control = socket.create_connection(self.address, TIMEOUT)
        self._replies = self._control.makefile("rb")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def write(self, command):
        """Sends a command on a connection of the bench's own."""
        self._control.sendall(command.encode() + b"\n")

    def query(self, command):
        """The reply to a query on that connection, without its line end."""
        self.write(command)
        return self._line().decode().rstrip("\n")

    def _line(self):
        line = self._replies.readline()
        if not line:
            raise ConnectionError("the bench has closed its connection")
        return line

    def strike(self):
        """Strikes the chain and waits until its signals are at the scope; returns the number of the impact.

        A scope that is to see it must have been told so before: ask it something after `ACQuire:STATE ON`.
        """
        before = int(self.query("BENCh:IMPact?"))
        self.write("BENCh:IMPact")
        while (impact := int(self.query("BENCh:IMPact?"))) == before:
            pass
        return impact

    def forces(self):
        """The true forces at the sensors in the last impact: by channel, times in s after the trigger (or, where the scope has not
        triggered, the striker's first contact) and forces in N. Arrays of numpy, or of the standard library where there is no numpy.
        """
        found = {}
        for channel in CHANNELS:
            start, interval = map(float, self.query(f"BENCh:CH{channel}:FORCe:TIMe?").split(","))
            self.write(f"BENCh:CH{channel}:FORCe?")
            digits = int(self._replies.read(2)[1:])
            data = self._replies.read(int(self._replies.read(digits)))
            self._line()
            if data:
                times = [start + index * interval for index in range(len(data) // 8)]
                found[channel] = (_array(times), _array(struct.unpack(f"<{len(data) // 8}d", data)))
        return found

    def fault(self, text):
        """Has something go wrong from now on, e.g. "late=500ms" or "noisy@CH2=50mV*1"; `hertzscope serve --help` lists all."""
        quoted = text.replace('"', '""')
        if f"{quoted}" not in self.query(f'BENCh:FAUlt "{quoted}";FAUlt?'):
            raise ValueError(f"no such fault: {text} (hertzscope serve --help lists them)")

    def clear_faults(self):
        """Ends all faults."""
        self.write('BENCh:FAUlt "none"')
        self.query("BENCh:FAUlt?")

    def stop(self):
        """Stops the bench.

        Raises `RuntimeError` if it had stopped by itself.
        """
        self._replies.close()
        self._control.close()
        ended = self._process.poll()
        self._process.terminate()
        try:
            self._process.wait(TIMEOUT)
        finally:
            self._process.kill()
            self._process.stdout.close()
        if ended is not None:
            raise RuntimeError(f"hertzscope serve had ended by itself, with exit code {ended}")


def _array(values):
    """Numbers as an array of numpy, if that is installed."""
    try:
        import numpy
    except ImportError:
        return array.array("d", values)
    return numpy.array(values)
