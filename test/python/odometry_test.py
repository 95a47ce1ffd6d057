# SPDX-License-Identifier: BSD-3-Clause
"""rio.Odometry call by call: what it shows at each scan, its callback, a new start."""
import gc
import threading
import time
import weakref
from decimal import Decimal

import numpy as np
import pytest

import rio
from replay_test import rows_of, scans_of

BEGIN = 17 * 10**17  # of a simulated flight [ns]


def fly(odometry, flight, until=10**19):
    scans = scans_of(flight)
    for time, values in rows_of(flight / "imu0/data.csv"):
        while scans and scans[0][0] < time:
            odometry.add_scan(*scans.pop(0))
        if time >= until:
            return
        odometry.add_imu(time, values[:3], values[3:])


def test_each_scan_is_told_with_all_that_a_replay_has(flight):
    replayed = rio.replay(flight, init="static")
    odometry = rio.Odometry(sensors=flight)
    states = []
    seen = []

    def look(told):
        assert told is odometry
        report = told.report()
        state = told.at_scan()
        states.append((state.time, state.position, state.orientation, state.velocity, told.covariance()))
        seen.append((report.time, told.points(), told.landmarks(), report))

    odometry.on_scan(look)
    fly(odometry, flight)
    assert [s[0] for s in seen] == replayed.scans["time"].tolist()
    of_replay = (replayed.times, replayed.positions, replayed.orientations, replayed.velocities, replayed.covariances)
    assert all(np.array_equal(own, other) for own, other in zip(zip(*states), of_replay))
    assert np.array_equal(np.concatenate([s[1] for s in seen]), replayed.points)
    assert np.array_equal(np.concatenate([s[2] for s in seen]), replayed.landmark_states)
    assert odometry.health().state == "ok" and odometry.health().reasons == {}
    assert odometry.report().models["doppler"]["rows_used"] > 0
    assert odometry.report().innovations["nis"].shape == (len(odometry.report().innovations),)
    assert odometry.now().time >= odometry.at_scan().time
    for row, (*_, report) in zip(replayed.scans, seen):
        assert list(report.calibration) == list(rio.CALIBRATION)
        values = [report.calibration[name] for name in rio.CALIBRATION]
        assert np.array_equal(np.transpose(values), [row["calibration"], row["calibration_sigma"]])
    odometry.on_scan(None)
    count = len(seen)
    fly(odometry, flight)
    assert len(seen) == count
    options = rio.options_of(flight)
    pose = odometry.extrinsics()
    off = pose.translation - options["radar.T_BS.translation"]
    assert 0 < np.linalg.norm(off) < 0.05 and np.linalg.norm(pose.orientation) == pytest.approx(1.0)


def test_points_say_what_they_were_taken_for(flight):
    result = rio.replay(flight)
    points = result.points
    assert len(points) == result.scans["detections_kept"].sum()
    label = np.array(rio.POINT_LABELS)[points["label"]]
    fits = (label == "static") | (label == "matched")
    assert 0.6 < fits.mean() < 0.98
    ratio = points["residual"] / points["sigma"]
    assert np.std(ratio[fits]) < 1.5 and np.abs(ratio[label == "outlier"]).mean() > 3.0
    ranges = np.linalg.norm(points["position"] - np.repeat(result.positions, result.scans["detections_kept"], 0), axis=1)
    assert np.abs(ranges - np.linalg.norm(points["point"], axis=1)).max() < 0.5  # of the lever


def test_a_call_that_raises_is_raised_and_cannot_add(flight):
    odometry = rio.Odometry(sensors=flight)
    changes = [lambda o: o.add_imu(0, [0, 0, 0], [0, 0, 9.81]), lambda o: o.add_scan(0, []),
               lambda o: o.add_height(0, 0.0, 1.0), lambda o: o.reset(), lambda o: o.on_scan(None)]
    for change in changes:
        odometry.reset()
        odometry.on_scan(change)
        with pytest.raises(rio.Error, match="must not change the estimator"):
            fly(odometry, flight)
        assert odometry.counters()["scans"] == 1

    def fail(_):
        raise KeyError("mine")

    odometry.on_scan(fail)
    with pytest.raises(KeyError, match="mine"):
        fly(odometry, flight)
    with pytest.raises(TypeError, match="a function of the estimator"):
        odometry.on_scan(3)
    other = rio.Odometry()
    odometry.reset()
    odometry.on_scan(lambda _: other.add_imu(odometry.now().time, [0, 0, 0], [0, 0, 9.81]))
    fly(odometry, flight)
    assert other.counters()["imu_samples"] > 50


def test_other_threads_wait_while_a_call_looks(flight):
    """Each of two estimators in a thread of its own, one with its sensors in two threads."""
    estimators = [rio.Odometry(sensors=flight) for _ in range(2)]
    scans = scans_of(flight)
    for odometry in estimators:
        fly(odometry, flight, until=scans[60][0])
    added, refused = [], []

    def look(odometry):
        time.sleep(0.002)  # others run
        for other in (lambda: odometry.add_scan(0, []), lambda: odometry.reset()):
            with pytest.raises(rio.Error, match="must not change"):
                other()
        refused.append(odometry)

    def add_imu():
        for _ in range(100):
            added.append(estimators[0].add_imu(scans[0][0], [0, 0, 0], [0, 0, 9.81]))
            time.sleep(0.0005)

    def add_scans(odometry):
        for number, points in scans[60:80]:
            odometry.add_scan(number, points)
            odometry.add_imu(number + 10**8, [0, 0, 0], [0, 0, 9.81])

    for odometry in estimators:
        odometry.on_scan(look)
    threads = [threading.Thread(target=add_imu)] + [threading.Thread(target=add_scans, args=(o,)) for o in estimators]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert added == 100 * [rio.Status.STALE] and set(refused) == set(estimators)


