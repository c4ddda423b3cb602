"""Lets other people's clients, unmodified, work with the served scope, and holds what they read against the recording.

Usage: check.py HERTZSCOPE RECORDING.mcap

HERTZSCOPE is the program, RECORDING.mcap is written by `serve --record`. Each client sets the scope up, takes a single shot of an
impact and reads all channels; the recording's captures of that shot are the golden. Exit code 0: all agree; 1: something differs.
"""

import json
import re
import shutil
import signal
import socket
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import pyvisa
import vxi11 as python_vxi11
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from pylablib.core.devio.comm_backend import NetworkDeviceBackend
from pylablib.devices import Tektronix
from pymeasure.instruments import tektronix
from pyvisa_py.protocols import hislip as protocol

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "recipes"))
import scope_client  # noqa: E402

CHANNELS = (1, 2, 3, 4)
IDENTITY = "TEKTRONIX,TDS 2014,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04"
# Encoding, numpy's name for a point of one byte and of two, level of the lowest code that is subtracted.
ENCODINGS = {
    "RIB": ("i1", ">i2", 0),
    "RPB": ("u1", ">u2", 128),
    "SRI": ("i1", "<i2", 0),
    "SRP": ("u1", "<u2", 128),
}

checks = 0


def check(what, found, expected):
    global checks
    checks += 1
    same = np.array_equal(found, expected)
    if not same:
        sys.exit(f"check.py: {what}: found {found}, expected {expected}")


def lab_script(scope):
    """An ordinary script on plain pyvisa: set-up, trigger, single shot, measurement, waveforms in every encoding."""
    check("*IDN?", scope.query("*IDN?").strip(), IDENTITY)
    scope.write("*CLS")
    scope.write("CH1:SCALE 2;POSITION -1;COUPLING DC")
    check("set-up", scope.query("CH1:SCALE?;POSITION?").strip(), "2.0E0;-1.0E0")
    scope.write("TRIGGER:MAIN:EDGE:SOURCE CH1;SLOPE RISE")
    scope.write("TRIGGER:MAIN:MODE NORMAL;LEVEL 0.5")
    check("trigger", scope.query(":TRIG:MAI:LEV?").strip(), "5.0E-1")
    scope.write("ACQUIRE:STOPAFTER SEQUENCE")
    scope.write("ACQUIRE:STATE ON")
    scope.write("BENCH:IMPACT")
    check("single shot", scope.query("*OPC?").strip(), "1")
    check("state", scope.query("ACQUIRE:STATE?").strip(), "0")
    levels = {}
    for channel in CHANNELS:
        scope.write(f"DATA:SOURCE CH{channel}; WIDTH 1; ENC ASC")
        levels[channel] = np.array(scope.query_ascii_values("CURVE?", converter="d"))
        for encoding, (narrow, wide, zero) in ENCODINGS.items():
            for width, name in ((1, narrow), (2, wide)):
                scope.write(f"DATA:WIDTH {width};ENC {encoding}")
                codes = read_block(scope, name).astype(int)
                if width == 2:
                    check("low byte", codes % 256, np.zeros_like(codes))
                    codes //= 256
                check(f"{encoding} {width} of CH{channel}", codes - zero, levels[channel])
    scope.write("DATA:SOURCE CH1; WIDTH 1; ENC RIB")
    volts = (levels[1] - float(scope.query("WFMPRE:YOFF?"))) * float(scope.query("WFMPRE:YMULT?"))
    scope.write("MEASUREMENT:IMMED:SOURCE CH1;TYPE PK2PK")
    measured = float(scope.query("MEASUREMENT:IMMED:VALUE?"))
    # Measurements carry the noise of 32-bit numbers.
    check("Pk-Pk", np.float32(measured), np.float32(volts.max() - volts.min()))
    check("events", scope.query("*ESR?").strip(), "0")
    return levels


def read_block(scope, name):
    """CURVE? as a block; the terminator behind it must be exactly one byte, or the next reply would be wrong."""
    datatype = {"i1": "b", "u1": "B", "i2": "h", "u2": "H"}[name.lstrip("<>")]
    big = not name.startswith("<")
    return scope.query_binary_values("CURVE?", datatype, is_big_endian=big, container=np.array)


