#!/usr/bin/env bash
# Fuzzes every target for some time with libFuzzer, AddressSanitizer and UBSan; installs what that needs.
#   test/fuzz/run.sh [seconds [target...]]     60 s each; default: all
# Prints a table of executions and findings; exits with 1 if there is a finding. The inputs that grew
# stay in build/fuzz/corpus, findings in build/fuzz/findings: give such a file to the program to see it
# again, as in  build/fuzz/test/fuzz/fuzz_odometry build/fuzz/findings/odometry/crash-...
set -euo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:-60}
targets=("${@:2}")
[ ${#targets[@]} -eq 0 ] && targets=(odometry options dataset trajectory scenario ti_config map bag message ti mavlink)
cmake/install_dependencies.sh fuzz

build=$PWD/build/fuzz
cmake -C cmake/presets/fuzz.cmake -S . -B "$build" >/dev/null
programs=("${targets[@]/#/fuzz_}")
cmake --build "$build" -j "$(nproc)" --target "${programs[@]}"

table=$(printf '%-12s %12s %9s   %s' target executions findings notes)
status=0
for target in "${targets[@]}"; do
  grown=$build/corpus/$target
  found=$build/findings/$target
  log=$build/fuzz_$target.log
  longest=4096
  [ "$target" = bag ] && longest=20000  # the smallest database has 16384
  rm -rf "$found"
  mkdir -p "$grown" "$found"
  "$build/test/fuzz/fuzz_$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len="$longest" \
    -print_final_stats=1 -artifact_prefix="$found/" "$grown" "test/fuzz/corpus/$target" >"$log" 2>&1 || true
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  findings=$(find "$found" -type f | wc -l)
  # it ended in another way: that is a finding, too
  grep -q '^Done ' "$log" || [ "$findings" -gt 0 ] || findings='?'
  if [ "$findings" != 0 ]; then
    status=1
    tail -n 40 "$log"
  fi
  table+=$'\n'$(printf '%-12s %12s %9s   %s' "$target" "${executions:-?}" "$findings" "$(sed -n 's/^calls: //p' "$log")")
done
printf '\n%s\n' "$table"
exit "$status"
