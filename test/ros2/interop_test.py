# SPDX-License-Identifier: BSD-3-Clause
"""rio-ros2 (Cyclone DDS) against a publisher and subscriber on Fast DDS in another process, over loopback.

RIO_ROS2_SOAK=SECONDS makes the flight that long.
"""
import os
import random
import re
import signal
import subprocess
import time

import pytest

REFEREE = os.environ["RIO_ROS2_REFEREE"]
SOAK = float(os.environ.get("RIO_ROS2_SOAK", "0"))
SPEED = 1.0 if SOAK else 4.0
RADAR = ("-p", "radar_topics:=/radar0/points")


@pytest.fixture(scope="module")
def domain():
    """A domain of this test."""
    return dict(os.environ, ROS_DOMAIN_ID=str(100 + os.getpid() % 100))


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ros2") / "flight"
    length = SOAK * 0.9 if SOAK else 20.0
    subprocess.run([os.environ["RIO_TOOL"], "simulate", folder, "--length", str(length), "--seed", "5"],
                   check=True, capture_output=True)
    return folder


class Started:
    """A process in the background whose output goes to a file; killed at the end."""

    def __init__(self, output, *command, env):
        self.output = output
        with open(output, "w") as file:
            self.process = subprocess.Popen(list(map(str, command)), stdout=file, stderr=subprocess.STDOUT, env=env)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def text(self):
        """All of its lines that are complete."""
        text = self.output.read_text()
        return text[:text.rfind("\n") + 1]


def lines(output):
    """{first word: [[words], ...]}"""
    found = {}
    for line in output.splitlines():
        words = line.split()
        found.setdefault(words[0], []).append(words[1:])
    return found


@pytest.fixture(scope="module")
def played(domain, flight, tmp_path_factory):
    """What came back, what a subscriber that died and came back heard, and what the node said."""
    out = tmp_path_factory.mktemp("played")
    node = (os.environ["RIO_ROS2"], "--ros-args", "-p", f"sensors:={flight}", *RADAR)
    with Started(out / "rio", *node, env=domain) as rio:
        with Started(out / "player", REFEREE, "play", flight, SPEED, env=domain) as player:
            with Started(out / "first", REFEREE, "listen", 600, env=domain) as first:
                until(lambda: "odometry" in first.text())
            # killed without a word of farewell
            with Started(out / "second", REFEREE, "listen", 600, env=domain) as second:
                player.process.wait(timeout=2 * SOAK + 120)
        assert player.process.returncode == 0, player.text()
        rio.process.send_signal(signal.SIGINT)
        assert rio.process.wait(timeout=10) == 0, rio.text()
    print(rio.text())
    return lines(player.text()), lines(first.text()), lines(second.text()), rio.text()


def until(condition):
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


def replay_states(flight, file):
    """{stamp: position and orientation}"""
    subprocess.run([os.environ["RIO_TOOL"], "replay", flight, "--init", "static", "--states", file], check=True,
                   capture_output=True)
    rows = [line.split(",") for line in file.read_text().splitlines() if line[0].isdigit()]
    return {row[0]: [float(cell) for cell in row[1:8]] for row in rows}


def test_poses_are_those_of_a_replay_to_the_bit(domain, flight, tmp_path):
    environment = dict(domain, ROS_DOMAIN_ID=str(int(domain["ROS_DOMAIN_ID"]) - 100))
    node = (os.environ["RIO_ROS2"], "-p", f"sensors:={flight}", "-p", "reliable:=true", *RADAR)
    with Started(tmp_path / "rio", *node, env=environment) as rio:  # reliable: a busy machine loses no scan
        with Started(tmp_path / "player", REFEREE, "play", flight, SPEED, env=environment) as player:
            until(lambda: "pose" in player.text())
            rio.process.send_signal(signal.SIGSTOP)  # seconds of flight come in one go
            time.sleep(2.8 / SPEED)
            rio.process.send_signal(signal.SIGCONT)
            assert player.process.wait(timeout=2 * SOAK + 120) == 0, player.text()
    expected = replay_states(flight, tmp_path / "states.csv")
    poses = lines(player.text())["pose"]
    assert len(poses) > 0.9 * len(expected) > 100
    for pose in poses:  # which takes every sample and scan so far
        assert [float(word) for word in pose[1:8]] == expected[pose[0]]
        assert 0 < float(pose[8]) < 1


