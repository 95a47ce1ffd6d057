#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a flight: path, height with its sigma, velocity, innovations.

    plot_flight.py RECORDING OUT.png        (needs matplotlib: python3-matplotlib)
"""
import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import rio

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("recording", help="folder in ASL/EuRoC layout, or a bag")
parser.add_argument("out", help="picture to write: .png, .svg or .pdf")
parser.add_argument("--config", help="option file")
arguments = parser.parse_args()

options = rio.Options.from_file(arguments.config) if arguments.config else None
flight = rio.replay(arguments.recording, options)
seconds = (flight.times - flight.times[0]) * 1e-9

figure, ((path, height), (velocity, nis)) = plt.subplots(2, 2, figsize=(11, 8))
figure.suptitle(flight.verdict)

path.plot(flight.positions[:, 0], flight.positions[:, 1])
path.set(xlabel="x [m]", ylabel="y [m]", aspect="equal")

z = flight.positions[:, 2]
sigma = np.sqrt(flight.covariances[:, 5, 5])  # of the position along z
height.plot(seconds, z)
height.fill_between(seconds, z - sigma, z + sigma, alpha=0.3)
height.set(xlabel="t [s]", ylabel="z +- sigma [m]")

for axis, name in enumerate("xyz"):
    velocity.plot(seconds, flight.velocities[:, axis], label=name)
velocity.set(xlabel="t [s]", ylabel="velocity [m/s]")
velocity.legend()

used = flight.innovations[flight.innovations["result"] == rio.RESULTS.index("used")]
for index, name in enumerate(rio.MODELS):
    of_model = used[used["model"] == index]
    if len(of_model) > 0:
        at = (of_model["time"] - flight.times[0]) * 1e-9
        nis.plot(at, of_model["nis"] / of_model["dof"], ".", markersize=2, label=name)
nis.set(xlabel="t [s]", ylabel="NIS per row, about 1")
nis.legend()

figure.tight_layout()
figure.savefig(arguments.out, dpi=120)
print(f"{arguments.out}: {flight!r}")
