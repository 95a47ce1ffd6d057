# SPDX-License-Identifier: BSD-3-Clause
"""What an estimator and a replay give; users take it from the package itself."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

from ._rio import Status

PathLike = Union[str, "os.PathLike[str]"]


class Pose(NamedTuple):
    """Of a radar in the body: translation (3,) [m], orientation (4,) w, x, y, z, radar to body."""

    translation: NDArray[np.float64]
    orientation: NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class Health:
    """How far the estimate can be trusted; rio/health.hpp."""

    state: str
    """'initialising', 'ok', 'degraded', 'dead reckoning' or 'lost': the worst of the three"""
    position: str
    velocity: str
    heading: str
    quality: int
    """0 to 100; 50 where degraded begins"""
    reset_counter: int
    """jumps of the estimate, modulo 256"""
    severity: dict[str, float]
    """every reason: {name: signal over limit}"""

    @property
    def reasons(self) -> dict[str, float]:
        """What makes it less than ok: {name: severity of 1 or more}; "one radar silent" is only told."""
        return {name: severity for name, severity in self.severity.items() if severity >= 1.0}

    def __repr__(self) -> str:
        return f"<rio.Health: {self.state}, quality {self.quality}, reasons {self.reasons}>"


@dataclass(frozen=True, eq=False)
class Report:
    """The last update; see UpdateReport in rio/report.hpp."""

    time: int
    """stamp of the scan [ns]"""
    radar: int
    """index of the radar of the scan"""
    status: Status
    detections: int
    """in the scan"""
    detections_kept: int
    """after the filter"""
    static_detections: int
    """inliers of the ego-velocity consensus"""
    ego_velocity: NDArray[np.float64]
    """(3,) radar axes [m/s]"""
    ego_velocity_valid: bool
    trails: int
    """alive after the update"""
    landmarks: int
    """in the state"""
    landmarks_matched: int
    at_rest: bool
    """standstill for a while, by IMU and radar"""
    health: Health
    models: dict[str, dict[str, float]]
    """{model: {'rows_used': ..., 'nis': ...}}"""
    calibration: dict[str, tuple[float, float]]
    """{name of CALIBRATION: (correction to the option, sigma)} of what is estimated, SI units"""
    innovations: NDArray[np.void]
    """one record per measurement; fields as of Result.innovations"""


class Path(NamedTuple):
    """Poses by increasing time: times (N,) int64 [ns], positions (N, 3) [m], orientations (N, 4)
    w, x, y, z, body to world."""

    times: NDArray[np.int64]
    positions: NDArray[np.float64]
    orientations: NDArray[np.float64]


class Event(NamedTuple):
    """Something that happened in a replay: time of the scan that shows it [ns], what (as "velocity
    replaced", "gap of the IMU", "health: degraded"), value (of a re-opened position its sigma [m],
    else zero)."""

    time: int
    what: str
    value: float


@dataclass(frozen=True, repr=False, eq=False)
class Result:
    """What a replay estimated, one row per scan; the arrays own their memory."""

    times: NDArray[np.int64]
    """(N,) [ns]; the estimate is at the scan"""
    positions: NDArray[np.float64]
    """(N, 3) of the body in the world [m]"""
    orientations: NDArray[np.float64]
    """(N, 4) w, x, y, z"""
    velocities: NDArray[np.float64]
    """(N, 3) in world axes [m/s]"""
    gyro_biases: NDArray[np.float64]
    """(N, 3) [rad/s]"""
    accel_biases: NDArray[np.float64]
    """(N, 3) [m/s^2]"""
    covariances: NDArray[np.float64]
    """(N, 15, 15) errors of attitude (body axes), position, velocity, gyro bias, accel bias"""
    scans: NDArray[np.void]
    """one record per processed scan: time, radar, detections, static_detections, landmarks, ...,
    calibration and calibration_sigma (8, corrections to the options in the order of CALIBRATION, SI
    units; a sigma of zero: not estimated)"""
    innovations: NDArray[np.void]
    """one record per measurement: time, radar, model (of MODELS), result (of RESULTS), detection,
    dof, innovation, sigma (of the first row), nis, gate"""
    points: NDArray[np.void]
    """one record per point of the filtered scans, in the order of `detection`: time, radar, label (of
    POINT_LABELS), point (3) in radar axes, position (3) in the world, doppler, snr, residual (doppler
    minus that of a static point) and its sigma"""
    landmark_states: NDArray[np.void]
    """one record per landmark and scan: time, position (3) in the world, covariance (3, 3), last_seen"""
    events: list[Event]
    summary: dict[str, Any]
    """what `rio replay --json` prints"""
    verdict: str
    """"healthy", "doubtful: why" or "lost: why" """
    lost: bool
    notes: list[str] = field(default_factory=list)
    """of the recording and of the options"""
    damage: str = ""
    """empty, or where the recording is damaged: it ends there"""

    @property
    def landmarks(self) -> NDArray[np.void]:
        """How many landmarks are in the state, matched, added and removed, scan by scan."""
        names = ["time", "landmarks", "landmarks_matched", "landmarks_added", "landmarks_removed"]
        return self.scans[names]

    @property
    def path(self) -> Path:
        return Path(self.times, self.positions, self.orientations)

    def write_tum(self, file: PathLike) -> None:
        """Writes t x y z qx qy qz qw, as `rio replay --out` does."""
        with open(file, "w", encoding="ascii") as out:
            for t, p, q in zip(self.times.tolist(), self.positions.tolist(), self.orientations.tolist()):
                sign = "-" if t < 0 else ""
                numbers = p + q[1:] + q[:1]
                out.write(f"{sign}{abs(t) // 10**9}.{abs(t) % 10**9:09d} ")
                out.write(" ".join(f"{number:.9f}" for number in numbers) + "\n")

    def __repr__(self) -> str:
        return f"<rio.Result: {len(self.times)} poses, {self.verdict}>"
