#!/usr/bin/env bash
# The first run: installs what is needed, builds Release, replays a flight with two presets, prints how
# accurate they are, and leaves trajectories, pictures and pages to look at in out/.
#   data/demo.sh              the sample flight in data/sample_flight
#   data/demo.sh DATASET      your own recording, a folder in ASL/EuRoC layout or a bag (data/README.md)
set -eEuo pipefail
start=$PWD
cd "$(dirname "$0")/.."
dataset=data/sample_flight
if [ $# -gt 0 ]; then
  dataset=$(cd "$start" && realpath -e "$1") || { echo "no such recording: $1" >&2; exit 1; }
fi

cmake/install_dependencies.sh tools
echo "Building (Release) ..."
grep -qs Makefiles build/demo/CMakeCache.txt || export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"
cmake -S . -B build/demo -DCMAKE_BUILD_TYPE=Release -DRIO_BUILD_TESTS=OFF -DRIO_BUILD_LAB=OFF >/dev/null
cmake --build build/demo --target rio_tool -j "$(nproc)" >build/demo/build.log 2>&1 ||
  { cat build/demo/build.log >&2; exit 1; }
rio=build/demo/src/tools/rio

out=out
mkdir -p "$out"
presets="default published-ekf"
truth=
for place in "$dataset" "$dataset/mav0"; do
  [ -f "$place/state_groundtruth_estimate0/data.csv" ] && truth=$place
done

estimates=()
report() {
  echo "# Replay of $(basename "$dataset")"
  for preset in $presets; do
    printf '\n## Preset %s\n\n```\n' "$preset"
    "$rio" replay "$dataset" --preset "$preset" --quiet \
      --out "$out/$preset.tum" --states "$out/$preset.states.csv" --report "$out/$preset.html" 2>&1 ||
      [ $? -eq 3 ]  # lost
    printf '```\n'
    estimates+=("$out/$preset.tum")
  done
  if [ -n "$truth" ]; then
    printf '\n## Accuracy against the ground truth (no alignment)\n\n'
    "$rio" evaluate "$truth" "${estimates[@]}"
    "$rio" plot "${estimates[@]}" --truth "$truth" --out "$out/flight.svg" >/dev/null
  else
    printf '\nThere is no ground truth: if the sensor came back to its start, the distance from first to\n'
    printf 'last position is the error.\n'
    "$rio" plot "${estimates[@]}" --out "$out/flight.svg" >/dev/null
  fi
  printf '\n![flight](flight.svg)\n'
}
# One line of a preset: its errors, or where there is no truth how far the end is from the start.
accuracy() {
  if [ -n "$truth" ]; then
    "$rio" evaluate "$truth" "$out/$1.tum" | awk '
      /^  norm of RMSE/ { rmse = $4 } /^  final drift/ { drift = $3 } /^  yaw error/ { yaw = $3 }
      END { printf "position error %s m (RMSE), %s %% of the path at the end, yaw %s deg", rmse, drift, yaw }'
  else
    awk '{ if (NR == 1) split($0, a, " ") } END { printf "end %.3f m from the start",
      sqrt(($2 - a[2])^2 + ($3 - a[3])^2 + ($4 - a[4])^2) }' "$out/$1.tum"
  fi
}
trap 'cat "$out/report.md" >&2' ERR  # what went wrong is in there
report >"$out/report.md"
grep -v -e '^```' -e '^!\[' "$out/report.md"
echo
echo "Written to $out/: report.md, flight.svg, and for each preset the trajectory (.tum), the states with"
echo "their covariance (.states.csv) and a page to look at (.html)."
for preset in $presets; do printf '%-14s %s\n' "$preset:" "$(accuracy "$preset")"; done
echo "Look at it:    xdg-open $PWD/$out/default.html"
