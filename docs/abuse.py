#!/usr/bin/env python3
"""Measures what `hertzscope serve` does among clients that mean no good, and writes its part of docs/abuse.md.

    docs/abuse.py HERTZSCOPE [SECONDS]

HERTZSCOPE is the program, SECONDS how long the abuse goes on (default 30). Linux only: memory and descriptors are read from /proc.
"""

import json
import multiprocessing
import os
import random
import re
import resource
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path

ADDRESS_SPACE = 4_000_000 * 1024
PAGE = Path(__file__).with_name("abuse.md")
# The part of the page between these lines is replaced.
BEGIN, END = "<!-- measured by abuse.py -->\n", "<!-- end of what is measured -->\n"


def dial(port):
    stream = socket.create_connection(("127.0.0.1", port), timeout=5)
    stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return stream


def hislip(code, control, parameter, payload=b""):
    return b"HS" + struct.pack(">BBIQ", code, control, parameter, len(payload)) + payload


def call(stream, program, procedure, *arguments):
    """An ONC RPC call: the words of its reply behind the header."""
    message = struct.pack(">10I", 7, 0, 2, program, 2 if program == MAPPER else 1, procedure, 0, 0, 0, 0)
    message += b"".join(word if isinstance(word, bytes) else struct.pack(">I", word) for word in arguments)
    stream.sendall(struct.pack(">I", 0x8000_0000 | len(message)) + message)
    reply = stream.recv(4096)
    return struct.unpack(f">{(len(reply) - 28) // 4}I", reply[28:])


CORE, MAPPER = 0x607AF, 100_000
INSTRUMENT = struct.pack(">I", 5) + b"inst0\0\0\0"


def flood_set(raw, *_):
    stream = dial(raw)
    while True:
        stream.sendall(b"SET?\n" * 50)
        stream.recv(1 << 16)


def unread_curves(raw, *_):
    stream = dial(raw)
    while True:
        stream.sendall(b"CURVE?\n" * 50)


def endless_line(raw, *_):
    stream = dial(raw)
    while True:
        stream.sendall(b"x" * 4096)
        time.sleep(0.001)


def come_and_go(raw, *_):
    while True:
        with dial(raw) as stream:
            stream.sendall(b"*IDN?\nCURVE #42500abc")
        time.sleep(0.001)


def web_page(raw, *_):
    while True:
        with dial(raw) as stream:
            stream.sendall(b"POST / HTTP/1.1\r\n\r\n*RST\n")
            stream.recv(100)
        time.sleep(0.001)


def silence(raw, *_):
    streams = [dial(raw) for _ in range(4)]
    time.sleep(1e6)
    return streams


def turn_time_bases(raw, *_):
    stream = dial(raw)
    while True:
        scale = random.choice(["5E-9", "5E-8", "2.5E-4", "1", "50"])
        stream.sendall(f"TRIG:MAI:MOD AUTO;:ACQ:STATE RUN;:BENC:IMP;:HOR:SCA {scale}\n".encode())
        time.sleep(0.005)


def random_bytes(raw, *_):
    while True:
        with dial(raw) as stream:
            for _ in range(50):
                stream.sendall(bytes(random.randrange(256) for _ in range(100)) + b"\n")
                time.sleep(0.001)


def half_hislip(_, port, *__):
    while True:
        with dial(port) as stream:
            stream.sendall(hislip(0, 0, 0x0100_0000, b"hislip0"))
            stream.recv(16)
            time.sleep(0.05)


def hislip_garbage(_, port, *__):
    while True:
        with dial(port) as stream:
            for _ in range(50):
                code = random.randrange(30)
                stream.sendall(hislip(code, random.randrange(3), 0, b"SET?;CURVE?"))
                time.sleep(0.001)


def links(_, __, port, ___):
    """As many links as a connection may have, and silence."""
    while True:
        streams = [dial(port) for _ in range(4)]
        for stream in streams:
            for _ in range(16):
                call(stream, CORE, 10, 1, 0, 0, INSTRUMENT)
        time.sleep(3)


def silent_port_mapper(*ports):
    while True:
        streams = [dial(ports[3]) for _ in range(10)]
        time.sleep(3)
        del streams


def newcomer(port, asks):
    """Whether a new client is served, in at most ten tries a tenth of a second apart; a client whose address has all its connections waits for an idle one."""
    for _ in range(10):
        try:
            with dial(port) as stream:
                if asks(stream):
                    return True
        except (OSError, struct.error):
            pass
        time.sleep(0.1)
    return False


def identity(stream):
    stream.sendall(b"*IDN?\n")
    return stream.recv(200).endswith(b"\n")


def session(stream):
    stream.sendall(hislip(0, 0, 0x0100_0000, b"hislip0"))
    return stream.recv(16)[2:3] == bytes([1])


def newcomers(ports, count):
    """How many newcomers over each protocol are served."""
    asks = [identity, session, lambda s: call(s, CORE, 10, 1, 0, 0, INSTRUMENT)[0] == 0, lambda s: call(s, MAPPER, 3, CORE, 1, 6, 0)[0] == ports[2]]
    served = [sum(newcomer(port, ask) for _ in range(count)) for port, ask in zip(ports, asks)]
    return ", ".join(f"{name} {number} of {count}" for name, number in zip(["raw", "HiSLIP", "VXI-11", "port mapper"], served))


