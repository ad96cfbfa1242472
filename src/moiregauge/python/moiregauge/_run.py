# SPDX-License-Identifier: Apache-2.0
"""Measures a recording, and works on the finished run."""
from __future__ import annotations

import enum
import html
import json
import os
import pathlib
import shutil
import tempfile
import weakref
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, Optional, Union, overload

from . import _core
from ._site import CameraLike, Path, SiteLike, duration_s, frame_range, measure_options, set_camera, set_site

if TYPE_CHECKING:
    import numpy
    import numpy.typing
    import pandas

    FloatArray = numpy.typing.NDArray[numpy.float64]
    IntArray = numpy.typing.NDArray[numpy.int64]
    CodeArray = numpy.typing.NDArray[numpy.int32]

OnProgress = Callable[[int, int], Optional[bool]]


class Status(enum.IntEnum):
    """Code of a sample in `Target.status`. Only OK is trusted. From LOST on all numbers are NaN."""

    OK = 0
    UNTRUSTED = 1
    CAMERA_MOVED = 2
    BLURRED = 3
    SATURATED = 4
    PARTLY_COVERED = 5
    LOST = 6
    REFERENCE_LOST = 7
    ORDER_UNPROVEN = 8
    DECODE_ERROR = 9
    TOO_COARSE = 10

    @property
    def word(self) -> str:
        """The word of displacement.csv."""
        return _core.status_word(int(self))


def _words(codes: "CodeArray") -> "pandas.Categorical":
    import pandas

    return pandas.Categorical.from_codes(codes, categories=[status.word for status in Status])


class Channel:
    """Series of one derived channel, with its own u. Not measured is NaN."""

    def __init__(self, table: _core.DerivedChannels, values: _core.DerivedChannel) -> None:
        self._table = table
        self._values = values
        self.name = values.name
        self.unit = values.unit
        self.expression = values.expression
        self.mean, self.u_mean = values.mean, values.u_mean
        self.rms, self.u_rms = values.rms, values.u_rms
        self.peak_to_peak, self.u_peak_to_peak = values.peak_to_peak, values.u_peak_to_peak

    @property
    def frame(self) -> "IntArray":
        """Frame of every row. Empty after a layer that resamples."""
        return self._table.frame

    @property
    def time(self) -> "FloatArray":
        """Time of every row, s from frame 0."""
        return self._table.time

    @property
    def value(self) -> "FloatArray":
        """Values in `unit`."""
        return self._values.value

    @property
    def u(self) -> "FloatArray":
        """Standard uncertainty (k = 1) of every value."""
        return self._values.u

    @property
    def status(self) -> "CodeArray":
        """Codes of Status."""
        return self._values.status

    def __len__(self) -> int:
        return len(self.value)

    def __repr__(self) -> str:
        return f"<Channel {self.name!r}: {len(self)} rows, peak to peak {self.peak_to_peak:.4g} {self.unit} (u {self.u_peak_to_peak:.2g})>"


