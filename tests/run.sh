#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the project with warnings as errors and runs the whole test suite, then the suites that
# handle foreign bytes and raw pixels once more under AddressSanitizer and
# UndefinedBehaviorSanitizer, then those of the optional libtorch backend. The last line counts the
# results.
set -uo pipefail
cd "$(dirname "$0")/.."
source cmake/debian_build.sh

# What handles foreign bytes, raw pixels and threads; numerics gain nothing from a second, slow run.
sanitized_tests='^igf/(base/|.*_(axes|clock|field|log|parser|reader|track)_test)'
sanitized_tests+='|^plugin/|^cli/(images/|media/|report/|[a-z_]+_test)|^robustness/'
sanitized_tests+='|^rsdiff/(backend/)?[a-z_]+_test|^stabilizer/(analysis_file|backward_map|plane_warper)'

passed=0
failed=0
skipped=0

# finish: the closing line and the exit code, whatever happened before.
finish() {
  local line="$passed passed, $failed failed"
  if [[ $skipped -gt 0 ]]; then
    line+=", $skipped skipped"
  fi
  echo "$line"
  [[ $failed -eq 0 && $passed -gt 0 ]]
  exit
}

# step NAME COMMAND...: a step that fails counts as one failed test and ends the run.
step() {
  echo "== $1"
  shift
  if ! "$@"; then
    failed=$((failed + 1))
    finish
  fi
}

# count_of ATTRIBUTE FILE: a figure of ctest's own summary.
count_of() {
  sed -n "/<testsuite/,/>/ s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p" "$2" | head -n 1
}

# run_tests PRESET: all tests of that build; adds to the counts.
run_tests() {
  echo "== tests ($1)"
  local report="$PWD/build/$1/ctest.xml"
  rm -f "$report"
  ctest --test-dir "build/$1" --parallel 2 --output-on-failure --no-tests=error \
    --output-junit "$report" </dev/null
  if [[ ! -s $report ]]; then
    failed=$((failed + 1))
    return
  fi
  local total failures left_out
  total=$(count_of tests "$report")
  failures=$(count_of failures "$report")
  left_out=$(($(count_of skipped "$report") + $(count_of disabled "$report")))
  passed=$((passed + total - failures - left_out))
  failed=$((failed + failures))
  skipped=$((skipped + left_out))
}

step "packages" install_missing "${rsstab_build_packages[@]}" "${rsstab_check_packages[@]}"
if [[ ${RSSTAB_TEST_FFMPEG-} == 1 ]]; then
  step "packages to build FFmpeg" install_missing "${rsstab_ffmpeg_packages[@]}"
fi
step "build (release, warnings are errors)" build_preset release all -DRSSTAB_TEST_FILTER=
run_tests release
step "build (address and undefined-behaviour sanitizers)" build_preset sanitize all \
  "-DRSSTAB_TEST_FILTER=$sanitized_tests"
run_tests sanitize
step "build (libtorch)" build_preset torch all
run_tests torch
finish
