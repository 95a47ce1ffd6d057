#!/usr/bin/env bash
# The tests: installs what they need, builds with warnings as errors, runs ctest.
#   test/run.sh             all tests
#   test/run.sh sanitize    all but the Monte Carlo tests, with AddressSanitizer and UBSan
#   test/run.sh tidy        clang-format, clang-tidy, every header compiled alone, the benchmarks
# Further arguments go to ctest, as in: test/run.sh -L model.  CXX=clang++ chooses the compiler.
set -euo pipefail
cd "$(dirname "$0")/.."

mode=all
case "${1:-}" in sanitize | tidy) mode=$1; shift ;; esac
cmake/install_dependencies.sh tests

jobs=$(nproc)
compiler=$(basename "${CXX:-g++}")
build=build/test-$mode-$compiler
# asserts stay on in the tests: no NDEBUG
flags="-O1"
[ "$mode" = sanitize ] && flags="-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
cmake -S . -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS="$flags" \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DRIO_WARNINGS_AS_ERRORS=ON \
  -DRIO_BUILD_BENCH="$([ "$mode" = tidy ] && echo ON || echo OFF)" >/dev/null

if [ "$mode" = tidy ]; then
  git ls-files '*.hpp' '*.cpp' | xargs clang-format-14 --dry-run -Werror
  git ls-files 'src/*.cpp' 'test/*.cpp' ':!test/package' |
    xargs -P "$jobs" -n 4 clang-tidy-14 --quiet -p "$build"
  cmake --build "$build" -j "$jobs" --target headers_alone update_bench
  exit
fi

cmake --build "$build" -j "$jobs"
[ "$mode" = sanitize ] && set -- -LE mc "$@"
ctest --test-dir "$build" -j "$jobs" --output-on-failure --no-tests=error "$@"
