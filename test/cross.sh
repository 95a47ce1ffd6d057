#!/usr/bin/env bash
# Cross-builds for a small computer with Debian's compilers: the program and unit tests, then runs the tests and the
# sample flight under qemu-user and holds the path against that of this machine.
#   test/cross.sh arm64|armhf
set -euo pipefail
cd "$(dirname "$0")/.."
arch=${1:?arm64 or armhf}
what=
. test/cross_build.sh

options=(-G Ninja -S . -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O2 -DRIO_WARNINGS_AS_ERRORS=ON)
tests=(core_maths_test propagate_imu_test propagate_motion_test frontend_scan_test models_radar_test mavlink_link_test)
cmake "${options[@]}" -B "build/$arch" "${cross[@]}" >/dev/null
cmake --build "build/$arch" -j "$(nproc)" --target rio_tool "${tests[@]}"
ctest --test-dir "build/$arch" --output-on-failure --no-tests=error -R "^($(IFS='|'; echo "${tests[*]}"))\$"

if [ -z "${RIO_HOST_TOOL:-}" ]; then
  cmake "${options[@]}" -B build/host -DRIO_BUILD_TESTS=OFF >/dev/null
  cmake --build build/host -j "$(nproc)" --target rio_tool
  RIO_HOST_TOOL=build/host/src/tools/rio
fi
"$RIO_HOST_TOOL" replay data/sample_flight --no-check --states "build/$arch/host.csv" >/dev/null
"$qemu" -L / -E "LD_LIBRARY_PATH=$root/usr/lib/$triplet" "build/$arch/src/tools/rio" replay data/sample_flight --no-check --states "build/$arch/states.csv"
python3 - "build/$arch/host.csv" "build/$arch/states.csv" <<'COMPARE'
import sys
host, small = ([[float(cell) for cell in line.split(",")[:8]] for line in open(name) if line[0].isdigit()]
               for name in sys.argv[1:])
assert len(host) == len(small) > 0, (len(host), len(small))
worst = max(abs(a - b) for x, y in zip(host, small) for a, b in zip(x[1:4], y[1:4]))
print(f"{len(host)} poses, largest difference of a coordinate {worst:.3g} m")
assert worst < 1e-6
COMPARE
