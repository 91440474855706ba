#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A small data set in the layout of RS-Real, painted by the program itself, and every method on it.
# The published set is evaluated by the same command: --dataset rs-real:FOLDER.
source "$(dirname "$0")/setup.sh"

echo "== 24 labelled pictures with weak, medium and strong motions"
"$program" simulate rs-real --rs-real --samples 24 --seed 1 --overwrite

echo "== every method on all of them"
"$program" evaluate --dataset rs-real:rs-real --csv rs-real.csv --json rs-real.json \
  --report rs-real.html --overwrite

echo "Figures: $results/rs-real.csv and rs-real.json; to look at: $results/rs-real.html"