def test_a_time_is_a_whole_number():
    odometry = rio.Odometry()
    for time_ in (np.int64(3), np.array(4)):
        odometry.add_imu(time_, [0, 0, 0], [0, 0, 9.81])
    for time_ in (2.5, np.array(2.5), Decimal("2.5"), "2"):
        with pytest.raises(TypeError):
            odometry.add_imu(time_, [0, 0, 0], [0, 0, 9.81])
    assert odometry.counters()["imu_samples"] == 2
    with pytest.raises(ValueError, match="unknown field"):
        odometry.add_scan(1, np.zeros(0, [("x", "f8"), ("y", "f8"), ("z", "f8"), ("speed", "f8")]))


def test_an_estimator_in_its_own_call_is_collected():
    odometry = rio.Odometry()
    odometry.on_scan(lambda _: odometry)
    gone = weakref.ref(odometry)
    del odometry
    gc.collect()
    assert gone() is None


def test_after_a_reset_it_is_as_new(flight):
    odometry = rio.Odometry(sensors=flight)
    ends = []
    for _ in range(2):
        fly(odometry, flight)
        ends.append((odometry.at_scan().position, odometry.covariance(), odometry.counters()))
        assert odometry.reset() == rio.Status.OK
        assert not odometry.initialized() and odometry.counters()["scans"] == 0
    assert np.array_equal(ends[0][0], ends[1][0]) and np.array_equal(ends[0][1], ends[1][1])
    assert ends[0][2] == ends[1][2]
    for arguments in ((rio.State(0, [0, 0, 0], [1, 0, 0, 0], [0, 0, 0]),), (None, np.eye(15))):
        with pytest.raises(TypeError, match="or neither"):
            odometry.reset(*arguments)


def edited(flight, folder, imu, radar):
    """The recording without its truth; imu, radar: new time of a row [s] from its time, None: left out."""
    for sensor, change in (("imu0", imu), ("radar0", radar)):
        (folder / sensor).mkdir(parents=True)
        (folder / sensor / "sensor.yaml").write_text((flight / sensor / "sensor.yaml").read_text())
        head, *lines = (flight / sensor / "data.csv").read_text().splitlines()
        with open(folder / sensor / "data.csv", "w", encoding="ascii") as file:
            print(head, file=file)
            for time, rest in (line.split(",", 1) for line in lines):
                since = int(time) - BEGIN
                if (to := change(since / 1e9)) is not None:
                    print(BEGIN + since + round((to - since / 1e9) * 1e9), rest, sep=",", file=file)
    return folder


def test_a_clock_that_goes_back_is_no_matter(flight, tmp_path):
    """As `rio replay`, which looks for it, does."""
    def back(t):
        return t if t < 15.0 else t - 8.0

    result, whole = rio.replay(edited(flight, tmp_path, back, back)), rio.replay(flight, init="static")
    assert np.array_equal(result.positions, whole.positions)
    assert any("taken out" in note for note in result.notes)


def test_after_a_pause_of_the_imu_a_replay_is_the_flight(flight, tmp_path):
    paused = edited(flight, tmp_path, lambda t: t if t < 10.0 or t > 10.7 else None, lambda t: t)
    replayed = rio.replay(paused)
    odometry = rio.Odometry(sensors=paused)
    positions = []
    odometry.on_scan(lambda o: positions.append(o.at_scan().position))
    fly(odometry, paused)
    assert odometry.counters()["imu_gaps"] == 1
    assert np.array_equal(positions, replayed.positions)


def test_what_is_masked_is_not_used():
    odometry = rio.Odometry()
    gravity, masked = [0, 0, 9.81], np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0])
    assert odometry.add_imu(0, masked, gravity) == rio.Status.NON_FINITE
    assert odometry.add_imu(0, [0, 0, 0], masked) == rio.Status.NON_FINITE
    assert odometry.add_imu(0, np.ma.array([0, 0, 1e-3]), gravity) == rio.Status.OK
    with pytest.raises(ValueError, match="position"):
        odometry.add_position(0, masked, np.eye(3))
    with pytest.raises(ValueError, match="covariance"):
        odometry.add_position(0, [0, 0, 0], np.ma.array(np.eye(3), mask=np.eye(3)))
    state = rio.State(0, masked, [1, 0, 0, 0], [0, 0, 0])
    assert odometry.reset(state, np.eye(15)) == rio.Status.NON_FINITE


def test_a_radar_that_is_not_declared_has_no_mounting():
    odometry = rio.Odometry()
    assert np.all(odometry.extrinsics(0).translation == 0)
    with pytest.raises(IndexError):
        odometry.extrinsics(1)
