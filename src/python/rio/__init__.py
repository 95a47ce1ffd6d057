# SPDX-License-Identifier: BSD-3-Clause
"""Radar-inertial odometry: pose and velocity from an IMU and an FMCW radar.

    result = rio.replay("flight.bag", {"radar": {"sigma_doppler": "5 cm/s"}})
    print(result.verdict, result.positions[-1])

SI units, radians and nanoseconds throughout. World axes have z up, body axes are those of the IMU
(x forward, y left, z up). Quaternions are w, x, y, z and take body to world axes. What goes wrong
is an exception: rio.Error (a RuntimeError), with file and line where there is one.
"""

from __future__ import annotations

import difflib
import json
import os
from dataclasses import dataclass
from typing import Any, Iterator, KeysView, Mapping, NamedTuple, Sequence, Union

import numpy as np

from . import _rio
from ._results import Event, Health, Path, PathLike, Pose, Report, Result
from ._rio import CALIBRATION, MODELS, POINT_LABELS, Error, State, Status, __version__

__all__ = [
    "CALIBRATION", "Error", "Event", "Finding", "Findings", "HEALTH_STATES", "Health", "MODELS", "Odometry",
    "Options", "POINT_LABELS", "Path", "Pose", "RESULTS", "Report", "Result", "State", "Status", "__version__",
    "check", "evaluate", "options_of", "read_path", "replay", "simulate",
]

HEALTH_STATES = ("initialising", "ok", "degraded", "dead reckoning", "lost")
"""Names of the values of `health` in Result.scans."""

RESULTS = ("used", "gated", "out of domain")
"""Names of the values of `result` in Result.innovations."""

class Options:
    """Option values, as an option file has them: of a dict, of a file, or key by key.

        options = rio.Options({"radar": {"sigma_doppler": "5 cm/s"}}, preset="default")
        options["update.max_landmarks"] = 20
        options["radar.max_range"]            # every key has a value

    Numbers are in SI units, texts have their unit. The values lie over the preset and, in a replay,
    over the sensor files of the recording. An unknown key, a wrong unit or a value out of range is
    a rio.Error, with the key that was probably meant.
    """

    def __init__(self, values: Mapping[str, Any] | None = None, *, preset: str = "") -> None:
        self._texts: list[str] = []
        self._preset = preset
        if values is not None and not isinstance(values, Mapping):
            raise TypeError("options: a dict is expected; of a file: rio.Options.from_file()")
        if values:
            self._texts.append(_text_of(values))
        self.as_dict()  # refuses what is wrong

    @classmethod
    def from_yaml(cls, text: str) -> Options:
        """Of the text of an option file."""
        options = cls()
        options._texts.append(text)
        options.as_dict()
        return options

    @classmethod
    def from_file(cls, path: PathLike) -> Options:
        """Of an option file; `rio options` writes one."""
        with open(path, encoding="utf-8") as file:
            text = file.read()
        try:
            return cls.from_yaml(text)
        except Error as error:
            raise Error(str(error).replace("options:", f"{os.fspath(path)}:", 1)) from None

    def copy(self) -> Options:
        other = Options(preset=self._preset)
        other._texts = list(self._texts)
        return other

    def __setitem__(self, key: str, value: Any) -> None:
        nested: Any = value
        for part in reversed(key.split(".")):
            nested = {part: nested}
        other = self.copy()
        other._texts.append(_text_of(nested))
        other.as_dict()
        self._texts = other._texts

    def __getitem__(self, key: str) -> Any:
        values = self.as_dict()
        if key not in values:
            near = difflib.get_close_matches(key, values, 1)
            raise KeyError(key + "".join(f"; did you mean {name}?" for name in near))
        return values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.as_dict())

    def keys(self) -> KeysView[str]:
        return self.as_dict().keys()

    def __len__(self) -> int:
        return len(self.as_dict())

    def as_dict(self) -> dict[str, Any]:
        """The preset, and every key with its value, without sensor files. Given to a replay, all of
        them win over its sensor files, the mounting included."""
        return _rio.option_values(self._texts, self._preset)

    def yaml(self) -> str:
        """The same as the text of an option file, with units and meanings. For one that keeps the
        values of a recording's sensor files: options_of(recording).yaml()."""
        return _rio.option_file(self._texts, self._preset)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Options) and self.as_dict() == other.as_dict()

    def __repr__(self) -> str:
        default = _rio.option_values([], "")
        changed = {k: v for k, v in self.as_dict().items() if v != default[k]}
        return f"rio.Options({changed})"

    @staticmethod
    def meanings() -> dict[str, tuple[str, str]]:
        """Unit and meaning of every key."""
        return _rio.option_meanings()


OptionsLike = Union[Options, Mapping[str, Any], None]


def _plain(value: Any) -> Any:
    """Numpy values as lists and numbers, any mapping as a dict."""
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"options: {value!r}: a number, text, list or dict is expected")


def _text_of(values: Mapping[str, Any]) -> str:
    """JSON is YAML."""
    return json.dumps(values, default=_plain, indent=0)


def _options(options: OptionsLike) -> Options:
    return options if isinstance(options, Options) else Options(options)