@pytest.fixture(scope="module")
def two_radars(tmp_path_factory):
    """A flight with two radars, and the lines of its replay."""
    folder = tmp_path_factory.mktemp("two_radars") / "flight"
    subprocess.run([os.environ["RIO_TOOL"], "simulate", folder, "--length", "20", "--seed", "5", "--radars", "2"],
                   check=True, capture_output=True)
    states = replay_states(folder, folder.parent / "states.csv")
    return folder, states


@pytest.mark.parametrize("number, radar_type", enumerate(("PointCloud2", "RadarScan")))
def test_every_scan_of_two_radars_has_its_pose(domain, two_radars, tmp_path, number, radar_type):
    flight, states = two_radars
    environment = dict(domain, ROS_DOMAIN_ID=str(int(domain["ROS_DOMAIN_ID"]) - 25 - 50 * number))
    node = (os.environ["RIO_ROS2"], "-p", f"sensors:={flight}", "-p", "reliable:=true", "-p",
            f"radar_type:={radar_type}", "-p", "radar_topics:=/radar0/points, /radar1/points")
    with Started(tmp_path / "rio", *node, env=environment) as rio:
        play = (REFEREE, "play", flight, SPEED, radar_type)
        with Started(tmp_path / "player", *play, env=environment) as player:
            assert player.process.wait(timeout=120) == 0, player.text()
        rio.process.send_signal(signal.SIGINT)
        assert rio.process.wait(timeout=10) == 0, rio.text()
    processed = int(re.search(r"; (\d+) processed", rio.text())[1])
    poses = lines(player.text())["pose"]
    assert len(poses) == processed > 400
    for pose in poses:  # a RadarScan has floats, so that time offset and estimate are a little different
        nearest = min(states, key=lambda stamp: abs(int(stamp) - int(pose[0])))
        assert [float(word) for word in pose[1:8]] == pytest.approx(states[nearest], abs=0.02)


def test_odometry_comes_at_the_rate_of_the_imu_with_frames_and_covariances(played):
    odometry = played[0]["odometry"]
    times = [int(line[0]) for line in odometry]
    assert times == sorted(times)
    steps = sorted(b - a for a, b in zip(times, times[1:]))
    assert 4e6 < steps[len(steps) // 2] < 1.1e7  # 100 to 250 Hz
    assert all(line[1:3] == ["odom", "imu"] for line in odometry)
    assert all(0 < float(line[9]) < 1 and 0 < float(line[10]) < 1 for line in odometry)
    speed = [sum(float(word) ** 2 for word in line[6:9]) ** 0.5 for line in odometry]
    assert max(speed) > 0.5


def test_transforms_repeat_the_odometry(played):
    odometry = {line[0]: line for line in played[0]["odometry"]}
    assert len(played[0]["tf"]) > 0.9 * len(odometry)
    for time_, parent, child, x in played[0]["tf"]:
        assert (parent, child) == ("odom", "imu")
        if time_ in odometry:
            assert x == odometry[time_][3]


def test_points_are_labelled(played):
    points = played[0]["points"]
    assert all(line[1] == "radar" for line in points)
    left_out, static, landmarks = (sum(int(line[i]) for line in points) for i in (2, 3, 4))
    assert static > left_out > 0 and landmarks > 0


def test_health_is_a_diagnostic(played):
    diagnostics = played[0]["diagnostics"]
    assert len(diagnostics) >= 3
    assert diagnostics[-1][:2] == ["0", "ok"]
    assert diagnostics[-1][-1] == "10"


def test_a_subscriber_that_died_comes_back(played):
    _, first, second, _ = played
    assert len(second["odometry"]) > 20
    assert int(first["odometry"][-1][0]) < int(second["odometry"][-1][0])


def test_nothing_was_left_out(played):
    assert "0 messages left out; ok" in played[3]


def test_heights_of_a_barometer_are_over_the_start_of_a_reset(domain, tmp_path):
    """A vehicle stands, is carried 50 m higher while nobody looks, and stands again."""
    noise = random.Random(1).gauss
    files = {name: ["#"] for name in ("imu0", "radar0", "baro0")}
    for k in range(12 * 200):
        time_ = 5_000_000 * k
        files["imu0"].append(f"{time_}," + ",".join(str(noise(mean, sigma)) for mean, sigma in 3 * [(0, 1e-3)] +
                                                    [(0, 0.02), (0, 0.02), (9.81, 0.02)]))
        if k % 20 == 0:
            files["baro0"].append(f"{time_},{0 if k == 1000 else 100_000 - 600 * (k > 1000) + noise(0, 2)}")
            snr = -1 if k == 1500 else 20  # and one cloud has no Doppler
            files["radar0"] += [f"{time_},{noise(3, 0.02)},{0.2 * i},{0.1 * (i % 3)},{noise(0, 0.02)},{snr},0"
                                for i in range(-6, 7)]
    for name, rows in files.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "data.csv").write_text("\n".join(rows) + "\n")
    environment = dict(domain, ROS_DOMAIN_ID=str(int(domain["ROS_DOMAIN_ID"]) - 50))
    node = (os.environ["RIO_ROS2"], "-p", "pressure_topic:=/pressure", "-p", "reliable:=true", *RADAR)
    with Started(tmp_path / "rio", *node, env=environment) as rio:
        with Started(tmp_path / "player", REFEREE, "play", tmp_path, 2.0, env=environment) as player:
            assert player.process.wait(timeout=60) == 0, player.text()
        rio.process.send_signal(signal.SIGINT)
        assert rio.process.wait(timeout=10) == 0, rio.text()
    assert "reset: starts anew" in rio.text()
    assert "/radar0/points: a message is left out: " in rio.text() and ", 1 messages left out; ok" in rio.text()
    assert [words[1:-1] for words in lines(player.text())["diagnostics"]][-1] == ["ok"]
    assert "no `sensors`: mounting and noise by the options" in rio.text()


