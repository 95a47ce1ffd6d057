# SPDX-License-Identifier: BSD-3-Clause
"""Options, evaluate, check and simulate, against the program; the stubs against the package."""
import ast
import copy
import filecmp
import importlib.util
import json
import os
import pathlib
import pickle
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
    assert "radar.sigma_doppler" in by_key and "radar.sigma_dopler" not in by_key


def test_presets_are_those_of_the_program(program):
    for preset in ("default", "published-smoother"):
        options = rio.Options.from_yaml(f"preset: {preset}")
        assert options == rio.Options(preset=preset)
        assert options == rio.Options.from_yaml(program("options", "--preset", preset))
    published = rio.Options(preset="published-ekf")
    assert published != rio.Options() and published["preset"] == "published-ekf"
    same_values = rio.Options({key: published[key] for key in published if key != "preset"})
    assert same_values != published and same_values["preset"] == "default"
    for twin in (rio.Options(published.as_dict()), rio.Options.from_yaml(published.yaml())):
        assert twin == published
    with pytest.raises(rio.Error, match="no such preset"):
        rio.Options(preset="nonsense")


def test_a_wrong_option_is_named(tmp_path):
    with pytest.raises(rio.Error, match='did you mean "radar.sigma_doppler"'):
        rio.Options({"radar": {"sigma_dopler": 1}})
    for file in ("my.yaml", tmp_path):
        with pytest.raises(TypeError, match="a dict is expected; of a file: rio.Options.from_file"):
            rio.replay(tmp_path, file)
    with pytest.raises(TypeError, match="{1, 2}: a number, text, list or dict is expected"):
        rio.Options({"radar": {"T_BS": {"translation": {1, 2}}}})
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
    for values in ({"update": {"max_landmarks": 7}}, rio.Options(preset="published-ekf")):
        assert np.array_equal(rio.replay(flight, rio.options_of(flight, values)).positions,
                              rio.replay(flight, values).positions)


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


def test_evaluate_takes_positions_alone(flight, program, tmp_path):
    rio.replay(flight).write_tum(tmp_path / "own.tum")
    truth = tmp_path / "prism.txt"
    poses = rio.read_path(flight)
    truth.write_text("".join(f"{t / 1e9:.9f} {x} {y} {z}\n"
                             for t, (x, y, z) in zip(poses.times, poses.positions)))
    printed = json.loads(program("evaluate", truth, tmp_path / "own.tum", "--json"))
    assert rio.evaluate(truth, tmp_path / "own.tum") == printed
    assert rio.evaluate(rio.read_path(truth, truth=True), tmp_path / "own.tum")["ape"] == printed["ape"]
    assert printed["ape"]["none"]["rotation_deg"]["rmse"] is None
    assert printed["tilt_error_deg"]["rmse"] is None
    assert printed["norm_of_rmse_m"] < 1.0


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


def test_wrong_arguments_are_named(flight, tmp_path):
    result = rio.replay(flight)
    path = result.path
    for bad, why in ((path._replace(positions=path.positions * np.nan), "pose 0 is not finite"),
                     (path._replace(positions=np.ma.masked_less(path.positions, 9e9)), "pose 0 is not finite"),
                     (path._replace(orientations=path.orientations * 0), "pose 0 .* no rotation"),
                     (path._replace(orientations=path.orientations * np.nan), "only a truth"),
                     (path._replace(positions=path.positions[:, :2]), "positions .N x 3")):
        with pytest.raises(ValueError, match=why):
            rio.evaluate(flight, bad)
    with pytest.raises(TypeError, match="nanoseconds"):
        rio.evaluate(flight, path._replace(times=path.times * 1e-9))
    with pytest.raises(ValueError, match="none, origin, yaw or se3 .* not sim3"):
        rio.evaluate(flight, result, align="sim3")
    with pytest.raises(ValueError, match="max_diff"):
        rio.evaluate(flight, result, max_diff=float("nan"))
    for wrong in ({"length": -1.0}, {"length": float("nan")}, {"radars": 0}, {"radars": 5}):
        with pytest.raises(ValueError, match=f"{next(iter(wrong))}: "):
            rio.simulate(tmp_path / "none", **wrong)
    assert not (tmp_path / "none").exists()


