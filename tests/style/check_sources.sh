#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks what no compiler checks: format, licence tags, include guards, and that includes point down
# the module graph. Run from the project's root.
set -uo pipefail
cd "$(dirname "$0")/../.."
bad=0
complain() {
  echo "$1"
  bad=1
}

mapfile -t sources < <(find igf rsdiff stabilizer evaluation plugin cli tests bench samples \
  -name '*.h' -o -name '*.cc' -o -name '*.c' 2>/dev/null | sort)

for file in "${sources[@]}"; do
  [[ $(head -n 1 "$file") == "// SPDX-License-Identifier: Apache-2.0" ]] ||
    complain "$file: the first line is not the SPDX tag"
  if [[ $file == *.h ]]; then
    guard=RSSTAB_$(echo "$file" | tr 'a-z/.-' 'A-Z___')_
    grep -q "^#ifndef $guard\$" "$file" || complain "$file: the include guard is not $guard"
  fi
done

# arrows FOLDER ALLOWED: our own headers that files below FOLDER may include.
arrows() {
  while IFS= read -r hit; do
    complain "$hit: points up the module graph"
  done < <(grep -rnE '^#include "' "$1" --include='*.h' --include='*.cc' --include='*.c' |
    grep -vE "#include \"($2)")
}
arrows igf/base 'igf/base/'
arrows igf 'igf/'
[[ -d rsdiff ]] && arrows rsdiff 'igf/base/|rsdiff/'
arrows evaluation 'igf/|rsdiff/|stabilizer/|evaluation/'
arrows cli/images 'igf/base/|cli/images/'
arrows cli/media 'igf/base/|cli/media/'
arrows cli/report 'igf/base/|stabilizer/|cli/images/|cli/report/'
while IFS= read -r hit; do
  complain "$hit: points up the module graph"
done < <(grep -rnE '^#include "(stabilizer/pipeline|rsdiff|cli|plugin)/' stabilizer \
  --include='*.h' --include='*.cc' | grep -v '^stabilizer/pipeline/')

# Heavy libraries stay behind .cc files, in headers that hold solver functors or libav handles.
while IFS= read -r hit; do
  complain "$hit: drags a heavy library into a public header"
done < <(grep -rnE '#include <(opencv2|ceres|libav|libsw)' igf rsdiff stabilizer evaluation cli \
  --include='*.h' |
  grep -vE '_residuals\.h|_detail\.h|igf/street/|cli/media/(av_|input_file|output_file|pixel_format|.*_internal)')

if command -v clang-format >/dev/null; then
  clang-format --dry-run --Werror "${sources[@]}" || complain "run clang-format -i on the files above"
else
  echo "clang-format is not installed: the format was not checked"
fi
exit $bad