class Odometry(_rio.Odometry):
    """The estimator, fed sample by sample; see rio/rio.hpp for the rules of order and time.

        odometry = rio.Odometry({"radar": {"T_BS": {"translation": [0.1, 0, -0.05]}}})
        odometry.add_imu(time, gyro, accel)      # each IMU sample
        odometry.add_scan(time, points)          # each radar scan
        odometry.now().position

    sensors: a folder with imu0/sensor.yaml, radar0/sensor.yaml, radar1/sensor.yaml, ..., as
    `rio calibrate` writes it; its radars can be fed. The options win over it. A file or mounting
    that is missing is a warning.
    auxiliary: states that other sensors need beside the estimator's own: "height_offset" for
    add_height, "ground_height" for add_ground_range.
    """

    def __init__(self, options: OptionsLike = None, *, sensors: PathLike = "",
                 auxiliary: Sequence[str] = ()) -> None:
        chosen = _options(options)
        names = [auxiliary] if isinstance(auxiliary, str) else list(auxiliary)
        super().__init__(chosen._texts, chosen._preset, os.fspath(sensors), names)

    def health(self) -> Health:
        """How far the estimate can be trusted."""
        return Health(**_rio.health_of(self))

    def report(self) -> Report:
        """The last update."""
        values = _rio.report_of(self)
        values["health"] = Health(**values["health"])
        return Report(**values)

    def extrinsics(self, radar: int = 0) -> Pose:
        """Pose of a radar in the body: the estimate, or that of the options if it is not estimated.
        IndexError if there is no such radar."""
        return Pose(*_rio.extrinsics_of(self, radar))


def replay(path: PathLike, options: OptionsLike = None, *, init: str = "", map: PathLike = "",
           sensors: PathLike = "", dataset: str = "", barometer: bool = False,
           check: bool = False) -> Result:
    """Runs a recording through the estimator, as `rio replay` does, to the same bits.

    path: a folder in ASL/EuRoC layout, a ROS 1 bag, an MCAP or a .db3
    options: as of `rio replay --config`; over the preset and the sensor files
    init: "groundtruth", "static" or a file; by default groundtruth if there is one
    map, sensors, dataset: of a bag, as the flags of that name
    barometer: use the heights of the recording
    check: also look for errors of the recording, into summary["data"]; steps of its clocks are taken
        out in any case

    A lost estimate is a Result with `lost`; a replay that could not start is a rio.Error.
    Other threads run meanwhile; Ctrl-C ends it.
    """
    chosen = _options(options)
    arrays = _rio.replay(os.fspath(path), chosen._texts, chosen._preset, init, os.fspath(map),
                         os.fspath(sensors), dataset, barometer, check)
    arrays["summary"] = json.loads(arrays["summary"])
    arrays["events"] = [Event(*event) for event in arrays["events"]]
    return Result(**arrays)


PathSource = Union[PathLike, Result, Path]


def read_path(file: PathLike, *, truth: bool = False) -> Path:
    """Poses of a TUM file, a EuRoC csv, the ground truth of a dataset folder or, with truth, of a
    bag. A truth may be positions alone (`t x y z`, a total station, GNSS): orientations of NaN."""
    return Path(*_rio.read_path(os.fspath(file), truth))


def _named_path(source: PathSource, truth: bool) -> tuple[Path, str]:
    if isinstance(source, Result):
        source = source.path
    if not isinstance(source, Path):
        return read_path(source, truth=truth), os.fspath(source)
    if np.asarray(source.times).dtype.kind not in "iu":
        raise TypeError("times of a path: integers are expected, nanoseconds")
    return source._replace(positions=np.ma.filled(source.positions, np.nan)), "result"


def evaluate(truth: PathSource, estimate: PathSource, *, align: str = "none",
             max_diff: float = 0.01) -> dict[str, Any]:
    """Compares an estimated path with the true one; the figures of `rio evaluate --json`.

    truth, estimate: a file, a folder, a rio.Path or a Result; figures of the attitude and `rpe`
        are None where the truth is positions alone
    align: "none", "origin", "yaw" or "se3", for all figures except `ape`
    max_diff: largest difference of stamps if the truth is too sparse to interpolate [s]
    """
    true_path, true_name = _named_path(truth, True)
    path, name = _named_path(estimate, False)
    figures: dict[str, Any] = json.loads(
        _rio.evaluate(true_path, true_name, path, name, align, max_diff))
    return figures


def simulate(out: PathLike, scenario: PathLike = "", *, seed: int | None = None,
             length: float | None = None, trajectory: PathLike = "", radars: int = 1,
             ideal: bool = False) -> str:
    """Writes a simulated flight with its truth as a folder, as `rio simulate` does.

    scenario: a name of `rio scenarios`, or a file
    length: of the path [m]
    trajectory: a recorded path to fly, a file
    ideal: without any noise

    Returns the name of the folder.
    """
    folder = os.fspath(out)
    _rio.simulate(folder, os.fspath(scenario), seed, length, os.fspath(trajectory), radars, ideal)
    return folder


class Finding(NamedTuple):
    """One thing that was checked: verdict ("ok", "doubtful" or "wrong"), subject, text, change (what
    to change; may be empty)."""

    verdict: str
    subject: str
    text: str
    change: str


@dataclass(frozen=True)
class Findings:
    """What `rio check` finds in a recording.

    options: proposed options as the text of an option file: Options.from_yaml()
    """

    findings: list[Finding]
    options: str
    notes: list[str]
    damage: str

    @property
    def verdict(self) -> str:
        """The worst one."""
        found = {finding.verdict for finding in self.findings}
        return next((v for v in ("wrong", "doubtful") if v in found), "ok")


def check(path: PathLike, options: OptionsLike = None, *, map: PathLike = "",
          sensors: PathLike = "") -> Findings:
    """Looks for errors of a recording, as `rio check` does: units, axes, mounting, delays, stamps."""
    found = _rio.check(os.fspath(path), _options(options)._texts, os.fspath(map), os.fspath(sensors))
    found["findings"] = [Finding(*finding) for finding in found["findings"]]
    return Findings(**found)


def options_of(path: PathLike, options: OptionsLike = None) -> Options:
    """The options with which a replay of this recording flies, sensor files included."""
    chosen = _options(options)
    return Options.from_yaml(_rio.options_of(os.fspath(path), chosen._texts, chosen._preset))
