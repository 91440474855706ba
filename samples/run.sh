#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 to a steady clip: installs what is missing, builds, makes a shaky clip with
# a rolling shutter whose truth is known, steadies it without and with its gyro log, and measures.
source "$(dirname "$0")/setup.sh"

echo "== a shaky clip: walking, 25 ms of readout"
"$program" simulate walking --motion walking --seed 1 --duration 6 --overwrite

echo "== steadied with nothing told: readout time and camera are found from the picture"
"$program" walking/rs.mp4 -o without-log.mp4 --overwrite

echo "== steadied with the camera file and the gyro log"
"$program" walking/rs.mp4 -o with-log.mp4 --rs gyro --gyro walking/gyro.csv \
  --camera walking/camera.json --overwrite

for clip in without-log with-log; do
  echo "== $clip, measured against the truth"
  "$program" compare walking/rs.mp4 "$clip.mp4" --truth walking | tee "$clip.txt"
done

echo "== side by side, px at 640 px width: the camera residual is what is left of the rolling shutter"
printf '%-18s%10s%14s%10s\n' '' input 'without log' 'with log'
paste without-log.txt with-log.txt |
  awk '/^(jitter|shake|row wobble|camera residual|crop ratio)/ {
    half = NF / 2  # each line ends with its input and its output
    label = $1 ($2 ~ /^(wobble|residual|ratio)$/ ? " " $2 : "")
    printf "%-18s%10s%14s%10s\n", label, $(half - 1), $half, $NF
  }'

echo "The clips lie in $results:"
echo "  walking/rs.mp4     the input            walking/gs.mp4  what a global shutter would have seen"
echo "  without-log.mp4    steady, no skew      with-log.mp4    the same, from the gyro log"
