#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A single picture without any log: a frame from the middle of a whip pan, put right from what it
# shows alone, and held against what a global shutter would have seen.
source "$(dirname "$0")/setup.sh"
install_missing ffmpeg

echo "== a whip pan, and one frame of it as a photograph"
"$program" simulate pan --motion fast-pan --seed 3 --duration 2 --width 800 --height 600 --overwrite
rm -rf photograph
mkdir photograph
for shutter in rs gs; do
  ffmpeg -v error -ss 1.4 -i "pan/$shutter.mp4" -frames:v 1 "photograph/street_$shutter.png"
done

echo "== put right from the picture alone"
"$program" correct photograph/street_rs.png -o street-upright.png --field street-field --overwrite

echo "== before and after, against the truth"
"$program" evaluate --dataset pairs:photograph --methods none,diffusion \
  --report photograph.html --overwrite

echo "The pictures lie in $results:"
echo "  photograph/street_rs.png   as recorded       street-upright.png   put right"
echo "  photograph/street_gs.png   the truth         photograph.html      all of them, and the motion"
