# SPDX-License-Identifier: BSD-3-Clause
"""Options, evaluate, check and simulate, against the program; the stubs against the package."""
import ast
import filecmp
import importlib.util
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import rio


def test_options_of_dict_text_and_key_are_the_same(tmp_path):
    file = tmp_path / "options.yaml"
    file.write_text("radar:\n  sigma_doppler: 5 cm/s\n")
    by_key = rio.Options()
    by_key["radar.sigma_doppler"] = 0.05
    for options in (rio.Options({"radar": {"sigma_doppler": np.float64(0.05)}}),
                    rio.Options.from_file(file), rio.Options.from_yaml(by_key.yaml()), by_key):
        assert options["radar.sigma_doppler"] == 0.05
        assert options == by_key
    assert by_key != rio.Options()
    assert repr(by_key) == "rio.Options({'radar.sigma_doppler': 0.05})"


def test_presets_are_those_of_the_program(program):
    for preset in ("default", "published-smoother"):
        options = rio.Options.from_yaml(f"preset: {preset}")
        assert options == rio.Options(preset=preset)
        assert options == rio.Options.from_yaml(program("options", "--preset", preset))
    assert rio.Options(preset="published-ekf") != rio.Options()
    with pytest.raises(rio.Error, match="no such preset"):
        rio.Options(preset="nonsense")


def test_a_wrong_option_is_named(tmp_path):
    with pytest.raises(rio.Error, match='did you mean "radar.sigma_doppler"'):
        rio.Options({"radar": {"sigma_dopler": 1}})
    options = rio.Options()
    with pytest.raises(rio.Error, match="radar.max_range"):
        options["radar.max_range"] = -1
    assert options == rio.Options()
    file = tmp_path / "bad.yaml"
    file.write_text("radar:\n  max_range: 3 kg\n")
    with pytest.raises(rio.Error, match="bad.yaml:2: "):
        rio.Options.from_file(file)
    assert rio.Options.meanings()["radar.max_range"][0] == "m"


def test_options_of_a_recording_are_what_flies(flight, program):
    flown = rio.options_of(flight, {"update": {"max_landmarks": 7}})
    assert flown["update.max_landmarks"] == 7
    assert flown["radar.T_BS.translation"] != rio.Options()["radar.T_BS.translation"]
    assert rio.options_of(flight).yaml() == program("options", "--from", flight)
    assert np.array_equal(rio.replay(flight, flown).positions,
                          rio.replay(flight, {"update": {"max_landmarks": 7}}).positions)


def test_evaluate_equals_the_program(flight, program, tmp_path):
    result = rio.replay(flight)
    result.write_tum(tmp_path / "own.tum")
    printed = json.loads(program("evaluate", flight, tmp_path / "own.tum", "--align", "yaw", "--json"))
    assert rio.evaluate(flight, tmp_path / "own.tum", align="yaw") == printed
    # without the rounding of the file
    figures = rio.evaluate(flight, result, align="yaw")
    assert figures["norm_of_rmse_m"] == pytest.approx(printed["norm_of_rmse_m"], abs=1e-8)
    with pytest.raises(rio.Error, match="do not overlap in time"):
        rio.evaluate(rio.Path(result.times + 10**12, result.positions, result.orientations), result)


def test_check_equals_the_program(flight, program):
    printed = json.loads(program("check", flight, "--json"))
    found = rio.check(flight)
    assert [f._asdict() for f in found.findings] == printed["findings"]
    assert (found.verdict, found.options) == (printed["verdict"], printed["options"])
    turned = rio.check(flight, {"radar": {"T_BS": {"quaternion_wxyz": [0, 0, 0, 1]}}})
    assert turned.verdict == "wrong"


def test_simulate_equals_the_program(flight, tmp_path):
    folder = rio.simulate(tmp_path / "own", seed=3, length=20)
    for name in ("imu0/data.csv", "radar0/data.csv", "radar0/sensor.yaml", "state_groundtruth_estimate0/data.csv"):
        assert filecmp.cmp(f"{folder}/{name}", flight / name, shallow=False), name


def declared(body):
    """Names of functions, classes and values in the body of a stub, without those of the language."""
    names = set()
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            names.add(node.target.id)
    return {name for name in names if not name.startswith("__")}


def test_stubs_declare_what_is_there():
    stub = ast.parse((pathlib.Path(rio.__file__).parent / "_rio.pyi").read_text())
    assert declared(stub.body) == {name for name in vars(rio._rio) if not name.startswith("__")}
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and node.name not in ("Error", "Status"):
            there = {name for name in vars(getattr(rio._rio, node.name)) if not name.startswith("_")}
            assert declared(node.body) == there, node.name


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="needs the package mypy")
def test_package_and_examples_are_typed(tmp_path):
    examples = sorted(pathlib.Path(os.environ["RIO_PYTHON_EXAMPLES"]).glob("*.py"))
    package = pathlib.Path(rio.__file__).parent
    run = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", tmp_path, "--ignore-missing-imports",
                          "--no-site-packages", "--follow-imports=silent", package, *examples],
                         capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