class Run:
    """A finished run. `run["T1"]` is a target, whose arrays are views of the result's memory.

    Without an output folder the files are in a temporary folder, which is removed with the last reference to the run.
    """

    def __init__(self, result: _core.Result, known: Optional[_core.SolveOptions] = None, is_temporary: bool = False) -> None:
        self._result = result
        self._known = known or _core.SolveOptions()
        self._targets = {target.name: target for target in result.targets}
        if is_temporary:
            weakref.finalize(self, shutil.rmtree, _root_of(result.folder), True)

    def __getitem__(self, name: str) -> _core.Target:
        if name not in self._targets:
            raise KeyError(f"the target does not exist: {name}: choose from {', '.join(self._targets)}")
        return self._targets[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._targets)

    def __len__(self) -> int:
        return len(self._targets)

    def __contains__(self, name: object) -> bool:
        return name in self._targets

    def __repr__(self) -> str:
        state = f"refused: {self.refusal}" if self.refusal else ", ".join(self._targets)
        return f"<moiregauge.Run {state} in {self.folder}>"

    @property
    def names(self) -> List[str]:
        """Names of the targets."""
        return list(self._targets)

    @property
    def folder(self) -> pathlib.Path:
        """Folder with displacement.csv, run.json, report.html and the observations."""
        return pathlib.Path(self._result.folder)

    @property
    def json(self) -> Dict[str, Any]:
        """Contents of run.json (docs/file-formats.md)."""
        text = (self.folder / "run.json").read_text(encoding="utf-8")
        contents: Dict[str, Any] = json.loads(text)
        return contents

    @property
    def camera(self) -> Optional[_core.Camera]:
        """Camera as solved from the footage. None: the footage does not determine it."""
        return None if self.json["camera"]["fx"] is None else self._result.camera

    @property
    def scene(self) -> Dict[str, Any]:
        """The solved scene: model, chi2_dof, key_frames, readout_s and the markers with their u."""
        contents = self.json
        return {**contents["scene"], "markers": contents["markers"]}

    @property
    def site(self) -> _core.Site:
        """Site as stated, or as detected."""
        return self._result.site

    @property
    def reference_frame(self) -> int:
        """Number of the reference frame. -1: none was found."""
        return self._result.reference_frame

    @property
    def references_verified(self) -> bool:
        """The references were tested against each other, and none moves."""
        return self._result.references_verified

    @property
    def warnings(self) -> List[str]:
        """Notes and warnings of the run."""
        return self._result.warnings

    @property
    def refusal(self) -> str:
        """Why no sample is trusted. Empty for a measurement."""
        return self._result.refusal

    @property
    def exit_code(self) -> int:
        """Exit code of the program for the same run: 0, 4 (refused), 5 (over 1 % not ok) or 130 (stopped)."""
        return self._result.exit_code

    @property
    def is_interrupted(self) -> bool:
        """The run was stopped by `on_progress`. Its samples end there."""
        return self.exit_code == 130

    def to_pandas(self) -> "pandas.DataFrame":
        """Returns a table with the rows and columns of displacement.csv, unrounded."""
        import pandas

        if not self._targets:
            columns = ["frame", "time_s", "marker", "dx_mm", "dy_mm", "u_dx_mm", "u_dy_mm", "status"]
            return pandas.DataFrame(columns=columns)
        parts = [
            pandas.DataFrame({"frame": t.frame, "time_s": t.time, "marker": t.name, "dx_mm": t.dx, "dy_mm": t.dy, "u_dx_mm": t.u_dx,
                              "u_dy_mm": t.u_dy, "status": _words(t.status)})
            for t in self._targets.values()
        ]
        return pandas.concat(parts).sort_values("frame", kind="stable", ignore_index=True)

    def solve(self, *, site: Optional[SiteLike] = None, camera: Optional[CameraLike] = None, method: Optional[str] = None,
              rest: Optional[str] = None, zero: Optional[str] = None, fps: Optional[float] = None, readout: Optional[str] = None,
              readout_s: Optional[float] = None, out: Optional[Path] = None) -> "Run":
        """Solves the run again with other options, without its video. This run stays as it is (docs/cli/solve.md).

        `rest`, `zero`: "0:20" or "0s:2s"; "none" withdraws the run's own. `out`: folder of the new results.
        Raises UsageError, InputError, OutputError.
        """
        options = _core.SolveOptions()
        set_site(options, site)
        set_camera(options, camera)
        options.method = method or ""
        options.has_rest, options.has_zero = rest != "none", zero != "none"
        options.rest = frame_range("--rest", None if rest == "none" else rest)
        options.zero = frame_range("--zero", None if zero == "none" else zero)
        options.fps = fps
        options.readout_s = duration_s("readout", readout, readout_s)
        options.output = _output(out)
        known = _core.SolveOptions()
        set_site(known, site)
        set_camera(known, camera)
        try:
            result = _core.solve(os.fspath(self.folder), options)
        except BaseException:
            _discard(options.output, out)
            raise
        return Run(result, known, out is None)

    @overload
    def derive(self, __channel: str, **layers: Any) -> Channel: ...
    @overload
    def derive(self, **layers: Any) -> Dict[str, Channel]: ...
    @overload
    def derive(self, __first: str, __second: str, *more: str, **layers: Any) -> Dict[str, Channel]: ...

    def derive(self, *channels: str, **layers: Any) -> Union[Channel, Dict[str, Channel]]:
        """Combines displacements to channels with their own u (docs/cli/derive.md).

            run.derive("T2.dy - T1.dy")                                     # one channel
            run.derive("sag = mid.dy - left.dy", "tilt = rotation(left, right)", zero="0s:3s", filter="lowpass:5Hz")

        One expression gives a Channel. Several, or none (the channels of the site file), give a dictionary by name.
        Layers apply in the order of the arguments: zero, detrend=True, filter, velocity, resample, median.
        Raises UsageError, InputError, RefusedError.
        """
        options = _core.DeriveOptions()
        options.channels = [text if "=" in text else f"channel = {text}" for text in channels]
        options.layers = [(name, "" if value is True else str(value)) for name, value in layers.items() if value is not False]
        options.solved = self._known
        table = _core.derive(os.fspath(self.folder), options)
        found = {values.name: Channel(table, values) for values in table.channels}
        return next(iter(found.values())) if len(channels) == 1 else found

    def report(self, path: Path) -> None:
        """Writes a copy of the report, one file for any browser. Raises InputError, OutputError."""
        _core.write_report(os.fspath(self.folder), os.fspath(path))

    def save(self, folder: Path) -> pathlib.Path:
        """Copies all files of the run to a new folder. Raises OutputError."""
        try:
            return pathlib.Path(shutil.copytree(self.folder, folder))
        except (OSError, shutil.Error) as error:
            raise _core.OutputError(f"the run could not be copied: {error}: choose a new folder") from error

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(t.name)}</td><td>{_span(t.dx):.4g}</td><td>{2 * t.rms_u_dx:.2g}</td>"
            f"<td>{_span(t.dy):.4g}</td><td>{2 * t.rms_u_dy:.2g}</td><td>{t.ok} of {len(t)}</td></tr>" for t in self._targets.values())
        notes = "".join(f"<li>{html.escape(text)}</li>" for text in self.warnings)
        head = f"<p>refused: {html.escape(self.refusal)}</p>" if self.refusal else ""
        return (f"{head}<table><tr><th>target</th><th>dx peak to peak (mm)</th><th>U (k = 2)</th><th>dy peak to peak (mm)</th>"
                f"<th>U (k = 2)</th><th>ok</th></tr>{rows}</table><ul>{notes}</ul>")


