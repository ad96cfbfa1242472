# SPDX-License-Identifier: Apache-2.0
"""Measures a camera's frames one by one."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional

from . import _core
from ._site import CameraLike, SiteLike, measure_options

if TYPE_CHECKING:
    import numpy.typing


class Tracker:
    """Follows the markers of a live camera in constant memory. The first measurable frame is the reference frame.

        tracker = moiregauge.Tracker(pitch="10mm")
        frame = tracker.update(image, time)
        print(frame["T1"].dy, frame["T1"].u_dy, frame["T1"].status)

    Threads may share a tracker. Each frame is measured without the interpreter's lock and without a copy.
    """

    def __init__(self, *, pitch: Optional[str] = None, pitch_mm: Optional[float] = None, site: Optional[SiteLike] = None,
                 camera: Optional[CameraLike] = None, tone: str = "auto", bits: int = 0) -> None:
        """Creates a tracker. `bits`: grey levels of uint16 frames are below 2^bits (default 16). Raises UsageError."""
        options = measure_options(pitch, pitch_mm, site, camera)
        options.tone = tone
        self._bits = bits
        self._tracker = _core.Tracker(options)

    def update(self, frame: "numpy.typing.NDArray[Any]", time: float) -> _core.TrackedFrame:
        """Measures one grey frame (uint8 or uint16). `time` in s must rise. Raises UsageError, InputError."""
        return self._tracker.update(frame, time, self._bits)

    @property
    def names(self) -> List[str]:
        """Names of the targets. Empty before the reference frame."""
        return self._tracker.names

    @property
    def frames(self) -> int:
        """Number of frames so far."""
        return self._tracker.frames

    @property
    def warnings(self) -> List[str]:
        """Warnings about the scene in force, each once."""
        return self._tracker.warnings