def raw_pyvisa(raw, hislip, vxi11):
    manager = pyvisa.ResourceManager("@py")
    with manager.open_resource(
        f"TCPIP::127.0.0.1::{raw}::SOCKET", read_termination="\n", write_termination="\n"
    ) as scope:
        scope.timeout = 20000
        yield lab_script(scope)


def documented_pyvisa(raw, hislip, vxi11):
    """docs/recipes/scope_client.py, as it stands there."""
    address = f"TCPIP::127.0.0.1::{raw}::SOCKET"
    time, records = scope_client.single_shot(address)
    check("times", np.allclose(np.diff(time), 1e-6, rtol=1e-6), True)
    manager = pyvisa.ResourceManager("@py")
    levels = {}
    with manager.open_resource(address, read_termination="\n", write_termination="\n") as scope:
        for channel, volts in records.items():
            scope.write(f"DATA:SOURCE CH{channel}")
            step, zero = (float(scope.query(f"WFMPRE:{name}?")) for name in ("YMULT", "YOFF"))
            levels[channel] = np.rint(volts / step + zero).astype(int)
    yield levels


def hislip_pyvisa(raw, hislip, vxi11):
    manager = pyvisa.ResourceManager("@py")
    with manager.open_resource(f"TCPIP::127.0.0.1::hislip0,{hislip}::INSTR") as scope:
        scope.timeout = 20000
        yield lab_script(scope)
        # The status byte tells of a reply until it is read. It travels beside the query, and may arrive first.
        scope.write("*IDN?")
        check("MAV", any(scope.read_stb() & 16 for _ in range(10000)), True)
        check("*IDN?", scope.read().strip(), IDENTITY)
        check("MAV after reading", scope.read_stb() & 16, 0)
        # A device clear ends the wait for an impact that never comes.
        scope.write("ACQUIRE:STATE ON;*OPC?")
        scope.clear()
        check("*IDN? after clear", scope.query("*IDN?").strip(), IDENTITY)
        check("the scope still waits", scope.query("BUSY?").strip(), "1")
        scope.write("ACQUIRE:STATE OFF")
        # A query that does not exist has no reply; it must not be waited for.
        scope.write("CH5:POSITION?")
        check("113", scope.query("*ESR?;EVENT?").strip(), "32;113")
    locks(hislip)


def locks(hislip):
    """Locks, by the protocol's own class: pyvisa-py's sessions do not pass them on."""
    one, two = (protocol.Instrument("127.0.0.1", port=hislip, timeout=20.0) for _ in range(2))
    check("exclusive lock", one.async_lock_request(0.0), "success")
    check("somebody else's", two.async_lock_request(0.0), "failure")
    check("lock info", two.async_lock_info(), 1)
    two.send(b"*IDN?")
    two.timeout = 0.2
    try:
        two.receive()
        sys.exit("check.py: an exclusive lock did not hold another session back")
    except TimeoutError:
        two.timeout = 20.0
    one.send(b"*IDN?")
    check("the lock's holder", bytes(one.receive()).strip().decode(), IDENTITY)
    check("release", one.async_lock_release(), "success")
    check("after the lock", bytes(two.receive()).strip().decode(), IDENTITY)
    check("shared lock", one.async_lock_request(0.0, "lab"), "success")
    check("shared with", two.async_lock_request(0.0, "lab"), "success")
    check("shared release", two.async_lock_release(), "success shared")
    two.async_remote_local_control("enableAndLockoutLocal")
    one.close()
    two.send(b"LOCK?")
    check("keys", bytes(two.receive()).strip().decode(), "ALL")
    two.close()


