# SPDX-License-Identifier: BSD-3-Clause
"""rio.replay against `rio replay`, to the bit."""
import _thread
import gc
import json
import threading
import time
import types
import warnings

import numpy as np
import pytest

import rio

# position, attitude, velocity of the states file, in the order of the 15 errors
OF_STATES = [3, 4, 5, 0, 1, 2, 6, 7, 8]
MEASURED_TIME = ("update_ms", "propagation_ms", "realtime_factor")


def states_of(file):
    """times, numbers of a states file; float() rounds correctly, as the file is written."""
    lines = [line.split(",") for line in file.read_text().splitlines() if line[0] not in "#t"]
    return np.array([int(line[0]) for line in lines]), np.array([[float(v) for v in line[1:]] for line in lines])


def without_time(summary):
    return {key: value for key, value in summary.items() if key not in MEASURED_TIME}


@pytest.mark.parametrize("values", [{}, {"backend": "smoother", "radar": {"sigma_doppler": 0.07}}])
def test_equals_the_program_to_the_bit(flight, program, tmp_path, values):
    config = tmp_path / "options.yaml"
    config.write_text(json.dumps(values))
    printed = program("replay", flight, "--config", config, "--states", tmp_path / "states.csv",
                      "--out", tmp_path / "out.tum", "--json")
    times, numbers = states_of(tmp_path / "states.csv")
    result = rio.replay(flight, values, check=True)

    assert len(times) > 50
    assert np.array_equal(result.times, times)
    assert np.array_equal(result.positions, numbers[:, 0:3])
    assert np.array_equal(result.orientations, numbers[:, 3:7])
    assert np.array_equal(result.velocities, numbers[:, 7:10])
    assert np.array_equal(result.gyro_biases, numbers[:, 55:58])
    assert np.array_equal(result.accel_biases, numbers[:, 58:61])
    rows, columns = np.triu_indices(9)
    of_states = result.covariances[:, OF_STATES][:, :, OF_STATES]
    assert np.array_equal(of_states[:, rows, columns], numbers[:, 10:55])
    assert without_time(result.summary) == without_time(json.loads(printed.splitlines()[-1]))
    result.write_tum(tmp_path / "own.tum")
    assert (tmp_path / "own.tum").read_bytes() == (tmp_path / "out.tum").read_bytes()


def test_options_win_over_the_sensor_files(flight):
    told = rio.replay(flight, {"radar": {"sigma_doppler": "40 cm/s"}})
    assert any("radar.sigma_doppler" in note for note in told.notes)
    assert not np.array_equal(told.positions, rio.replay(flight).positions)


def test_arrays_own_their_memory(flight):
    positions = rio.replay(flight).positions
    before = positions.copy()
    gc.collect()
    assert not positions.flags.owndata and type(positions.base).__name__ == "PyCapsule"
    assert np.array_equal(positions, before)


def test_innovations_are_those_of_the_summary(flight):
    result = rio.replay(flight)
    used = result.innovations[result.innovations["result"] == 0]
    for index, name in enumerate(rio.MODELS):
        rows = used["dof"][used["model"] == index].sum()
        assert rows == result.summary["models"][name]["rows_used"], name
    assert result.summary["models"]["doppler"]["rows_used"] > 100


def test_scans_landmarks_and_events(flight):
    result = rio.replay(flight)
    assert len(result.scans) == result.summary["scans"]
    assert (result.scans["static_detections"] <= result.scans["detections_kept"]).all()
    landmarks = result.landmarks
    assert landmarks["landmarks"][-1] == result.summary["landmarks"]
    assert landmarks["landmarks_added"].sum() - landmarks["landmarks_removed"].sum() == landmarks["landmarks"][-1]
    states = result.landmark_states
    assert len(states) == result.scans["landmarks"].sum()
    assert states["position"].shape[1:] == (3,) and states["covariance"].shape[1:] == (3, 3)
    assert (np.linalg.eigvalsh(states["covariance"]) > 0).all()
    assert (states["last_seen"] <= states["time"] + 10**8).all()  # of the estimate, not the stamp
    assert result.events[0].what == "first scan"
    assert "health: ok" in [event.what for event in result.events]
    assert all(result.times[0] <= event.time + 10**9 for event in result.events)


def test_other_threads_run_during_a_replay(flight):
    thread = threading.Thread(target=rio.replay, args=(flight,))
    counted = 0
    thread.start()
    while thread.is_alive():
        counted += 1
    assert counted > 10000  # a handful if the replay kept the interpreter


