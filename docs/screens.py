#!/usr/bin/env python3
"""Makes the pictures of the README and of docs/screen.md: docs/magnet-0.61g.svg, the scope's screen, and docs/view-*.svg, from real sessions of `hertzscope view`.

    cargo build --release && docs/screens.py [target/release/hertzscope [NAME...]]

Each session runs on a pseudo-terminal, is typed at, and saves its own screen with `:write`.
"""

import fcntl
import os
import pathlib
import pty
import re
import select
import struct
import subprocess
import sys
import tempfile
import termios
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PATIENCE = 600.0  # seconds; the study of accuracy takes longest

# Name, arguments, rows, columns; then keys, each with what is to appear before the next ones are typed.
SESSIONS = [
    ("view-scope", ["magnet-0.61g"], 32, 110, [("", "Trig'd"), ("T", "over each trace"), ("B", "striker mass")]),
    ("view-spectrum", ["magnet-0.61g"], 24, 80, [("", "Trig'd"), ("2F", "f3")]),
    ("view-motion", ["magnet-0.61g"], 32, 110, [("", "Trig'd"), (":seek 0.42 ms\r", "Forces along")]),
    ("view-compare", ["LAB", "--against", "gravity-0.61g"], 32, 110, [("", "corr"), ("2", "CH2")]),
    ("view-accuracy", ["magnet-0.61g"], 40, 150, [("", "Trig'd"), ("k", "now: accuracy")]),
    ("view-effects", ["magnet-0.61g"], 32, 80, [("", "Trig'd"), ("y", "quantisation")]),
]


class Session:
    def __init__(self, program, arguments, rows, columns):
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        environment = dict(os.environ, TERM="xterm")
        environment.pop("NO_COLOR", None)
        self.child = subprocess.Popen(
            [program, "view", *arguments], stdin=slave, stdout=slave, stderr=slave, env=environment, start_new_session=True
        )
        os.close(slave)
        self.heard = ""

    def wait_for(self, text):
        end = time.monotonic() + PATIENCE
        while not re.search(text, self.heard):
            ready, _, _ = select.select([self.master], [], [], max(0.0, end - time.monotonic()))
            if not ready:
                sys.exit(f"{text!r} did not come")
            part = os.read(self.master, 65536).decode("utf-8", "replace")
            # Without what moves the cursor and sets colours.
            self.heard += re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", part)

    def type(self, keys):
        self.heard = ""
        os.write(self.master, keys.encode())


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/hertzscope")
    wanted_ones = sys.argv[2:]
    with tempfile.TemporaryDirectory() as folder:
        lab = os.path.join(folder, "lab.mcap")
        subprocess.run([program, "run", "magnet-0.61g", "-q", "-o", lab], check=True)
        for drawn in (os.path.join(folder, "lab"), str(DOCS / "magnet-0.61g.svg")):
            subprocess.run([program, "convert", lab, drawn, "-q", "--force"], check=True)
        for name, arguments, rows, columns, steps in SESSIONS:
            if wanted_ones and name not in wanted_ones:
                continue
            arguments = [lab.removesuffix(".mcap") if argument == "LAB" else argument for argument in arguments]
            session = Session(program, arguments, rows, columns)
            for keys, wanted in steps:
                if keys:
                    session.type(keys)
                session.wait_for(wanted)
            picture = DOCS / f"{name}.svg"
            picture.unlink(missing_ok=True)
            session.type(f":write {picture}\r")
            session.wait_for("wrote")
            session.type("q")
            session.child.wait()
            print(picture)


if __name__ == "__main__":
    main()
