// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/say_once.h"

#include <cstdio>
#include <mutex>
#include <set>

namespace rsstab::frei0r {
namespace {

// An editor may run for days.
constexpr std::size_t kMostTexts = 64;

}  // namespace

void SayOnce(const std::string& text) {
  // The one thing that instances share.
  static std::mutex mutex;
  static std::set<std::string> said;
  const std::lock_guard<std::mutex> lock(mutex);
  if (said.size() < kMostTexts && said.insert(text).second) {
    std::fprintf(stderr, "rsstabilize: %s\n", text.c_str());
  }
}

}  // namespace rsstab::frei0r