KINDS = [flood_set, unread_curves, endless_line, come_and_go, web_page, silence, turn_time_bases, random_bytes, half_hislip, hislip_garbage, links, silent_port_mapper]


def abuser(kind, ports):
    while True:
        try:
            kind(*ports)
        except OSError:
            time.sleep(0.01)


def latencies(port, seconds, before=None):
    times = []
    stream = dial(port)
    stream.settimeout(20)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if before:
            stream.sendall(before)
        began = time.perf_counter()
        stream.sendall(b"*IDN?\n")
        if not stream.recv(200).endswith(b"\n"):
            sys.exit(f"abuse.py: no answer to *IDN? after {len(times)} answers, before={before}")
        times.append(time.perf_counter() - began)
        time.sleep(0.005)
    times.sort()
    return times


SLOW = ["HOR:SCA 1", "HOR:SCA 50", "HOR:SCA 2.5E-3"]
TURNED = ["HOR:SCA 5E-9", "RECA:SETU FACTORY", "*RST", "HOR:SCA 5E-9;POS 1E-6"]
TURNS = 1000


def turns(port):
    """Sets the time base, strikes, and turns it, recalls the factory's set-up or resets during the impact, a thousand times."""
    times = []
    stream = dial(port)
    stream.settimeout(20)
    for turn in range(TURNS):
        stream.sendall(f"{SLOW[turn % len(SLOW)]}\n".encode())
        time.sleep(0.005)
        stream.sendall(f"BENC:IMP\n{TURNED[turn % len(TURNED)]}\n".encode())
        began = time.perf_counter()
        stream.sendall(b"*IDN?\n")
        if not stream.recv(200).endswith(b"\n"):
            sys.exit(f"abuse.py: no answer to *IDN? at turn {turn}")
        times.append(time.perf_counter() - began)
    times.sort()
    return times


def spread(times):
    at = lambda share: 1e3 * times[min(len(times) - 1, int(share * len(times)))]
    return f"{at(0.5):.2f} ms | {at(0.99):.2f} ms | {at(1.0):.2f} ms | {len(times)}"


def resources(process):
    status = Path(f"/proc/{process.pid}/status").read_text()
    memory = int(re.search(r"VmRSS:\s+(\d+)", status).group(1)) / 1024
    return f"{memory:.0f} MB | {len(os.listdir(f'/proc/{process.pid}/fd'))}"


def main():
    load = os.getloadavg()[0]
    program, seconds = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 30.0
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))
    arguments = ["--listen", "127.0.0.1:0", "--hislip", "0", "--vxi11", "0", "--port-mapper", "0", "--json"]
    server = subprocess.Popen([program, "serve", *arguments], stdout=subprocess.PIPE, text=True, preexec_fn=limit)
    told = json.loads(server.stdout.readline())
    ports = [int(told[name].rsplit(":", 1)[1]) for name in ("listening", "hislip", "vxi11", "port_mapper")]
    raw = ports[0]
    rows, states = [], []
    states.append(f"| at the start | {resources(server)} |")
    rows.append(f"| alone | {spread(latencies(raw, 5))} |")
    rows.append(f"| an impact under way, at 50 ns/div | {spread(latencies(raw, 5, b'HOR:SCA 5E-8;:BENC:IMP' + bytes([10])))} |")
    idle = [dial(raw) for _ in range(300)]
    time.sleep(1.5)
    after_silence = newcomers(ports, 20)
    states.append(f"| 300 silent connections were opened | {resources(server)} |")
    for stream in idle:
        stream.close()
    workers = [multiprocessing.Process(target=abuser, args=(KINDS[n % len(KINDS)], ports), daemon=True) for n in range(20)]
    for worker in workers:
        worker.start()
    rows.append(f"| twenty abusers beside it | {spread(latencies(raw, seconds))} |")
    among_abusers = newcomers(ports, 20)
    rows.append(f"| twenty abusers beside {TURNS} turns, recalls and resets during impacts | {spread(turns(raw))} |")
    states.append(f"| twenty abusers for {seconds:.0f} s | {resources(server)} |")
    for worker in workers:
        worker.terminate()
    time.sleep(12)
    rows.append(f"| after them | {spread(latencies(raw, 5))} |")
    states.append(f"| 12 s after them | {resources(server)} |")
    server.terminate()
    code = server.wait(20)
    kinds = ", ".join(kind.__name__.replace("_", " ") for kind in KINDS)
    page = PAGE.read_text()
    before, after = page.split(BEGIN)[0], page.split(END)[1]
    PAGE.write_text(f"""{before}{BEGIN}
Measured by `docs/abuse.py HERTZSCOPE {seconds:.0f}`, which starts `hertzscope serve` and twenty processes that abuse it, of these kinds: {kinds}. The machine had
{os.cpu_count()} processors, shared by all of them and by other work: the load average was {load:.1f} before. `tests/it/server/random_sessions.rs`, `abuse.rs` and `connections.rs` test the same.

Time from `*IDN?` to its answer, of a server with 4 GB of address space:

| | median | 99 of 100 | longest | answers |
|---|---|---|---|---|
{chr(10).join(rows)}

Memory and descriptors of the server:

| | memory | descriptors |
|---|---|---|
{chr(10).join(states)}

Newcomers of the same address that were served within a second: after 300 silent connections {after_silence}; among the twenty abusers {among_abusers}. The server ended with exit code {code}.

{END}{after}""")


if __name__ == "__main__":
    main()
