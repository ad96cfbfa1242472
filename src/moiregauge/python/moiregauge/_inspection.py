# SPDX-License-Identifier: Apache-2.0
"""Shows what is detected in one image."""
from __future__ import annotations

import html
import json
import os
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple, Union

from . import _core
from ._site import Path, SiteLike, length_mm, set_site

if TYPE_CHECKING:
    import numpy.typing


class Inspection:
    """Markers, scale and expected uncertainty of one image. A notebook shows the overlay and a table."""

    def __init__(self, seen: _core.Inspection) -> None:
        self._seen = seen

    @property
    def markers(self) -> List[_core.InspectedMarker]:
        """Identified markers. Empty: `problem` states why."""
        return self._seen.markers

    @property
    def problem(self) -> str:
        """Why no measurement can begin with this image. Empty: it can."""
        return self._seen.problem

    @property
    def circles(self) -> int:
        """Number of circles."""
        return self._seen.circles

    @property
    def gratings(self) -> int:
        """Number of gratings."""
        return self._seen.gratings

    @property
    def size_px(self) -> Tuple[int, int]:
        """Width and height."""
        return self._seen.width, self._seen.height

    @property
    def mm_per_px(self) -> float:
        """Scale in the middle of the references. NaN without a pitch."""
        return self._seen.mm_per_px

    @property
    def distance(self) -> Optional[Tuple[str, str, float]]:
        """Two references and their distance in mm (NaN without a pitch). Check it with a tape."""
        if not self._seen.distance_from:
            return None
        return self._seen.distance_from, self._seen.distance_to, self._seen.distance_mm

    @property
    def warnings(self) -> List[str]:
        """Identifications to check."""
        return self._seen.warnings

    @property
    def json(self) -> Dict[str, Any]:
        """Contents of inspect.json (docs/file-formats.md)."""
        contents: Dict[str, Any] = json.loads(self._seen.json)
        return contents

    def __repr__(self) -> str:
        names = " ".join(marker.name for marker in self.markers) or f"no markers ({self.problem})"
        return f"<moiregauge.Inspection {names}, {self.mm_per_px:.4g} mm/px>"

    def _repr_png_(self) -> bytes:
        return self._seen.overlay_png

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(m.name)}</td><td>{'reference' if m.is_reference else 'target'}</td><td>{m.x_px:.1f}</td>"
            f"<td>{m.y_px:.1f}</td><td>{m.pitch_px:.2f}</td><td>{m.u_dx_mm:.2g}</td><td>{m.u_dy_mm:.2g}</td></tr>" for m in self.markers)
        lines = [f"{self.circles} circles, {self.gratings} gratings"]
        if self.distance:
            lines.append(f"{self.mm_per_px:.4g} mm/px; {self.distance[0]} to {self.distance[1]} = {self.distance[2]:.4g} mm")
        lines += [self.problem] if self.problem else []
        text = "".join(f"<p>{html.escape(line)}</p>" for line in [*lines, *self.warnings])
        return (f"{text}<table><tr><th>marker</th><th>role</th><th>x (px)</th><th>y (px)</th><th>pitch (px)</th>"
                f"<th>expected u of dx (mm)</th><th>of dy (mm)</th></tr>{rows}</table>")


def inspect(image: Union[Path, "numpy.typing.NDArray[Any]"], *, pitch: Optional[str] = None, pitch_mm: Optional[float] = None,
            site: Optional[SiteLike] = None, camera: Optional[Path] = None, frame: int = 0, fps: Optional[float] = None,
            bits: int = 0) -> Inspection:
    """Returns what is detected in a grey numpy image, or in one frame of a video, a folder or an image file.

    `bits`: grey levels of a uint16 array are below 2^bits (default 16). Raises UsageError, InputError.
    """
    options = _core.InspectOptions()
    options.pitch_mm = length_mm("pitch", pitch, pitch_mm)
    set_site(options, site)
    options.camera_file = os.fspath(camera) if camera is not None else ""
    options.frame, options.fps = frame, fps
    if isinstance(image, (str, os.PathLike)):
        return Inspection(_core.inspect_input(os.fspath(image), options))
    return Inspection(_core.inspect_image(image, bits, options))
