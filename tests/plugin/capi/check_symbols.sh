#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_symbols.sh LIBRARY HEADER: the library shows exactly the functions that the header declares.
set -euo pipefail
shown=$(nm -D --defined-only "$1" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort)
declared=$(grep -oE '^RSSTAB_API [^(]*\(|^ *rsstab_[a-z_]+\(' "$2" | grep -oE 'rsstab_[a-z_]+\(' |
  tr -d '(' | sort -u)
if [[ $shown != "$declared" ]]; then
  echo "shown by the library (<) and declared in the header (>) differ:"
  diff <(echo "$shown") <(echo "$declared")
  exit 1
fi
echo "$(wc -l <<<"$shown") functions"