def test_a_signal_ends_a_replay(flight):
    smoother = {"backend": "smoother"}
    start = time.process_time()
    rio.replay(flight, smoother)
    whole = time.process_time() - start
    threading.Timer(0.05, _thread.interrupt_main).start()
    start = time.process_time()
    with pytest.raises(KeyboardInterrupt):
        rio.replay(flight, smoother)
    assert time.process_time() - start < 0.7 * whole


def test_sensor_files_without_a_mounting_are_told(flight, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rio.Odometry(sensors=flight)
    with pytest.warns(UserWarning, match="radar0/sensor.yaml missing: radar pose from the options"):
        rio.Odometry(sensors=tmp_path)


def rows_of(file):
    """(time, numbers) of each row; that of a scan without points has no numbers."""
    for line in file.read_text().splitlines()[1:]:
        time, *cells = line.split(",")
        yield int(time), np.array([float(cell) for cell in cells if cell])


def scans_of(flight):
    """(time, N x 6) of each scan."""
    scans = {}
    for time, point in rows_of(flight / "radar0/data.csv"):
        scans.setdefault(time, []).extend([point] if len(point) else [])
    return [(time, np.array(points)) for time, points in scans.items()]


def test_points_as_records(flight):
    time, points = max(scans_of(flight), key=lambda scan: len(scan[1]))
    names = ["x", "y", "z", "doppler", "snr", "noise"]
    records = np.zeros(len(points), dtype=[(name, "f8") for name in reversed(names)])
    for index, name in enumerate(names):
        records[name] = points[:, index]
    frame = types.SimpleNamespace(to_records=lambda index: records)  # as of pandas
    masked = np.ma.masked_array(np.vstack([points, points]))
    masked[len(points):, 3] = np.ma.masked
    masked_records = np.ma.append(records, records)
    masked_records["doppler"][len(points):] = np.ma.masked
    states = []
    for given in (points, records, points.tolist(), np.asfortranarray(points), frame, masked, masked_records):
        odometry = rio.Odometry(sensors=flight)
        start = rio.State(time - 10**7, [1, 2, 3], [1, 0, 0, 0], [0, 0, 0])
        assert odometry.reset(start, np.eye(15) * 0.01) == rio.Status.OK
        odometry.add_imu(time - 10**7, [0, 0, 0], [0, 0, 9.81])
        odometry.add_imu(time, [0, 0, 0], [0, 0, 9.81])
        assert odometry.add_scan(time, given) == rio.Status.OK
        states.append((odometry.at_scan().position, odometry.at_scan().velocity, odometry.covariance()))
    assert all(np.array_equal(a, b) for a, *others in zip(*states) for b in others)
    assert not np.array_equal(states[0][1], [0, 0, 0])


def test_masked_records_may_have_whole_numbers():
    types_of = [(name, "f8") for name in ("x", "y", "z", "doppler")] + [("snr", "i4")]
    records = np.ma.array(np.zeros(5, dtype=types_of))
    records["x"] = 3.0 + np.arange(5)
    records["snr"][4] = np.ma.masked
    odometry = rio.Odometry()
    assert odometry.reset(rio.State(0, [0, 0, 0], [1, 0, 0, 0], [0, 0, 0]), np.eye(15) * 0.01) == rio.Status.OK
    for time in (0, 10**7):
        odometry.add_imu(time, [0, 0, 0], [0, 0, 9.81])
    assert odometry.add_scan(10**7, records) == rio.Status.OK
    assert len(odometry.points()) == 4


def test_wrong_points_are_named():
    odometry = rio.Odometry()
    with pytest.raises(ValueError, match="N x 4 to N x 10"):
        odometry.add_scan(0, np.zeros((5, 3)))
    with pytest.raises(ValueError, match='no field "doppler"'):
        odometry.add_scan(0, np.zeros(5, dtype=[("x", "f8"), ("y", "f8"), ("z", "f8")]))
    with pytest.raises(ValueError, match='unknown field "rdot"'):
        odometry.add_scan(0, np.zeros(5, dtype=[("x", "f8"), ("rdot", "f8")]))
    with pytest.raises(ValueError, match="could not convert string"):
        odometry.add_scan(0, [["a", "b", "c", "d"]])
    with pytest.raises(TypeError):
        odometry.add_imu(0.5, [0, 0, 0], [0, 0, 9.81])  # seconds
    for empty in (np.zeros((0, 4)), []):
        assert odometry.add_scan(0, empty) == rio.Status.NOT_INITIALIZED


def test_what_is_not_there_is_an_error(tmp_path):
    with pytest.raises(rio.Error, match="nothing"):
        rio.replay(tmp_path / "nothing")
