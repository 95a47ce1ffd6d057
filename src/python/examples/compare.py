#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares rio with the paths of other estimators on one recording with ground truth.

    compare.py RECORDING other.tum another.tum --truth truth.tum

Paths are TUM files (t x y z qx qy qz qw) or EuRoC csv. Errors are after alignment by yaw and
position, as papers print them; only poses that have a true pose count, so look at the last column.
"""
import argparse
import os

import rio

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("recording", help="folder in ASL/EuRoC layout, or a bag")
parser.add_argument("others", nargs="*", help="paths of other estimators")
parser.add_argument("--truth", help="if the recording has none")
parser.add_argument("--config", help="option file for rio")
arguments = parser.parse_args()

options = rio.Options.from_file(arguments.config) if arguments.config else None
paths = {"rio": rio.replay(arguments.recording, options).path}
paths |= {os.path.basename(name): rio.read_path(name) for name in arguments.others}

print("| estimator | APE [m] | rotation [deg] | RPE over 10 m [%] | final drift [%] | poses |")
print("|---|---|---|---|---|---|")
for name, path in paths.items():
    e = rio.evaluate(arguments.truth or arguments.recording, path, align="yaw")
    over_10_m = next(piece for piece in e["rpe"] if piece["distance_m"] == 10.0)
    numbers = (
        e["ape"]["yaw"]["translation_m"]["rmse"],
        e["ape"]["yaw"]["rotation_deg"]["rmse"],
        over_10_m["translation_percent"]["rmse"],
        e["final_drift_percent"],
    )
    cells = ["-" if number is None else f"{number:.3f}" for number in numbers]
    print(f"| {name} | {' | '.join(cells)} | {e['associated']} of {e['poses']} |")
