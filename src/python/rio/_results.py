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
    """How far the estimate can be trusted; rio/health.hpp.

    state: 'initialising', 'ok', 'degraded', 'dead reckoning' or 'lost': the worst of the three
    quality: 0 to 100; 50 where degraded begins
    reset_counter: jumps of the estimate, modulo 256
    severity: every reason: {name: signal over limit}
    """

    state: str
    position: str
    velocity: str
    heading: str
    quality: int
    reset_counter: int
    severity: dict[str, float]

    @property
    def reasons(self) -> dict[str, float]:
        """What makes it less than ok: {name: severity of 1 or more}; "one radar silent" is only told."""
        return {name: severity for name, severity in self.severity.items() if severity >= 1.0}

    def __repr__(self) -> str:
        return f"<rio.Health: {self.state}, quality {self.quality}, reasons {self.reasons}>"


@dataclass(frozen=True, eq=False)
class Report:
    """The last update; see UpdateReport in rio/report.hpp.

    time: stamp of the scan [ns]
    radar: index of the radar of the scan
    detections: in the scan
    detections_kept: after the filter
    static_detections: inliers of the ego-velocity consensus
    ego_velocity: (3,) radar axes [m/s]
    trails: alive after the update
    landmarks: in the state
    at_rest: standstill for a while, by IMU and radar
    models: {model: {'rows_used': ..., 'nis': ...}}
    calibration: {name of CALIBRATION: (correction to the option, sigma)} of what is estimated, SI units
    innovations: one record per measurement; fields as of Result.innovations
    """

    time: int
    radar: int
    status: Status
    detections: int
    detections_kept: int
    static_detections: int
    ego_velocity: NDArray[np.float64]
    ego_velocity_valid: bool
    trails: int
    landmarks: int
    landmarks_matched: int
    at_rest: bool
    health: Health
    models: dict[str, dict[str, float]]
    calibration: dict[str, tuple[float, float]]
    innovations: NDArray[np.void]


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
    """What a replay estimated; the arrays own their memory.

    times: (N,) [ns] of the scans; those of several radars at one instant share a row
    positions: (N, 3) of the body in the world [m]
    orientations: (N, 4) w, x, y, z
    velocities: (N, 3) in world axes [m/s]
    gyro_biases: (N, 3) [rad/s]
    accel_biases: (N, 3) [m/s^2]
    covariances: (N, 15, 15) errors of attitude (body axes), position, velocity, gyro bias, accel bias
    scans: one record per processed scan: time, radar, detections, static_detections, landmarks, ...,
        calibration and calibration_sigma (8, corrections to the options in the order of CALIBRATION, SI units;
        a sigma of zero: not estimated)
    innovations: one record per measurement: time, radar, model (of MODELS), result (of RESULTS), detection,
        dof, innovation, sigma (of the first row), nis, gate
    points: one record per point of the filtered scans, in the order of `detection`: time, radar, label (of
        POINT_LABELS), point (3) in radar axes, position (3) in the world, doppler, snr, residual (doppler minus
        that of a static point) and its sigma
    landmark_states: one record per landmark and scan: time, position (3) in the world, covariance (3, 3),
        last_seen
    summary: what `rio replay --json` prints
    verdict: "healthy", "doubtful: why" or "lost: why"
    notes: of the recording and of the options
    damage: empty, or where the recording is damaged: it ends there
    """

    times: NDArray[np.int64]
    positions: NDArray[np.float64]
    orientations: NDArray[np.float64]
    velocities: NDArray[np.float64]
    gyro_biases: NDArray[np.float64]
    accel_biases: NDArray[np.float64]
    covariances: NDArray[np.float64]
    scans: NDArray[np.void]
    innovations: NDArray[np.void]
    points: NDArray[np.void]
    landmark_states: NDArray[np.void]
    events: list[Event]
    summary: dict[str, Any]
    verdict: str
    lost: bool
    notes: list[str] = field(default_factory=list)
    damage: str = ""

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
