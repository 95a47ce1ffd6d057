# SPDX-License-Identifier: BSD-3-Clause
"""A simulated flight, and the `rio` program beside which the package is held."""
import os
import subprocess

import pytest


@pytest.fixture(scope="session")
def program():
    """Runs the program, which has to succeed; gives its output."""

    def run(*arguments):
        return subprocess.run([os.environ["RIO_TOOL"], *map(str, arguments)], check=True, text=True,
                              capture_output=True).stdout

    return run


@pytest.fixture(scope="session")
def flight(tmp_path_factory, program):
    folder = tmp_path_factory.mktemp("flight") / "flight"
    program("simulate", folder, "--length", 20, "--seed", 3)
    return folder