def test_topics_on_which_nothing_comes_are_told(domain, tmp_path):
    node = (os.environ["RIO_ROS2"], "-p", f"sensors:={tmp_path}", "-p", "use_sim_time:=true", "-p", "imu_topic:=/none")
    with Started(tmp_path / "rio", *node, env=domain) as rio:
        until(lambda: "rio-ros2: nothing came on /radar/points: topic name" in rio.text())
    assert "rio-ros2: nothing came on /none: topic name, ROS_DOMAIN_ID, QoS?" in rio.text()
    assert "radar0/sensor.yaml missing: radar pose from the options" in rio.text()


def test_a_wrong_parameter_is_named(tmp_path, domain):
    file = tmp_path / "rio.yaml"
    file.write_text("/rio:\n  ros__parameters:\n    imu_topik: /imu\n")
    run = subprocess.run([os.environ["RIO_ROS2"], "--params-file", file], text=True, capture_output=True,
                         env=domain)
    assert run.returncode == 1
    assert "rio.yaml:3" in run.stderr and 'did you mean "imu_topic"' in run.stderr
    printed = subprocess.run([os.environ["RIO_ROS2"], "-p", "odometry_rate:=50", "--print-params"], text=True,
                             capture_output=True, check=True).stdout
    file.write_text(printed)
    again = subprocess.run([os.environ["RIO_ROS2"], "--params-file", file, "--print-params"], text=True,
                           capture_output=True, check=True).stdout
    assert again == printed and "odometry_rate: 50" in printed


def test_it_takes_what_a_launch_file_passes(tmp_path):
    def run(*arguments):
        return subprocess.run([os.environ["RIO_ROS2"], *arguments, "--print-params"], text=True, capture_output=True)

    file = tmp_path / "launch_params"
    file.write_text("/front/odometry:\n  ros__parameters:\n    odometry_rate: 50\n")
    launched = ("--ros-args", "-r", "__node:=odometry", "-r", "__ns:=/front", "--params-file", file)
    renamed = run(*launched, "-r", "/imu/data:=/mavros/imu").stdout
    assert "odometry_rate: 50" in renamed and 'imu_topic: "/mavros/imu"' in renamed
    assert "no topic /imu" in run("-r", "/imu:=/mavros/imu").stderr
    file.write_text("/**:\n  ros__parameters: {odometry_rate: 50, of_others: 1, qos_overrides: {}}\n"
                    "front:\n  odometry:\n    ros__parameters: {radar_topics: [/left, /right]}\n")
    shared = run(*launched, "--log-level", "info")
    assert "odometry_rate: 50" in shared.stdout and 'radar_topics: "/left,/right"' in shared.stdout
    assert 'launch_params:2: "of_others" is no parameter of this node' in shared.stderr
    for wrong, why in (("radar_topics:=/imu/data", "/imu/data: two topics have this name"),
                       ("points:=nope", 'no such preset of points: "nope"')):
        told = subprocess.run([os.environ["RIO_ROS2"], "-p", wrong], text=True, capture_output=True, timeout=20)
        assert told.returncode == 1 and why in told.stderr
    for wrong in ("abc", "-1", "5x", "233"):
        told = subprocess.run([os.environ["RIO_ROS2"]], text=True, capture_output=True, timeout=20,
                              env=dict(os.environ, ROS_DOMAIN_ID=wrong))
        assert told.returncode == 1 and "a number from 0 to 232" in told.stderr
