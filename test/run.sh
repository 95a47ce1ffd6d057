#!/usr/bin/env bash
# The tests: installs what they need, builds with warnings as errors, runs ctest, prints what was
# measured.
#   test/run.sh             all tests
#   test/run.sh sanitize    all but the Monte Carlo tests, with AddressSanitizer and UBSan
#   test/run.sh view        pages in Chromium, files and live view read by packages of npm
#   test/run.sh thread      the test of two threads, with ThreadSanitizer
#   test/run.sh tidy        clang-format, clang-tidy, every header compiled alone
#   test/run.sh package     the Debian packages: lintian, installed into a root, used from there
#   test/run.sh package arm64     the same, cross-built, the program under qemu-user
#   test/run.sh docs        the site, without a warning of Doxygen and Sphinx
#   test/run.sh small       as for a flight controller: code size, memory, stack
#   test/run.sh arm64       cross build (or armhf): unit tests and the sample flight under qemu-user
# Further arguments go to ctest, as in: test/run.sh -L model.  CXX=clang++ chooses the compiler.
# RIO_TEST_DATA names a folder with real recordings; without it their tests are skipped.
set -euo pipefail
cd "$(dirname "$0")/.."

mode=test
needs=tests
case "${1:-}" in
  sanitize | thread) mode=$1; shift ;;
  tidy) mode=tidy needs=tidy; shift ;;
  view) needs=view; shift ;;
  package) cmake/install_dependencies.sh package; exec test/package/deb.sh "build/package${2:+-$2}" "${@:2}" ;;
  arm64 | armhf) exec test/cross.sh "$1" ;;
  docs) exec data/docs/build.sh ;;
  small) exec test/small.sh "${@:2}" ;;
esac
cmake/install_dependencies.sh "$needs"

jobs=$(nproc)
compiler=$(basename "${CXX:-g++}")
build=build/$mode-$compiler
grep -qs Makefiles "$build/CMakeCache.txt" || export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"
extra=()
[ "$mode" = test ] && extra=(-DRIO_BUILD_PYTHON=ON -DRIO_BUILD_ROS2=ON -DPython3_EXECUTABLE=/usr/bin/python3)
cmake -C "cmake/presets/$mode.cmake" -S . -B "$build" -DCMAKE_CXX_COMPILER="$compiler" "${extra[@]}" >/dev/null

if [ "$mode" = tidy ]; then
  git ls-files '*.hpp' '*.cpp' | xargs clang-format-14 --dry-run -Werror
  # Python and ROS 2 need headers that their own builds find or generate
  git ls-files 'src/*.cpp' 'test/*.cpp' ':!test/package' ':!src/python' ':!src/ros2' ':!test/ros2' |
    xargs -P "$jobs" -n 4 clang-tidy-14 --quiet --extra-arg=-Wno-unknown-warning-option -p "$build"
  cmake --build "$build" -j "$jobs" --target headers_alone
  exit
fi

if [ "$needs" = view ]; then
  npm install --silent --no-save --prefix build/npm playwright-core@1 ws@8 @mcap/core@2 @foxglove/rosmsg@5 \
    @foxglove/rosmsg2-serialization@3 @foxglove/ws-protocol@0.8 node-mavlink@2
  export NODE_PATH=$PWD/build/npm/node_modules
  set -- -R '^(e2e_tool|bag|mavlink)_' "$@"
fi

if [ "$mode" = thread ]; then
  cmake --build "$build" -j "$jobs" --target api_two_threads_test
  ctest --test-dir "$build" --output-on-failure --no-tests=error -L thread "$@"
  exit
fi

cmake --build "$build" -j "$jobs"
[ "$mode" = sanitize ] && set -- -LE mc "$@"
RIO_MEASURED=$PWD/$build/measured.txt
export RIO_MEASURED
: >"$RIO_MEASURED"
status=0  # one job more than cores: the soak waits
ctest --test-dir "$build" -j $((jobs + 1)) --output-on-failure --no-tests=error "$@" || status=$?
if [ -s "$RIO_MEASURED" ]; then
  printf '\nWhat the tests measured:\n'
  sort "$RIO_MEASURED"
fi
exit "$status"
