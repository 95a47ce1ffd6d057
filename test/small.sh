#!/usr/bin/env bash
# The estimator as for a flight controller: without exceptions, RTTI and the smoother, optimised for size, its memory a
# static array. Prints code size, memory and stack, and (for this machine) instructions per call.
#   test/small.sh [armhf]     armhf: 32 bit Thumb-2 code, run under qemu-user
set -euo pipefail
cd "$(dirname "$0")/.."
arch=${1:-native}
compiler=${CXX:-g++} run=() options=() build=build/small-$arch
flags="-Os -fno-exceptions -fno-rtti -ffunction-sections -fdata-sections -fno-asynchronous-unwind-tables"
if [ "$arch" = armhf ]; then
  cmake/install_dependencies.sh armhf
  compiler=arm-linux-gnueabihf-g++ run=(qemu-arm -L /) options=(-DCMAKE_TOOLCHAIN_FILE=cmake/toolchain/armhf.cmake)
  flags+=" -mthumb"
fi
cmake -G Ninja -S . -B "$build" "${options[@]}" -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS="$flags -DNDEBUG" \
  -DRIO_SMOOTHER=OFF -DRIO_BUILD_TOOLS=OFF -DRIO_BUILD_LAB=OFF -DRIO_BUILD_TESTS=OFF -DRIO_BUILD_EXAMPLES=OFF \
  -DRIO_INSTALL=OFF >/dev/null
cmake --build "$build" -j "$(nproc)" --target rio rio_static_memory
# shellcheck disable=SC2086
"$compiler" -std=c++17 $flags -isystem /usr/include/eigen3 -Iinclude test/small/flight.cpp "$build"/src/librio.a \
  "$build"/src/librio_core.a "$build"/src/librio_static_memory.a -pthread -Wl,--gc-sections -o "$build/flight"
nm -S -C -t d "$build/flight" | awk '
  $3 ~ /[tTwWvV]/ && /rio::|Eigen::/ { code += $2 }
  $3 ~ /[rR]/ && /rio::/ { tables += $2 }
  END { printf "code of rio and Eigen %.0f kB, tables %.1f kB\n", code / 1000, tables / 1000 }'
for landmarks in 0 8 64; do
  printf '%d landmarks: ' "$landmarks"
  "${run[@]}" "$build/flight" "$landmarks"
done
if [ "$arch" = native ] && command -v valgrind >/dev/null; then
  for call in add_imu add_scan; do
    valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect="rio::Odometry::$call*" "$build/flight" 8 \
      2>&1 >/dev/null | awk -v call=$call '/Collected/ { printf "%s: %.0f instructions in all\n", call, $4 }'
  done
fi
