#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes the twelve simulated clips that clip evaluation is quoted on: four ways to hold a camera,
# three scenes each, 1280x720, 6 s, readout 10, 20 and 30 ms (every motion sees each), every second
# one with an object that crosses the scene.
#
#   bench/simulate_clips.sh OUT PHOTO_DIR|none SEED
#
# OUT gets a folder for each clip, named MOTION-SCENE-READOUT[-fg]; one that is complete is kept.
# PHOTO_DIR: three of its photographs (JPEG, PNG, TIFF), drawn by SEED, are the scenes; with none the
# program paints a street of its own for each clip. RS_STABILIZE names the program, by default that
# of the release build.
set -euo pipefail

if [[ $# -ne 3 || ! $3 =~ ^[0-9]+$ ]]; then
  echo "usage: $0 OUT PHOTO_DIR|none SEED" >&2
  exit 2
fi
out=$1 photo_folder=$2 seed=$3
program=${RS_STABILIZE:-$(dirname "$0")/../build/release/cli/rs-stabilize}

photos=()
if [[ $photo_folder != none ]]; then
  mapfile -t photos < <(find "$photo_folder" -maxdepth 1 -type f -printf '%f\n' |
    grep -iE '\.(jpe?g|png|tiff?)$' | LC_ALL=C sort | shuf -n 3 --random-source=<(yes "$seed"))
  if [[ ${#photos[@]} -lt 3 ]]; then
    echo "$photo_folder: three photographs are needed, there are ${#photos[@]}" >&2
    exit 1
  fi
fi

motions=(handheld walking vibration fast-pan)
readouts=(10 20 30)
mkdir -p "$out"
for motion in 0 1 2 3; do
  for scene in 0 1 2; do
    number=$((3 * motion + scene))
    readout=${readouts[(motion + scene) % 3]}
    name=${motions[motion]}-$((scene + 1))-${readout}ms
    options=(--motion "${motions[motion]}" --readout "$readout" --seed $((100 * seed + number))
      --width 1280 --height 720 --duration 6)
    if ((number % 2 == 1)); then
      options+=(--foreground)
      name+=-fg
    fi
    if [[ ${#photos[@]} -gt 0 ]]; then
      options+=(--image "$photo_folder/${photos[scene]}")
    fi
    # The truth is written last.
    if [[ ! -e $out/$name/truth.json ]]; then
      "$program" simulate "$out/$name" "${options[@]}" --overwrite
    fi
  done
done
