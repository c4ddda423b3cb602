"""Ten tests at a time, each with a bench that nobody else has touched."""

import pytest


@pytest.mark.parametrize("number", range(1, 11))
def test_a_bench_is_fresh(bench, number):
    assert bench.query("BENCh:IMPact?;FAUlt?;:CH1:SCALE?;:ALLEV?") == '0;"";1.0E0;1,"No events to report - new events pending *ESR?"'
    bench.write(f"CH1:SCALE {[2, 5, 0.5][number % 3]}")
    bench.fault(f"late={number}us")
    for impact in range(1, number + 1):
        assert bench.strike() == impact
    assert bench.query("BENCh:IMPact?;FAUlt?") == f'{number};"late={number}us"'


def test_the_same_seed_brings_the_same_record(start_bench):
    curves = []
    for seed in (1, 1, 2):
        bench = start_bench(seed=seed)
        bench.write("ACQUIRE:STOPAFTER SEQUENCE;STATE ON")
        bench.strike()
        curves.append(bench.query("*OPC?;:DATA:ENC ASCII;:CURVE?"))
    assert curves[0] == curves[1] != curves[2]


def test_a_bench_that_cannot_start_says_so(start_bench, capfd):
    with pytest.raises(RuntimeError, match="exit code 2"):
        start_bench("no-such-scene")
    assert "no-such-scene" in capfd.readouterr().err
    with pytest.raises(RuntimeError, match="exit code 2"):
        start_bench(faults=["nonsense"])


def test_an_unknown_fault_is_refused(bench):
    with pytest.raises(ValueError, match="nonsense"):
        bench.fault("nonsense")