def test_results_are_copied_pickled_and_shown(flight):
    state = rio.State(7, [1, 2, 3], [0, 1, 0, 0], [4, 5, 6], [7, 8, 9], [10, 11, 12])
    for twin in (copy.deepcopy(state), pickle.loads(pickle.dumps(state))):
        for name in ("time", "position", "orientation", "velocity", "gyro_bias", "accel_bias"):
            assert np.array_equal(getattr(twin, name), getattr(state, name)), name
    assert repr(state).startswith("<rio.State: time 7, position [1. 2. 3.], velocity [4. 5. 6.]")
    odometry = rio.Odometry()
    assert repr(odometry.health()).startswith("<rio.Health: initialising, quality ")
    for twin in (copy.copy(odometry.health()), pickle.loads(pickle.dumps(odometry.health()))):
        assert twin == odometry.health() and twin.severity["radar silent"] == 0.0
    report = odometry.report()
    for copied in (copy.deepcopy(report), pickle.loads(pickle.dumps(report))):
        assert (copied.status, copied.health, copied.models) == (rio.Status.OK, report.health, report.models)
        assert copied.innovations.dtype == report.innovations.dtype
    result = rio.replay(flight)
    twin = pickle.loads(pickle.dumps(result))
    assert twin != result and {result: "a key"}[result]  # arrays have no single truth value
    assert np.array_equal(twin.positions, result.positions) and twin.summary == result.summary


def declared(body):
    """What the body of a stub declares by name, without what is of the language."""
    nodes = {node.target.id if isinstance(node, ast.AnnAssign) else node.name: node for node in body
             if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.AnnAssign))}
    return {name: node for name, node in nodes.items() if name == "__init__" or not name.startswith("__")}


def signature(function):
    """Names of the arguments, how many of them have a default, and what is returned; of the last
    only what is plain, as the compiled part and the stubs write types of numpy in different ways."""
    arguments, returned = function.args, ast.unparse(function.returns).replace("rio._rio.", "")
    plain = returned if returned in ("None", "bool", "str", "Status", "State", "Report", "Health") else ""
    return [a.arg for a in arguments.args], len(arguments.defaults), plain


def test_stubs_declare_what_is_there():
    stub = declared(ast.parse((pathlib.Path(rio.__file__).parent / "_rio.pyi").read_text()).body)
    assert set(stub) == {name for name in vars(rio._rio) if not name.startswith("__")}
    functions = [(getattr(rio._rio, n), node) for n, node in stub.items() if isinstance(node, ast.FunctionDef)]
    for name, node in stub.items():
        if not isinstance(node, ast.ClassDef) or name == "Error":
            continue
        there = vars(getattr(rio._rio, name))
        members = declared(node.body)
        assert set(members) - {"__init__"} == {n for n in there if not n.startswith("_")}, name
        for member, declaration in members.items():
            is_property = "property" in [ast.unparse(d) for d in getattr(declaration, "decorator_list", [])]
            assert is_property == isinstance(there[member], property), member
            if isinstance(declaration, ast.FunctionDef) and not is_property:
                functions.append((getattr(getattr(rio._rio, name), member), declaration))
    for function, declaration in functions:
        there = ast.parse(f"def {function.__doc__.splitlines()[0]}: ...").body[0]
        assert signature(there) == signature(declaration), declaration.name


def test_pip_builds_for_the_python_it_belongs_to(tmp_path):
    pytest.importorskip("setuptools")
    cmake = tmp_path / "cmake"
    cmake.write_text(f'#!/bin/sh\nprintf "%s\\n" "$@" > {tmp_path}/arguments\nexit 1\n')
    cmake.chmod(0o755)
    subprocess.run([sys.executable, "setup.py", "build_ext", "--build-temp", tmp_path, "--build-lib", tmp_path],
                   cwd=pathlib.Path(os.environ["RIO_PYTHON_EXAMPLES"]).parent, capture_output=True,
                   env=dict(os.environ, PATH=f"{tmp_path}:{os.environ['PATH']}"))
    assert f"-DPython3_EXECUTABLE={sys.executable}" in (tmp_path / "arguments").read_text().splitlines()


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="needs the package mypy")
def test_package_and_examples_are_typed(tmp_path):
    examples = sorted(pathlib.Path(os.environ["RIO_PYTHON_EXAMPLES"]).glob("*.py"))
    package = pathlib.Path(rio.__file__).parent
    run = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", tmp_path, "--ignore-missing-imports",
                          "--no-site-packages", "--follow-imports=silent", package, *examples],
                         capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
