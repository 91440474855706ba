# SPDX-License-Identifier: Apache-2.0
# Sourced by samples/run.sh and tests/run.sh: what a fresh Debian 12 needs, and how to build there.

# The one list of packages.
rsstab_build_packages=(
  cmake ninja-build ccache g++ pkg-config
  libeigen3-dev libexpected-dev libspdlog-dev libfmt-dev
  libceres-dev libopencv-dev nlohmann-json3-dev zlib1g-dev libssl-dev libcli11-dev
  libexiv2-dev libzip-dev
  libavformat-dev libavcodec-dev libavutil-dev libswscale-dev frei0r-plugins-dev
  libgtest-dev libgmock-dev)
rsstab_check_packages=(
  clang-format ffmpeg melt chromium chromium-driver python3-selenium libtorch-dev libopenblas0-pthread
  python3-torch python3-opencv python3-numpy python3-matplotlib)
# For the tests that build FFmpeg from its sources (RSSTAB_TEST_FFMPEG=1).
rsstab_ffmpeg_packages=(dpkg-dev make gcc valgrind)

# install_missing PACKAGE...: asks apt for those that are not there, as root or through sudo, never
# asking a question.
install_missing() {
  local missing=() package as_root=()
  for package in "$@"; do
    if [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) != installed ]]; then
      missing+=("$package")
    fi
  done
  if [[ ${#missing[@]} -eq 0 ]]; then
    return 0
  fi
  if [[ $(id -u) -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
      echo "These packages are missing, and installing them needs root: ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  echo "Installing ${missing[*]}"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq update </dev/null
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y \
    --no-install-recommends "${missing[@]}" </dev/null >/dev/null
}

# build_preset PRESET TARGET [CMAKE_OPTION...]: configures and builds; a build that is up to date
# costs nothing.
build_preset() {
  local preset=$1 target=$2
  shift 2
  cmake --preset "$preset" "$@" >/dev/null && cmake --build "build/$preset" --target "$target"
}
