#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 to a steady clip: installs what is missing, builds, makes a shaky clip with
# a rolling shutter whose truth is known, steadies it with and without its gyro log, and measures.
source "$(dirname "$0")/setup.sh"

echo "== a shaky clip: walking, 25 ms of readout"
"$program" simulate walking --motion walking --seed 1 --duration 6 --overwrite

echo "== steadied, rolling shutter removed by its gyro log"
"$program" walking/rs.mp4 -o with-gyro.mp4 --rs gyro --gyro walking/gyro.csv \
  --camera walking/camera.json --overwrite

echo "== steadied from the picture alone"
"$program" walking/rs.mp4 -o without-gyro.mp4 --rs off --overwrite

for clip in with-gyro without-gyro; do
  echo "== $clip, measured against the truth"
  "$program" compare walking/rs.mp4 "$clip.mp4" --truth walking
done

echo "The clips lie in $results:"
echo "  walking/rs.mp4    the input          walking/gs.mp4    what a global shutter would have seen"
echo "  with-gyro.mp4     steady, no skew    without-gyro.mp4  steady, rolling shutter left in"
