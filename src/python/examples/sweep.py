#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tries values of an option over recordings and over simulated flights, on all cores.

    sweep.py radar.sigma_doppler 0.02 0.05 0.1 --recordings a.bag b/ --seeds 8
    sweep.py ... --dask tcp://10.0.0.5:8786       on every machine of a Dask scheduler, where rio is
                                                  installed and the recordings have the same names
Prints a table: the final drift in % of the path, median over the flights, and how many were lost
or failed (why is told). A recording needs ground truth.
"""
import argparse
import os
import statistics
import sys
import tempfile
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed

import rio


def fly(recording: str, key: str, value: str) -> float:
    """Drift at the end [% of the path]; infinite if the estimate is lost."""
    options = rio.Options()
    options[key] = value
    flight = rio.replay(recording, options)
    return float("inf") if flight.lost else rio.evaluate(recording, flight)["final_drift_percent"]


def fly_simulated(scenario: str, seed: int, length: float, key: str, value: str) -> float:
    with tempfile.TemporaryDirectory() as folder:
        return fly(rio.simulate(folder + "/flight", scenario, seed=seed, length=length), key, value)


def executor_of(address: str) -> Executor:
    """Threads suffice on one machine: a replay releases the interpreter."""
    if not address:
        return ThreadPoolExecutor(os.cpu_count())
    from distributed import Client  # python3-distributed

    return Client(address).get_executor()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("key", help="option, as radar.sigma_doppler")
    parser.add_argument("values", nargs="+")
    parser.add_argument("--recordings", nargs="*", default=[])
    parser.add_argument("--scenario", default="", help="of the simulated flights")
    parser.add_argument("--seeds", type=int, default=0, help="number of simulated flights")
    parser.add_argument("--length", type=float, default=100.0, help="of a simulated path [m]")
    parser.add_argument("--dask", default="", metavar="ADDRESS", help="of a scheduler")
    arguments = parser.parse_args()
    if not arguments.recordings and arguments.seeds == 0:
        parser.error("nothing to fly: --recordings or --seeds")

    recordings = [os.path.abspath(r) for r in arguments.recordings]
    drifts: dict[str, list[float]] = {value: [] for value in arguments.values}
    with executor_of(arguments.dask) as executor:
        jobs = {}
        for value in arguments.values:
            for recording in recordings:
                jobs[executor.submit(fly, recording, arguments.key, value)] = value
            for seed in range(1, arguments.seeds + 1):
                job = executor.submit(fly_simulated, arguments.scenario, seed, arguments.length,
                                      arguments.key, value)
                jobs[job] = value
        for done, job in enumerate(as_completed(jobs), start=1):
            try:
                drifts[jobs[job]].append(job.result())
            except rio.Error as error:
                print(f"\n{error}", file=sys.stderr)
                drifts[jobs[job]].append(float("inf"))
            print(f"\r[{'#' * (40 * done // len(jobs)):40}] {done}/{len(jobs)}", end="", file=sys.stderr)
    print(file=sys.stderr)

    print(f"| {arguments.key} | drift [%], median | worst | lost, failed |\n|---|---|---|---|")
    for value, all_drifts in drifts.items():
        flown = [d for d in all_drifts if d != float("inf")]
        median, worst = (statistics.median(flown), max(flown)) if flown else (float("nan"),) * 2
        print(f"| {value} | {median:.3f} | {worst:.3f} | {len(all_drifts) - len(flown)} of {len(all_drifts)} |")


if __name__ == "__main__":
    main()