def vxi11_pyvisa(raw, hislip, vxi11):
    manager = pyvisa.ResourceManager("@py")
    address = f"TCPIP::127.0.0.1,{vxi11}::inst0::INSTR"
    with manager.open_resource(address) as scope, manager.open_resource(address) as other:
        scope.timeout = other.timeout = 20000
        yield lab_script(scope)
        scope.write("*IDN?")
        check("MAV", scope.read_stb() & 16, 16)
        check("*IDN?", scope.read().strip(), IDENTITY)
        check("MAV after reading", scope.read_stb() & 16, 0)
        # A device clear ends the wait for an impact that never comes.
        scope.write("ACQUIRE:STATE ON;*OPC?")
        scope.clear()
        check("*IDN? after clear", scope.query("*IDN?").strip(), IDENTITY)
        check("the scope still waits", scope.query("BUSY?").strip(), "1")
        scope.write("ACQUIRE:STATE OFF")
        # A query that does not exist has no reply, which is known when its time is over.
        scope.timeout = 100
        for query in ("CH5:POSITION?", "*OPC"):
            try:
                sys.exit(f"check.py: {query} answers {scope.query(query)!r}")
            except pyvisa.errors.VisaIOError as error:
                check("time-out", error.error_code, pyvisa.constants.StatusCode.error_timeout)
        scope.timeout = 20000
        check("113", scope.query("*ESR?;EVENT?").strip(), "33;113")
        scope.lock_excl(timeout=1000)
        try:
            other.write("*IDN?")
            sys.exit("check.py: an exclusive lock did not hold another link back")
        except pyvisa.errors.VisaIOError:
            pass
        scope.unlock()
        check("after the lock", other.query("*IDN?").strip(), IDENTITY)


def vxi11_python(raw, hislip, vxi11):
    """python-vxi11, told the port: it asks a port mapper otherwise."""
    scope = python_vxi11.Instrument("127.0.0.1")
    scope.client = python_vxi11.vxi11.CoreClient("127.0.0.1", vxi11)
    scope.timeout = 20
    check("*IDN?", scope.ask("*IDN?"), IDENTITY)
    scope.write("ACQUIRE:STOPAFTER SEQUENCE;STATE ON;:BENCH:IMPACT")
    check("single shot", scope.ask("*OPC?"), "1")
    levels = {}
    for channel in CHANNELS:
        curve = scope.ask_raw(f"DATA INIT;:DATA:SOURCE CH{channel};:CURVE?".encode())
        check("block", (curve[:6], curve[-1:]), (b"#42500", b"\n"))
        levels[channel] = np.frombuffer(curve[6:-1], "i1").astype(int)
    scope.remote()
    check("keys", scope.ask("LOCK?"), "ALL")
    scope.local()
    check("keys", scope.ask("LOCK?"), "NONE")
    scope.close()
    yield levels


def pylablib_client(raw, hislip, vxi11):
    address = ("127.0.0.1", raw)
    # Its network link expects lines that end with CRLF: either the scope is told to send them ...
    with Tektronix.TDS2000(address, nchannels=4) as scope:
        scope.write("RS232:TRANSMIT:TERMINATOR CRLF")
        check("CRLF", scope.get_id(), IDENTITY)
    # ... or the link to take LF, which binary curves need.
    error = Tektronix.base.TektronixBackendError
    backend = NetworkDeviceBackend(address, term_read="\n", reraise_error=error)
    # Its count of channels gives a reply one millisecond, which a busy machine may miss: tests/it/scpi/clients.rs has it.
    with Tektronix.TDS2000(backend, nchannels=4) as scope:
        scope.set_vertical_span(1, 20.0)
        check("vertical span", scope.get_vertical_span(1), 20.0)
        scope.set_vertical_position(1, -2.0)
        scope.setup_edge_trigger("ch1", 0.5, slope="rise")
        scope.set_trigger_mode("norm")
        check("trigger", scope.get_trigger_level(), 0.5)
        scope.grab_single(wait=False)
        scope.write("BENCH:IMPACT")
        scope.wait_for_grabbing(timeout=20)
        check("state", scope.is_grabbing(), False)
        levels = {}
        for channel in CHANNELS:
            levels[channel] = scope.read_raw_data(channel, fmt="ascii")
            check("binary", scope.read_raw_data(channel, fmt="i1"), levels[channel])
            sweep, preamble = scope.read_sweep(channel), scope.get_wfmpre(channel)
            volts = (levels[channel] - preamble["yoff"]) * preamble["ymult"]
            check("sweep", sweep[:, 1], volts)
        yield levels
        scope.grab_single(software_trigger=True, wait_timeout=20)
        check("forced", len(scope.read_sweep(1)), 2500)
        yield {channel: scope.read_raw_data(channel, fmt="i1") for channel in CHANNELS}


