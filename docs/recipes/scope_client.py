"""One impact through the scope, as an ordinary pyvisa script: set up, arm, strike, read all channels in volts.

    pip install numpy pyvisa pyvisa-py
    python scope_client.py                                  # the scope of `hertzscope serve` on this machine
    python scope_client.py TCPIP::192.0.2.7::5025::SOCKET   # another machine's

With a real TDS 2014 leave `BENCH:IMPACT` out and let the striker go.
"""

import sys

import numpy as np
import pyvisa

CHANNELS = (1, 2, 3, 4)


def volts(scope, channel):
    """The channel's record: times after the trigger (s) and volts."""
    scope.write(f"DATA:SOURCE CH{channel};ENCDG RIBINARY;WIDTH 1")
    levels = scope.query_binary_values("CURVE?", "b", container=np.array)
    start, interval, zero, step = (
        float(scope.query(f"WFMPRE:{name}?")) for name in ("XZERO", "XINCR", "YOFF", "YMULT")
    )
    return start + interval * np.arange(len(levels)), step * (levels - zero)


def single_shot(address):
    """Arms the scope, strikes, and reads: volts by channel, and the times that all share (s)."""
    manager = pyvisa.ResourceManager("@py")
    with manager.open_resource(address, read_termination="\n", write_termination="\n") as scope:
        scope.timeout = 20000
        print(scope.query("*IDN?").strip())
        scope.write("TRIGGER:MAIN:MODE NORMAL;EDGE:SOURCE CH1;SLOPE RISE")
        scope.write("TRIGGER:MAIN:LEVEL 0.5")
        scope.write("ACQUIRE:STOPAFTER SEQUENCE;STATE ON")
        scope.write("BENCH:IMPACT")
        scope.query("*OPC?")
        records = {channel: volts(scope, channel) for channel in CHANNELS}
    return records[1][0], {channel: record[1] for channel, record in records.items()}


def main():
    time, records = single_shot(sys.argv[1] if len(sys.argv) > 1 else "TCPIP::localhost::5025::SOCKET")
    for channel, record in records.items():
        top = record.argmax()
        print(f"CH{channel}: {len(record)} samples, highest {record[top]:.2f} V at {1e6 * time[top]:.0f} us")


if __name__ == "__main__":
    main()
