# SPDX-License-Identifier: Apache-2.0
# Sourced by the samples: installs what is missing on Debian 12, builds, and goes to build/samples,
# where results lie. Sets `program`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source cmake/debian_build.sh

install_missing "${rsstab_build_packages[@]}"
build_preset release rs-stabilize

program=$PWD/build/release/cli/rs-stabilize
results=$PWD/build/samples
mkdir -p "$results"
cd "$results"
