"""Each fault as pyvisa sees it, over all protocols: what docs/lab-code.md says."""

import pytest
from lab import arm, open_scope, read_volts
from pyvisa.errors import VisaIOError

IDENTITY = "TEKTRONIX,TDS 2014,0,CF:91.1CT FV:v4.12 TDS2CM:CMV:v1.04"
#: A time-out that ends a wait for what never comes (ms).
SHORT = 100


@pytest.fixture(params=["socket", "hislip", "vxi11"])
def protocol(request):
    return request.param


@pytest.fixture
def scope(bench, protocol):
    scope = open_scope(bench.resources[protocol])
    yield scope
    scope.close()


def struck(bench, scope):
    arm(scope)
    bench.strike()
    assert scope.query("*OPC?").strip() == "1"


def times_out(scope, query):
    scope.timeout = SHORT
    with pytest.raises(VisaIOError):
        scope.query(query)
    scope.timeout = 20000


def recover(bench, scope, protocol):
    """What a time-out asks for: a device clear, over a socket a new connection."""
    if protocol != "socket":
        scope.clear()
        return scope
    scope.close()
    return open_scope(bench.resources[protocol])


def test_late(bench, scope, protocol):
    bench.fault("late=50ms*1")
    assert scope.query("*IDN?").strip() == IDENTITY
    bench.fault("late=3600s*1")
    times_out(scope, "*IDN?")
    scope = recover(bench, scope, protocol)
    assert scope.query("BUSY?").strip() == "0"


@pytest.mark.bench(faults=["late=50ms"])
def test_late_replies_keep_their_order(bench):
    scope = open_scope(bench.resources["socket"])
    scope.write("*IDN?")
    scope.write("BUSY?")
    assert (scope.read(), scope.read()) == (IDENTITY, "0")


def test_cut(bench, scope, protocol):
    struck(bench, scope)
    sound = scope.query_binary_values("DATA INIT;:CURVE?", "b")
    bench.fault("cut=1000*1")
    scope.timeout = SHORT
    scope.write("CURVE?")
    if protocol == "socket":
        with pytest.raises(VisaIOError):
            scope.read_raw()
    else:
        reply = scope.read_raw()
        assert reply.startswith(b"#42500") and len(reply) == 1000
    scope = recover(bench, scope, protocol)
    scope.timeout = 20000
    assert scope.query_binary_values("CURVE?", "b") == sound


def test_garbled(bench, scope):
    struck(bench, scope)
    scope.write("DATA INIT;:DATA:ENC ASCII")
    sound = scope.query("CURVE?").strip()
    bench.fault("garbled=1%*1")
    scope.write("CURVE?")
    # Among the wrong bytes may be line ends.
    garbled = scope.read_bytes(len(sound) + 1)
    wrong = sum(a != b for a, b in zip(garbled[:-1], sound.encode()))
    assert 1 <= wrong < 0.03 * len(sound) and garbled.endswith(b"\n")
    assert scope.query("CURVE?").strip() == sound


def test_missing(bench, scope, protocol):
    bench.fault("missing*1")
    times_out(scope, "*IDN?")
    scope = recover(bench, scope, protocol)
    assert scope.query("*IDN?").strip() == IDENTITY


def test_dropped(bench, scope, protocol):
    struck(bench, scope)
    sound = scope.query_binary_values("DATA INIT;:CURVE?", "b")
    bench.fault("dropped=1000*1")
    scope.timeout = SHORT
    with pytest.raises((VisaIOError, OSError, RuntimeError)):
        scope.query_binary_values("CURVE?", "b")
    again = open_scope(bench.resources[protocol])
    assert again.query("*IDN?").strip() == IDENTITY
    assert again.query_binary_values("CURVE?", "b") == sound


@pytest.mark.bench(faults=["identity=ACME,1000,0,1.0"])
def test_identity(scope):
    assert scope.query("*IDN?").strip() == scope.query("ID?").strip() == "ACME,1000,0,1.0"


def test_no_trigger(bench, scope, protocol):
    bench.fault("no-trigger*1")
    arm(scope)
    bench.strike()
    times_out(scope, "*OPC?")
    scope = recover(bench, scope, protocol)
    assert scope.query("BUSY?;:TRIGGER:STATE?").strip() == "1;READY"
    bench.strike()
    assert scope.query("*OPC?").strip() == "1"


def volts(bench, scope, *faults):
    """Channel 1's record of one impact, whatever the number of the impact: the seed's noise is far below the faults."""
    bench.clear_faults()
    for fault in faults:
        bench.fault(fault)
    arm(scope)
    bench.strike()
    return read_volts(scope, 1)


def test_sensors(bench, scope):
    scope.write("CH1:SCALE 1")
    sound = volts(bench, scope)
    before = slice(0, 1000)
    peak, level = max(sound), 0.04
    assert peak > 1.5
    clipped = volts(bench, scope, "clipped@CH1=1V")
    plateau = [value for value in clipped if abs(value - max(clipped)) <= level]
    assert 0.9 < max(clipped) < 1.2 and len(plateau) > 8
    noisy = volts(bench, scope, "noisy@CH1=100mV")
    scatter = [sum(v * v for v in record[before]) / 1000 for record in (noisy, sound)]
    assert 0.08**2 < scatter[0] - scatter[1] < 0.12**2
    drifting = volts(bench, scope, "drifting@CH1=200V/s")
    change = [sum(record[900:1000]) / 100 - sum(record[:100]) / 100 for record in (drifting, sound)]
    # 0.9 ms at 200 V/s.
    assert 0.15 < change[0] - change[1] < 0.21
    second = volts(bench, scope, "second=500us")
    rises = [index for index in range(1, 2500) if second[index - 1] < peak / 2 <= second[index]]
    assert rises[-1] - rises[0] > 400


@pytest.mark.bench(faults=["dead@CH2*1"])
def test_dead(bench, scope):
    struck(bench, scope)
    assert max(map(abs, read_volts(scope, 2))) < 0.3 < max(read_volts(scope, 1))
    struck(bench, scope)
    assert max(read_volts(scope, 2)) > 0.3
