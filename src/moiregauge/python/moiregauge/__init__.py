# SPDX-License-Identifier: Apache-2.0
"""Displacement in millimetres, with an uncertainty for every sample, from video of printed gratings.

    import moiregauge
    run = moiregauge.measure("clip.mp4", pitch="10mm")
    print(run["T1"].dy, run["T1"].u_dy)

Lengths are mm, x is right and y is up. u is a standard uncertainty (k = 1). docs/python.md describes the module.
"""
from ._core import (Camera, Error, FringePhase, InputError, InternalError, Marker, OutputError, PhaseMap, RefusedError, Sample, Site,
                    Target, TrackedFrame, UsageError, __version__)
from ._inspection import Inspection, inspect
from ._run import Channel, Run, Status, load, measure
from ._simulation import Simulation, simulate
from ._site import read_camera, read_site
from ._sampling_moire import displacement_px, phase_of, sampling_moire
from ._tracker import Tracker

__all__ = [
    "Camera", "Channel", "Error", "FringePhase", "InputError", "Inspection", "InternalError", "Marker", "OutputError", "PhaseMap",
    "RefusedError", "Run", "Sample", "Simulation", "Site", "Status", "Target", "TrackedFrame", "Tracker", "UsageError", "__version__",
    "displacement_px", "inspect", "load", "measure", "phase_of", "read_camera", "read_site", "sampling_moire", "simulate",
]
