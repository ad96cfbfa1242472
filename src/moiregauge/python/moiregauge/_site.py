# SPDX-License-Identifier: Apache-2.0
"""Arguments with units, and files of site and camera."""
from __future__ import annotations

import os
from typing import Callable, Optional, Union

from . import _core

Path = Union[str, "os.PathLike[str]"]
SiteLike = Union[_core.Site, Path]
CameraLike = Union[_core.Camera, Path]


def read_site(path: Path) -> _core.Site:
    """Reads a site file. Raises UsageError with each mistake, its line and column."""
    return _core.read_site(os.fspath(path))


def read_camera(path: Path) -> _core.Camera:
    """Reads a camera file: TOML with a [camera] table, or OpenCV/ROS YAML. Raises UsageError."""
    return _core.read_camera(os.fspath(path))


def quantity(name: str, text: Optional[str], number: Optional[float], unit: str, read: Callable[[str], float]) -> Optional[float]:
    """Returns the number in `unit` of `name="10mm"` or `name_mm=10`. Raises UsageError for both, and for text without a unit."""
    if text is not None and number is not None:
        raise _core.UsageError(f"a quantity is stated twice: {name} and {name}_{unit}: give one of them")
    if text is None:
        return None if number is None else float(number)
    if not isinstance(text, str):
        raise _core.UsageError(f'the quantity has no unit: {name}={text!r}: write {name}="{text}{unit}" or {name}_{unit}={text}')
    return read(text)


def length_mm(name: str, text: Optional[str], number: Optional[float]) -> Optional[float]:
    """Returns millimetres. Raises UsageError."""
    return quantity(name, text, number, "mm", _core.read_length_mm)


def duration_s(name: str, text: Optional[str], number: Optional[float]) -> Optional[float]:
    """Returns seconds. Raises UsageError."""
    return quantity(name, text, number, "s", _core.read_duration_s)


def frame_range(option: str, text: Optional[str]) -> Optional[_core.FrameRange]:
    """Returns frames ("0:20") or times ("0s:2s"). Raises UsageError."""
    return None if text is None else _core.read_frame_range(text, option)


def set_site(options: Union[_core.MeasureOptions, _core.SolveOptions, _core.InspectOptions], site: Optional[SiteLike]) -> None:
    """Sets a site, or the file of one."""
    if isinstance(site, _core.Site):
        options.site = site
    elif site is not None:
        options.site_file = os.fspath(site)


def set_camera(options: Union[_core.MeasureOptions, _core.SolveOptions], camera: Optional[CameraLike]) -> None:
    """Sets a camera, or the file of one."""
    if isinstance(camera, _core.Camera):
        options.camera = camera
    elif camera is not None:
        options.camera_file = os.fspath(camera)


def measure_options(pitch: Optional[str], pitch_mm: Optional[float], site: Optional[SiteLike],
                    camera: Optional[CameraLike]) -> _core.MeasureOptions:
    """Returns options with the scale, which is mandatory, and the camera. Raises UsageError."""
    if (pitch is not None or pitch_mm is not None) == (site is not None):
        state = "is missing" if site is None else "is stated twice"
        raise _core.UsageError(f'the scale {state}: pitch and site: give one of them, e.g. pitch="10mm"')
    options = _core.MeasureOptions()
    options.pitch_mm = length_mm("pitch", pitch, pitch_mm)
    set_site(options, site)
    set_camera(options, camera)
    return options
