#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Adds the filters rsanalyze and rsstabilize to an FFmpeg source tree: copies vf_rsstabilize.c and
# makes configure (--enable-librsstab), libavfilter/Makefile and libavfilter/allfilters.c know it.
# A second run changes nothing; a tree it does not know is refused untouched.
set -euo pipefail

usage="usage: add_to_ffmpeg.sh SOURCE_TREE   (FFmpeg 5.1 to 9)"

refuse() {
  echo "add_to_ffmpeg.sh: $*" >&2
  exit 1
}

[[ $# -eq 1 && $1 != -* ]] || { echo "$usage" >&2; exit 2; }
tree=$1
filter=$(dirname "$0")/vf_rsstabilize.c
lavfi=$tree/libavfilter
[[ -f $filter ]] || refuse "vf_rsstabilize.c is not beside this script: run it from the sources of rs-stabilize."
for file in configure libavfilter/Makefile libavfilter/allfilters.c libavfilter/version.h; do
  [[ -f $tree/$file ]] || refuse "$tree is not an FFmpeg source tree ($file is missing)."
done

# The version moved to a file of its own after 5.0.
major=$(sed -n 's/^#define LIBAVFILTER_VERSION_MAJOR *\([0-9]*\).*/\1/p' \
  "$lavfi/version.h" "$lavfi/version_major.h" 2>/dev/null | head -n 1)
[[ $major =~ ^(8|9|10|11|12)$ ]] || refuse "$tree has libavfilter ${major:-of an unknown version}," \
  "the filter is written for 8 to 12 (FFmpeg 5.1 to 9)."

# Each change: the file, the line it goes in front of (a whole line, or its beginning up to the
# first blank), and the new line. Every list in FFmpeg is sorted, and these neighbours have been
# there in every version since 5.1.
if [[ $major -ge 11 ]]; then type=FFFilter; else type=AVFilter; fi
changes=(
  "configure|  --enable-librsvg |  --enable-librsstab       enable stabilization without rolling shutter via librsstab [no]"
  "configure|    mbedtls|    librsstab"
  "configure|rubberband_filter_deps=|rsanalyze_filter_deps=\"librsstab\""
  "configure|rubberband_filter_deps=|rsstabilize_filter_deps=\"librsstab\""
  "configure|enabled librsvg |enabled librsstab         && require_pkg_config librsstab \"rsstab >= 1.0\" rsstab.h rsstab_options_create"
  "libavfilter/Makefile|OBJS-\$(CONFIG_SAB_FILTER) |OBJS-\$(CONFIG_RSANALYZE_FILTER)              += vf_rsstabilize.o"
  "libavfilter/Makefile|OBJS-\$(CONFIG_SAB_FILTER) |OBJS-\$(CONFIG_RSSTABILIZE_FILTER)            += vf_rsstabilize.o"
  "libavfilter/allfilters.c|extern const $type ff_vf_sab;|extern const $type ff_vf_rsanalyze;"
  "libavfilter/allfilters.c|extern const $type ff_vf_sab;|extern const $type ff_vf_rsstabilize;"
)

# line_of PREFIX SECTION FILE: the number of the first line from the one that starts with SECTION on
# that starts with PREFIX.
line_of() {
  awk -v prefix="$1" -v section="$2" '
    index($0, section) == 1 { inside = 1 }
    inside && index($0, prefix) == 1 { print NR; exit }' "$3"
}

# Apache-2.0 goes together with version 3 of the (L)GPL only: that is the list mbedtls is on, too.
section_of() {
  [[ $1 == "    mbedtls" ]] && echo 'EXTERNAL_LIBRARY_VERSION3_LIST="'
  return 0
}

for change in "${changes[@]}"; do
  IFS='|' read -r file before line <<<"$change"
  grep -qxF -- "$line" "$tree/$file" && continue
  [[ -n $(line_of "$before" "$(section_of "$before")" "$tree/$file") ]] ||
    refuse "$tree/$file has no line \"$before\" to add the filter at: this FFmpeg is not known here."
done

cmp -s "$filter" "$lavfi/vf_rsstabilize.c" || cp "$filter" "$lavfi/vf_rsstabilize.c"
for change in "${changes[@]}"; do
  IFS='|' read -r file before line <<<"$change"
  grep -qxF -- "$line" "$tree/$file" && continue
  at=$(line_of "$before" "$(section_of "$before")" "$tree/$file")
  # Written in place, so that the file keeps its mode (configure is a program).
  content=$(awk -v at="$at" -v line="$line" 'NR == at { print line } { print }' "$tree/$file"; echo .)
  printf '%s' "${content%.}" >"$tree/$file"
done
echo "Added to $tree. Next: ./configure --enable-version3 --enable-librsstab ... && make"
