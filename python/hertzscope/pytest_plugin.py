"""Fixtures for pytest, which finds them by itself once the package is installed."""

import contextlib

import pytest

from .bench import Bench


def pytest_configure(config):
    config.addinivalue_line(
        "markers", "bench(scene, faults=(), seed=None): how the fixture `bench` is set up"
    )


@pytest.fixture
def start_bench():
    """A function that starts benches, with the arguments of `hertzscope.Bench`; all are stopped after the test."""
    with contextlib.ExitStack() as benches:
        # All are stopped, also if one of them fails to.
        yield lambda *arguments, **keywords: benches.enter_context(Bench(*arguments, **keywords))


@pytest.fixture
def bench(request, start_bench):
    """A fresh bench; `@pytest.mark.bench("gravity-0.61g", faults=["dead@CH2"])` sets it up otherwise."""
    marker = request.node.get_closest_marker("bench")
    return start_bench(*marker.args, **marker.kwargs) if marker else start_bench()
