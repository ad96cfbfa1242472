# SPDX-License-Identifier: Apache-2.0
"""Phase of a grating by sampling moiré (docs/methods/sampling-moire.md)."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from . import _core

if TYPE_CHECKING:
    import numpy.typing


def sampling_moire(image: "numpy.typing.NDArray[Any]", *, pitch_px: float, axis: str = "x", region_px: Optional[int] = None,
                   noise_grey: float = 1.5) -> _core.FringePhase:
    """Returns the mean phase of a grating over the centred region of an image, with its u.

    `region_px`: side of the region; without it the largest that fits. `noise_grey`: noise of a pixel, grey levels.
    A grating that moves by +d px along the axis changes the phase by -2 pi d / pitch_px. Raises UsageError.
    """
    if region_px is None:
        region_px = max(1, min(image.shape[:2]) - 2 * int(-(-round(pitch_px) // 1)) + 2)
    return _core.sampling_moire(image, axis, pitch_px, region_px, noise_grey)


def phase_of(image: "numpy.typing.NDArray[Any]", *, pitch_px: float, axis: str = "x") -> _core.PhaseMap:
    """Returns phase and modulation of a grating, pixel by pixel, without the `margin` at the image's edges. Raises UsageError."""
    return _core.phase_map(image, axis, pitch_px)


def displacement_px(reference: _core.FringePhase, current: _core.FringePhase, *, pitch_px: float) -> float:
    """Returns the displacement along the axis between two phases of the same region in px, within half a pitch."""
    return _core.displacement_px(reference, current, pitch_px)
