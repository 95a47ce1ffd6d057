# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of other sensors, call by call."""
import numpy as np
import pytest

import rio
from replay_test import rows_of, scans_of

SENSORS = ("position", "heading", "body_velocity", "world_velocity", "height", "ground_range")


def flown(flight, given, auxiliary=(), shift=0.0):
    """The flight with true values of one sensor at each scan: the estimator, statuses, rows of the
    sensor used in each update, distance of the end from the true one."""
    odometry = rio.Odometry(sensors=flight, auxiliary=auxiliary)
    truth = rio.read_path(flight, truth=True)
    scans = scans_of(flight)
    statuses = set()
    rows = {}
    for imu_time, values in rows_of(flight / "imu0/data.csv"):
        while scans and scans[0][0] < imu_time:
            time, points = scans.pop(0)
            at = np.searchsorted(truth.times, time)
            if given and odometry.initialized() and 0 < at < len(truth.times) - 1:
                statuses.add(give(odometry, given, truth, at, shift))
            odometry.add_scan(time, points)
        odometry.add_imu(imu_time, values[:3], values[3:])
        report = odometry.report()
        if "aiding" in report.models:
            rows[report.time] = report.models["aiding"]["rows_used"]
    end = odometry.at_scan()
    true_end = [np.interp(end.time, truth.times, truth.positions[:, axis]) for axis in range(3)]
    return odometry, statuses, list(rows.values()), np.linalg.norm(end.position - true_end)


def give(odometry, sensor, truth, at, shift):
    time = int(truth.times[at])
    position = truth.positions[at]
    w, x, y, z = truth.orientations[at]
    rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    velocity = (truth.positions[at + 1] - truth.positions[at - 1]) / (
        (truth.times[at + 1] - truth.times[at - 1]) * 1e-9)
    if sensor == "position":
        lever = np.array([0.3, 0.0, 0.1])
        return odometry.add_position(time, position + rotation @ lever, np.eye(3) * 1e-4, lever)
    if sensor == "heading":
        return odometry.add_heading(time, np.arctan2(rotation[1, 0], rotation[0, 0]), 0.01)
    if sensor == "body_velocity":
        return odometry.add_body_velocity(time, rotation.T @ velocity, np.eye(3) * 1e-3)
    if sensor == "world_velocity":
        return odometry.add_world_velocity(time, velocity, np.eye(3) * 1e-3)
    if sensor == "height":
        return odometry.add_height(time, position[2] + shift, 0.05)
    return odometry.add_ground_range(time, (position[2] + 5.0 - shift) / rotation[2, 2], 0.05)


@pytest.fixture(scope="module")
def error_alone(flight):
    return flown(flight, "")[3]


@pytest.mark.parametrize("sensor", SENSORS)
def test_true_values_are_used(flight, error_alone, sensor):
    auxiliary = {"height": ["height_offset"], "ground_range": ["ground_height"]}.get(sensor, ())
    shift = {"height": 0.7, "ground_range": 4.6}.get(sensor, 0.0)
    odometry, statuses, rows, error = flown(flight, sensor, auxiliary, shift)
    assert statuses <= {rio.Status.OK, rio.Status.WAITING}
    all_rows = 1 if sensor in ("heading", "height", "ground_range") else 3
    assert sum(row >= all_rows for row in rows) > 0.95 * len(rows) > 50
    assert error < 0.1 + (0.0 if sensor == "position" else error_alone)
    if sensor == "position":
        assert error < 0.03
    if auxiliary:
        value, sigma = odometry.auxiliary(auxiliary[0])
        expected = shift if sensor == "height" else shift - 5.0
        assert abs(value - expected) < 3.0 * sigma < 1.0
    assert odometry.auxiliary("wind") is None


def test_a_state_that_is_not_declared_is_told(flight):
    _, statuses, _, _ = flown(flight, "height")
    assert statuses == {rio.Status.UNDECLARED}
    assert rio.Odometry(auxiliary="height_offset").counters()["aiding"] == 0
    with pytest.raises(ValueError, match="wind: no such state, but height_offset and ground_height"):
        rio.Odometry(auxiliary=["wind"])
    with pytest.raises(ValueError, match="ground_height: given twice"):
        rio.Odometry(auxiliary=["ground_height", "ground_height"])


@pytest.mark.parametrize("call, arguments, why", [
    ("add_height", (1.0, 0.0), "sigma: a positive"),
    ("add_height", (np.nan, 1.0), "height: a finite"),
    ("add_heading", (0.0, np.inf), "sigma: a positive"),
    ("add_position", ([0, 0, np.nan], np.eye(3)), "position: three finite"),
    ("add_position", ([0, 0, 0], -np.eye(3)), "covariance: a symmetric"),
    ("add_world_velocity", ([0, 0, 0], [[1, 1, 0], [0, 1, 0], [0, 0, 1]]), "covariance: a symmetric"),
    ("add_body_velocity", ([0, 0, 0], np.eye(3) * np.nan), "covariance: a symmetric"),
    ("add_ground_range", (-1.0, 0.1), "range: a positive"),
    ("add_ground_range", (1.0, 0.1, [0, 0, -2]), "direction: a unit"),
])
def test_wrong_values_are_named(call, arguments, why):
    with pytest.raises(ValueError, match=why):
        getattr(rio.Odometry(), call)(0, *arguments)