def pymeasure_client(raw, hislip, vxi11):
    links = f"::{raw}::SOCKET", f"::hislip0,{hislip}::INSTR", f",{vxi11}::inst0::INSTR"
    for link in (f"TCPIP::127.0.0.1{link}" for link in links):
        scope = tektronix.TDS2000(
            link, read_termination="\n", write_termination="\n", visa_library="@py", timeout=20000
        )
        check("pymeasure", scope.id, IDENTITY)
        scope.write("ACQ:STOPA SEQ")
        scope.write("ACQ:STATE ON")
        scope.write("BENC:IMP")
        check("single shot", scope.ask("*OPC?").strip(), "1")
        scope.write("DATA:SOU CH1;ENC ASCI")
        levels = np.array(scope.values("CURVE?")).astype(int)
        measure = scope.measurement
        measure.source = "CH1"
        for kind, level in (("MAXI", levels.max()), ("MINI", levels.min())):
            measure.type = kind
            check(f"{kind} is set", measure.type, {"MAXI": "MAXIMUM", "MINI": "MINIMUM"}[kind])
            scope.write("DATA:SOU CH1")
            zero, step = (scope.values(f"WFMPRE:{key}?")[0] for key in ("YOFF", "YMULT"))
            check(kind, np.float32(measure.value[0]), np.float32((level - zero) * step))
        check("unit", measure.unit.strip('"')[0], "V")
        yield {1: levels}
        scope.adapter.close()


def lines_of(page):
    """The blocks of a page of docs/ that this script executes."""
    text = (Path(__file__).resolve().parents[2] / "docs" / page).read_text()
    return re.findall(r"```python tests/clients/check.py\n(.*?)```", text, re.DOTALL)


def documented_lines(raw, hislip, vxi11):
    """The lines of docs/clients.md and docs/vxi11.md, as they stand there but for the ports; those that go by VISA over VXI-11, too."""
    blocks = lines_of("clients.md")
    check("clients on the page", len(blocks), 7)
    resource = re.compile(r"TCPIP::127.0.0.1::(5025::SOCKET|hislip0,4880::INSTR)")
    over_vxi11 = [resource.sub("TCPIP::127.0.0.1,1024::inst0::INSTR", block) for block in blocks if resource.search(block)]
    check("of which go by VISA", len(over_vxi11), 5)
    blocks += over_vxi11 + lines_of("vxi11.md")
    manager = pyvisa.ResourceManager("@py")
    address = f"TCPIP::127.0.0.1::{raw}::SOCKET"
    with manager.open_resource(address, read_termination="\n", write_termination="\n") as scope:
        scope.timeout = 20000
        scope.write("ACQUIRE:STOPAFTER SEQUENCE;STATE ON;:BENCH:IMPACT")
        check("single shot", scope.query("*OPC?").strip(), "1")
        scope.write("DATA:ENC ASC")
        levels = {}
        for channel in CHANNELS:
            scope.write(f"DATA:SOURCE CH{channel}")
            levels[channel] = np.array(scope.query_ascii_values("CURVE?", converter="d"))
        scope.write("DATA INIT")
        zero, step = (float(scope.query(f"WFMPRE:{key}?")) for key in ("YOFF", "YMULT"))
        for block in blocks:
            found = {}
            for port, own in (("5025", raw), ("4880", hislip), ("1024", vxi11)):
                block = block.replace(port, str(own))
            # What the lines count is looked at, too.
            exec(re.sub(r"points = len\((.*)\)", r"samples = \1\npoints = len(samples)", block), found)
            check(f"{block}\nidentity", found["identity"], IDENTITY)
            check(f"{block}\npoints", found["points"], 2500)
            samples = found["samples"]
            samples = np.frombuffer(samples, "i1") if isinstance(samples, bytes) else np.array(samples)
            samples = samples.reshape(2500, -1)[:, -1].astype(float)
            are_levels = np.array_equal(samples, np.rint(samples))
            check(f"{block}\nsamples", samples if are_levels else np.rint(samples / step + zero), levels[1])
            scope.write("DATA INIT;:HEADER OFF")
    if lxi := shutil.which("lxi"):
        asked = [lxi, "scpi", "--address", "127.0.0.1", "--port", str(raw), "--raw", "*IDN?"]
        check("lxi", subprocess.run(asked, capture_output=True, text=True).stdout.strip(), IDENTITY)
    yield levels


