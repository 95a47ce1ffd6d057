#!/usr/bin/env bash
# The first run: installs what is needed, builds Release, replays a flight with both presets, prints how
# accurate they are, and leaves trajectories, pictures and a report in out/.
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
cmake --build build/demo -j "$(nproc)" >build/demo/build.log 2>&1 ||
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
      --out "$out/$preset.tum" --states "$out/$preset.states.csv" 2>&1 || [ $? -eq 3 ]  # lost
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
trap 'cat "$out/report.md" >&2' ERR  # what went wrong is in there
report >"$out/report.md"
grep -v -e '^```' -e '^!\[' "$out/report.md"
echo "Written to $out/: report.md, flight.svg, and for each preset the trajectory (.tum) and the states"
echo "with their covariance (.states.csv)."
