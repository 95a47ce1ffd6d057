#!/usr/bin/env bash
# Makes a recording small enough to ship: seven significant digits, ground truth at every tenth row.
#   data/thin.sh IN OUT        both in ASL/EuRoC layout
set -euo pipefail
in=$1
out=$2
for folder in imu0 radar0 state_groundtruth_estimate0; do
  mkdir -p "$out/$folder"
  [ -f "$in/$folder/sensor.yaml" ] && cp "$in/$folder/sensor.yaml" "$out/$folder/"
  every=1
  [ $folder = state_groundtruth_estimate0 ] && every=10
  awk -F, -v OFS=, -v every=$every '
    /^#/ { print; next }
    n++ % every == 0 { for (i = 2; i <= NF; ++i) if ($i != "") $i = sprintf("%.7g", $i); print }
  ' "$in/$folder/data.csv" >"$out/$folder/data.csv"
done
