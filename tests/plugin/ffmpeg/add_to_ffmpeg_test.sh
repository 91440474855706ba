#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# plugin/ffmpeg/add_to_ffmpeg.sh on made-up source trees that have the lines it looks for, and on
# trees that it has to refuse.
set -uo pipefail
script=$(cd "$(dirname "$0")/../../.." && pwd)/plugin/ffmpeg/add_to_ffmpeg.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=0
complain() {
  echo "FAILED: $*"
  bad=1
}

# make_tree FOLDER MAJOR TYPE: what configure, Makefile and allfilters.c look like there.
make_tree() {
  mkdir -p "$1/libavfilter"
  cat >"$1/configure" <<'CONFIGURE'
#!/bin/sh
  --enable-librsvg         enable SVG rasterization via librsvg [no]
SOME_OTHER_LIST="
    mbedtls
"
EXTERNAL_LIBRARY_VERSION3_LIST="
    gmp
    mbedtls
    rkmpp
"
rubberband_filter_deps="librubberband"
enabled librsvg           && require_pkg_config librsvg librsvg-2.0
CONFIGURE
  chmod +x "$1/configure"
  printf '#define LIBAVFILTER_VERSION_MAJOR %3d\n' "$2" >"$1/libavfilter/version_major.h"
  printf '#define LIBAVFILTER_VERSION_MINOR   1\n' >"$1/libavfilter/version.h"
  printf 'OBJS-$(CONFIG_SAB_FILTER)                    += vf_sab.o\n' >"$1/libavfilter/Makefile"
  printf 'extern const %s ff_vf_sab;\n' "$3" >"$1/libavfilter/allfilters.c"
}

# has FILE LINE: exactly once.
has() {
  [[ $(grep -cxF -- "$2" "$1") == 1 ]] || complain "$1 has not just one line: $2"
}

# refused EXIT WORDS ARGUMENT...: that exit status, one line on standard error, with these words.
refused() {
  local status=$1 words=$2 message code
  shift 2
  message=$("$script" "$@" 2>&1 >/dev/null)
  code=$?
  [[ $code == "$status" ]] || complain "$*: exit status $code, not $status"
  [[ $message == *"$words"* ]] || complain "$*: '$message' does not say '$words'"
  [[ $(wc -l <<<"$message") == 1 ]] || complain "$*: more than one line: $message"
}

for case in '8 AVFilter' '10 AVFilter' '11 FFFilter' '12 FFFilter'; do
  read -r major type <<<"$case"
  tree="$work/tree $major"  # a folder with a blank in its name
  make_tree "$tree" "$major" "$type"
  "$script" "$tree" >/dev/null || complain "$case: not added"
  cmp -s "$tree/libavfilter/vf_rsstabilize.c" "$(dirname "$script")/vf_rsstabilize.c" ||
    complain "$case: the filter was not copied"
  has "$tree/configure" 'rsanalyze_filter_deps="librsstab"'
  has "$tree/configure" 'rsstabilize_filter_deps="librsstab"'
  has "$tree/configure" '    librsstab'
  grep -A 2 '^EXTERNAL_LIBRARY_VERSION3_LIST' "$tree/configure" | grep -qx '    librsstab' ||
    complain "$case: librsstab is not on the list of libraries that ask for version 3"
  grep -q '^enabled librsstab .*require_pkg_config librsstab "rsstab ' "$tree/configure" ||
    complain "$case: configure does not look for the library"
  has "$tree/libavfilter/allfilters.c" "extern const $type ff_vf_rsanalyze;"
  has "$tree/libavfilter/allfilters.c" "extern const $type ff_vf_rsstabilize;"
  [[ -x $tree/configure ]] || complain "$case: configure is no longer a program"
  cp -r "$tree" "$work/once"
  "$script" "$tree" >/dev/null || complain "$case: refused the second time"
  diff -r "$work/once" "$tree" || complain "$case: the second run changed something"
  rm -rf "$work/once"
done

refused 2 'usage:'
refused 2 'usage:' --help
refused 1 'is not an FFmpeg source tree' "$work/nowhere"
mkdir "$work/empty"
refused 1 'is not an FFmpeg source tree (configure is missing)' "$work/empty"
make_tree "$work/old" 7 AVFilter
refused 1 'has libavfilter 7' "$work/old"
make_tree "$work/strange" 10 AVFilter
sed -i '/rubberband/d' "$work/strange/configure"
cp -r "$work/strange" "$work/before"
refused 1 'is not known here' "$work/strange"
diff -r "$work/before" "$work/strange" || complain "a refused tree was changed"

[[ $bad == 0 ]] && echo "all trees as they should be"
exit $bad
