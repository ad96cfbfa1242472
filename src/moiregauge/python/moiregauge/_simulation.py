# SPDX-License-Identifier: Apache-2.0
"""Renders recordings with known truth."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Dict, Iterator, NamedTuple, Optional

from . import _core
from ._site import Path

if TYPE_CHECKING:
    import numpy
    import numpy.typing

    from ._run import OnProgress


class Truth(NamedTuple):
    """True displacement of a marker since frame 0 in every frame, mm."""

    time: "numpy.typing.NDArray[numpy.float64]"
    dx: "numpy.typing.NDArray[numpy.float64]"
    dy: "numpy.typing.NDArray[numpy.float64]"


class Simulation:
    """A recording that is rendered on request. Iteration gives its frames."""

    def __init__(self, simulation: _core.Simulation) -> None:
        self._simulation = simulation

    @property
    def site(self) -> _core.Site:
        """Site as a user would state it."""
        return self._simulation.site

    @property
    def fps(self) -> float:
        """Frames per second."""
        return self._simulation.fps

    def __len__(self) -> int:
        return self._simulation.frames

    def frame(self, number: int) -> "numpy.typing.NDArray[Any]":
        """Renders one frame as a new array. Ascending numbers are fastest. Raises IndexError."""
        return self._simulation.frame(number)

    def __iter__(self) -> "Iterator[numpy.typing.NDArray[Any]]":
        return (self.frame(number) for number in range(len(self)))

    def truth(self, marker: str) -> Truth:
        """Returns the true displacement of a marker. Raises KeyError."""
        import numpy

        rows = [self._simulation.truth(number, marker) for number in range(len(self))]
        if not rows or rows[0] is None:
            raise KeyError(marker)
        table = numpy.array(rows, dtype=float)
        return Truth(numpy.arange(len(self)) / self.fps, table[:, 0], table[:, 1])

    def write(self, folder: Path, on_progress: "Optional[OnProgress]" = None) -> None:
        """Writes frames/, site.toml and truth.csv as `moiregauge simulate` does. Raises UsageError, OutputError."""
        self._simulation.write(os.fspath(folder), on_progress)


def simulate(scenario: Path = "small-1xyz", *, frames: Optional[int] = None, seed: Optional[int] = None, markers_only: bool = False,
             settings: Optional[Dict[str, Any]] = None, threads: int = 0) -> Simulation:
    """Loads a built-in scenario or a TOML file (docs/cli/simulate.md). `settings`: {"lens.k1": -0.02}. Raises UsageError."""
    options = _core.SimulateOptions()
    options.frames, options.seed, options.markers_only, options.threads = frames, seed, markers_only, threads
    options.settings = [f"{key}={value}" for key, value in (settings or {}).items()]
    return Simulation(_core.Simulation(os.fspath(scenario), options))
