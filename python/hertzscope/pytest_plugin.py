"""Fixtures for pytest, which finds them by itself once the package is installed."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

import pytest

from .bench import Bench


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers", "bench(scene, faults=(), seed=None): how the fixture `bench` is set up"
    )


@pytest.fixture
def start_bench() -> Iterator[Callable[..., Bench]]:
    """A function that starts benches, with the arguments of `hertzscope.Bench`; all are stopped after the test."""
    with contextlib.ExitStack() as benches:
        # All are stopped, also if one of them fails to.
        yield lambda *arguments, **keywords: benches.enter_context(Bench(*arguments, **keywords))


@pytest.fixture
def bench(request: pytest.FixtureRequest, start_bench: Callable[..., Bench]) -> Bench:
    """A fresh bench; `@pytest.mark.bench("gravity-0.61g", faults=["dead@CH2"])` sets it up otherwise."""
    marker = request.node.get_closest_marker("bench")
    return start_bench(*marker.args, **marker.kwargs) if marker else start_bench()