def lxi_tools(raw, hislip, vxi11):
    """`lxi scpi` as it comes, which asks the port mapper on port 111."""
    lxi = shutil.which("lxi")
    if not (lxi and HAS_PORT_111):
        reason = "its port 111 needs privileges and must be free" if lxi else "lxi-tools is not installed"
        return print(f"skipped: lxi over VXI-11: {reason}")

    def ask(text):
        asked = [lxi, "scpi", "--address", "127.0.0.1", "--timeout", "20", text]
        return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()

    check("lxi", ask("*IDN?"), IDENTITY)
    ask("ACQUIRE:STOPAFTER SEQUENCE;STATE ON;:BENCH:IMPACT")
    check("single shot", ask("*OPC?"), "1")
    ask("DATA:ENC ASC")
    yield {n: np.array(ask(f"DATA:SOURCE CH{n};:CURVE?").split(",")).astype(int) for n in CHANNELS}


def can_bind(port):
    try:
        with socket.socket() as one, socket.socket(type=socket.SOCK_DGRAM) as other:
            one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            one.bind(("127.0.0.1", port))
            other.bind(("127.0.0.1", port))
        return True
    except OSError:
        return False


HAS_PORT_111 = can_bind(111)


def goldens(recording):
    """The captures of every shot: levels by shot and channel. Also checks that commands and replies are there, in order."""
    shots = defaultdict(dict)
    lines = []
    with open(recording, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            if channel.topic.startswith("/scope/ch"):
                levels = np.frombuffer(decoded.codes, dtype="i1").astype(int)
                shots[decoded.shot][int(channel.topic.removeprefix("/scope/ch"))] = levels
            elif channel.topic == "/scpi":
                lines.append((message.log_time, decoded.direction, bytes(decoded.bytes)))
    check("lines are in order", [line[0] for line in lines], sorted(line[0] for line in lines))
    asked = sum(text.strip() == b"*IDN?" for _, direction, text in lines if direction == "command")
    said = sum(text.strip() == IDENTITY.encode() for _, direction, text in lines if direction == "reply")
    check("every *IDN? and its reply", (asked > 0, said), (True, asked))
    return shots


def main():
    program, recording = sys.argv[1:]
    server = subprocess.Popen(
        [program, "serve", "--json", "--listen", "127.0.0.1:0", "--hislip", "0", "--vxi11", "0"]
        + ["--port-mapper", "111" if HAS_PORT_111 else "0", "--record", recording],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        told = json.loads(server.stdout.readline())
        ports = [int(told[name].rsplit(":", 1)[1]) for name in ("listening", "hislip", "vxi11")]
        read = []
        clients = raw_pyvisa, documented_pyvisa, hislip_pyvisa, vxi11_pyvisa, vxi11_python, pylablib_client, pymeasure_client
        for client in (*clients, documented_lines, lxi_tools):
            before = checks
            shots = list(client(*ports))
            read.extend((client.__name__, shot) for shot in shots)
            print(f"{client.__name__}: {len(shots)} shots, {checks - before} checks")
    finally:
        server.send_signal(signal.SIGTERM)
        code = server.wait(timeout=20)
    check("the server's exit code", code, 0)
    shots = goldens(recording)
    check("shots", sorted(shots), list(range(1, len(read) + 1)))
    for number, (client, channels) in enumerate(read, start=1):
        for channel, levels in channels.items():
            check(f"CH{channel} of shot {number} ({client})", levels, shots[number][channel])
    print(f"{checks} checks passed; {len(read)} shots equal the recording's")


if __name__ == "__main__":
    main()