def _span(values: "FloatArray") -> float:
    import numpy

    finite = values[numpy.isfinite(values)]
    return float(finite.max() - finite.min()) if len(finite) else float("nan")


def _output(out: Optional[Path]) -> str:
    """Returns the folder to write: the user's, or a new one inside a temporary folder."""
    return os.fspath(out) if out is not None else os.path.join(tempfile.mkdtemp(prefix="moiregauge-"), "run")


def _root_of(folder: str) -> str:
    """Returns the temporary folder of a run."""
    return os.path.dirname(folder)


def _discard(folder: str, out: Optional[Path]) -> None:
    """Removes the temporary folder of a run that failed."""
    if out is None:
        shutil.rmtree(_root_of(folder), ignore_errors=True)


def measure(input: Path, *, pitch: Optional[str] = None, pitch_mm: Optional[float] = None,  # pylint: disable=redefined-builtin
            site: Optional[SiteLike] = None, camera: Optional[CameraLike] = None, method: str = "precise",
            fps: Optional[float] = None, slow_motion: Optional[float] = None, frames: Optional[str] = None,
            reference_frame: Optional[int] = None, rest: Optional[str] = None, zero: Optional[str] = None,
            readout: Optional[str] = None, readout_s: Optional[float] = None, tone: str = "auto", out: Optional[Path] = None,
            resume: bool = False, restart: bool = False, threads: int = 0, on_progress: Optional[OnProgress] = None) -> Run:
    """Measures a video, a folder of images or a multi-page TIFF (docs/cli/measure.md).

    The scale is mandatory: `pitch="10mm"`, `pitch_mm=10` or `site=`. `frames`, `rest`, `zero`: "0:20" or "0s:2s".
    `out`: folder of the results; without it they are in a temporary folder. `on_progress(done, expected)` is called about 20 times
    a second and stops the run by returning False. Ctrl-C stops it, too. With `out` the frames are then kept for `resume=True`.
    Raises UsageError, InputError, OutputError, and RefusedError if no sample is trusted. Its attribute `run` is the refused run.
    """
    options = measure_options(pitch, pitch_mm, site, camera)
    options.method, options.tone, options.threads = method, tone, threads
    options.fps, options.slow_motion, options.reference_frame = fps, slow_motion, reference_frame
    selected = frame_range("--frames", frames)
    if selected is not None:
        options.frames = selected
    options.rest, options.zero = frame_range("--rest", rest), frame_range("--zero", zero)
    options.readout_s = duration_s("readout", readout, readout_s)
    if resume and restart:
        raise _core.UsageError("resume and restart exclude each other: measure: give one of them")
    if resume:
        options.resumes = True
    if restart:
        options.restarts = True
    options.output = _output(out)
    try:
        result = _core.measure(os.fspath(input), options, on_progress)
    except BaseException:
        _discard(options.output, out)
        raise
    run = Run(result, None, out is None)
    if run.exit_code == 4:
        refused = _core.RefusedError(f"the run is refused because {run.refusal}: {os.fspath(input)}: "
                                     f"{result.remedy or f'see {run.folder}/overlay.png'}")
        refused.run = run  # type: ignore[attr-defined]
        raise refused
    return run


def load(folder: Path, *, site: Optional[SiteLike] = None, camera: Optional[CameraLike] = None) -> Run:
    """Reads a run that `measure` or the program wrote. Every bit is that of the measurement.

    `site`, `camera`: those of an earlier `solve` in this folder, which the folder does not store.
    Raises InputError (no run, or a damaged one) and UsageError (results that need a site or camera).
    """
    known = _core.SolveOptions()
    set_site(known, site)
    set_camera(known, camera)
    return Run(_core.read_run(os.fspath(folder), known), known)
