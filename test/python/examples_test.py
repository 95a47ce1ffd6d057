# SPDX-License-Identifier: BSD-3-Clause
"""The examples, as a user runs them; the sweep also on two workers of a Dask scheduler."""
import importlib.util
import os
import subprocess
import sys

import pytest

import rio

EXAMPLES = os.environ["RIO_PYTHON_EXAMPLES"]


def run(name, *arguments):
    return subprocess.run([sys.executable, f"{EXAMPLES}/{name}", *map(str, arguments)], check=True,
                          text=True, capture_output=True)


def needs(module):
    return pytest.mark.skipif(importlib.util.find_spec(module) is None, reason=f"needs python3-{module}")


@needs("matplotlib")
def test_plot_a_flight(flight, tmp_path):
    output = run("plot_flight.py", flight, tmp_path / "flight.png").stdout
    assert "healthy" in output
    assert (tmp_path / "flight.png").stat().st_size > 20000


def test_compare_with_another_estimator(flight, tmp_path):
    rio.replay(flight, preset_of("published-ekf")).write_tum(tmp_path / "other.tum")
    rows = run("compare.py", flight, tmp_path / "other.tum").stdout.splitlines()
    assert [row.split("|")[1].strip() for row in rows[2:]] == ["rio", "other.tum"]
    own, other = (float(row.split("|")[2]) for row in rows[2:])
    assert 0 < own < 0.2 and 0 < other < 2 and own != other


def preset_of(name):
    return rio.Options(preset=name)


SWEEP = ("radar.sigma_doppler", "0.02", "0.5", "--seeds", 2, "--length", 20)


@pytest.fixture(scope="module")
def swept(flight):
    return run("sweep.py", *SWEEP, "--recordings", flight)


def test_sweep_an_option(swept):
    rows = swept.stdout.splitlines()[2:]
    assert [row.split("|")[1].strip() for row in rows] == ["0.02", "0.5"]
    assert rows[0].split("|")[2] != rows[1].split("|")[2]
    assert "0 of 3" in rows[0]
    assert "6/6" in swept.stderr


@needs("distributed")
def test_sweep_on_two_workers(swept, flight):
    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            assert len(client.scheduler_info()["workers"]) == 2
        remote = run("sweep.py", *SWEEP, "--recordings", flight, "--dask", cluster.scheduler_address)
    assert remote.stdout == swept.stdout
