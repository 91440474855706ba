#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The reports: a page about a clip that was steadied, and one that compares it with the truth.
source "$(dirname "$0")/setup.sh"

echo "== a shaky clip: vibration as of an engine, 30 ms of readout"
"$program" simulate engine --motion vibration --readout 30 --seed 2 --duration 5 --overwrite

echo "== steadied, with a report"
"$program" engine/rs.mp4 -o engine-steady.mp4 --rs gyro --gyro engine/gyro.csv \
  --camera engine/camera.json --report engine-steady.html --overwrite

echo "== measured against the truth, with a report"
"$program" compare engine/rs.mp4 engine-steady.mp4 --truth engine \
  --report engine-compare.html --overwrite

echo "Open in a browser (each is one file, nothing is fetched):"
echo "  $results/engine-steady.html   $results/engine-compare.html"
