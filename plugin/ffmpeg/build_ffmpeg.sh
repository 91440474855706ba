#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds an ffmpeg with the filters rsanalyze and rsstabilize from Debian's source package; changes
# nothing outside FOLDER. librsstab has to be installed where pkg-config finds it (PKG_CONFIG_PATH).
set -euo pipefail

usage="usage: build_ffmpeg.sh [--suite NAME] [--only TARGET] FOLDER [CONFIGURE_OPTION...]
  FOLDER            sources, objects and the program (FOLDER/ffmpeg) go here; made when missing.
                    A second run with the same options builds only what has changed.
  CONFIGURE_OPTION  for FFmpeg's configure, for example --enable-gpl --enable-libx264
  --suite NAME      Debian release to take FFmpeg from, for example trixie; default: this machine's
  --only TARGET     make this instead of ffmpeg and ffprobe"

suite=
targets=(ffmpeg ffprobe)
while [[ ${1-} == --* ]]; do
  case $1 in
    --suite) suite=${2-}; shift ;;
    --only) targets=("${2-}"); shift ;;
    *) echo "$usage" >&2; exit 2 ;;
  esac
  shift || { echo "$usage" >&2; exit 2; }
done
[[ $# -ge 1 && -n $1 ]] || { echo "$usage" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift

fail() {
  echo "build_ffmpeg.sh: $*" >&2
  exit 1
}
for tool in apt-get dpkg-source make gcc pkg-config; do
  command -v "$tool" >/dev/null ||
    fail "$tool is missing: install apt, dpkg-dev, make, gcc and pkg-config first."
done
pkg-config --exists rsstab ||
  fail "pkg-config does not find rsstab: install rs-stabilize, or set PKG_CONFIG_PATH to the folder of its rsstab.pc."

# fetch_source: FOLDER/source, from the mirrors that apt uses already, with their deb lines read as
# deb-src. Lists and settings of its own: neither root nor a change of the system is needed.
fetch_source() {
  local codename lists=() apt
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  rm -rf "$folder/apt" "$folder/package"
  mkdir -p "$folder/apt/parts" "$folder/apt/lists/partial" "$folder/apt/archives/partial" "$folder/package"
  for list in /etc/apt/sources.list /etc/apt/sources.list.d/*; do
    if [[ -f $list ]] && grep -qE "(^deb |^Suites:).*\b$codename\b" "$list"; then
      sed -E "s/^deb(-src)? /deb-src /; s/^Types:.*/Types: deb-src/; /^deb|^Suites:/ s/\b$codename\b/${suite:-$codename}/g" \
        "$list" >"$folder/apt/parts/$(basename "$list")"
    fi
  done
  [[ -n $(ls "$folder/apt/parts") ]] || fail "apt has no mirror of Debian $codename."
  apt=(apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$folder/apt/parts"
    -o "Dir::State::lists=$folder/apt/lists" -o "Dir::Cache=$folder/apt" -o APT::Sandbox::User=)
  # A suite without an archive of that name (sid has no updates) is no obstacle as long as FFmpeg is found.
  "${apt[@]}" update >&2 || true
  (cd "$folder/package" && "${apt[@]}" source ffmpeg >&2) ||
    fail "apt could not fetch the source package ffmpeg of Debian ${suite:-$codename}."
  rm -rf "$folder/source"
  mv "$folder"/package/ffmpeg-*/ "$folder/source"
  rm -rf "$folder/apt" "$folder/package"
}

[[ -f $folder/source/configure ]] || fetch_source
"$here/add_to_ffmpeg.sh" "$folder/source" >/dev/null

compiler=gcc
command -v ccache >/dev/null && compiler="ccache gcc"
options=(--cc="$compiler" --disable-doc --enable-version3 --enable-librsstab "$@")
# A library outside the system's folders is looked for where it is now.
library=$(pkg-config --variable=libdir rsstab)
if [[ -n $library && $library != /usr/lib* ]]; then
  options+=("--extra-ldflags=-Wl,-rpath,$(realpath "$library")")
fi
stamp="$(pkg-config --modversion --cflags --libs rsstab) $(cksum <"$folder/source/configure") ${options[*]}"
cd "$folder"
if [[ ! -f ffbuild/config.mak || $(cat configured 2>/dev/null) != "$stamp" ]]; then
  source/configure "${options[@]}" >configure.log 2>&1 ||
    fail "configure refused: $(grep -m 1 ERROR configure.log || tail -n 1 configure.log) (see $folder/configure.log and ffbuild/config.log)"
  echo "$stamp" >configured
fi
make -j"$(nproc)" "${targets[@]}" >make.log 2>&1 ||
  fail "make failed: $(grep -m 1 -i error make.log) (see $folder/make.log)"
echo "$folder/${targets[0]}"
