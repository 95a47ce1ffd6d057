#!/usr/bin/env bash
# The soak of `rio live`: an hour, or as many seconds as said, of a simulated flight over noisy
# cables, at real speed. Prints what it measured; fails if a frame that was sent whole did not come,
# if memory grew, or if the estimate drifted. The tests do the same for two minutes.
#   test/soak.sh [SECONDS]
set -euo pipefail
cd "$(dirname "$0")/.."

build=build/soak
cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DRIO_BUILD_TESTS=ON >/dev/null
cmake --build "$build" -j "$(nproc)" --target e2e_soak_test
RIO_SOAK_SECONDS=${1:-3600} "$build/test/e2e_soak_test"
