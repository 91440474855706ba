// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test_paths.h"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

namespace rsstab::testing {

std::optional<std::filesystem::path> DevelopmentData(const std::string& relative) {
  const char* variable = std::getenv("RSSTAB_DATA");
  const std::filesystem::path root =
      variable != nullptr ? std::filesystem::path(variable)
                          : std::filesystem::path(RSSTAB_SOURCE_DIR) / "../shared/data";
  std::filesystem::path file = root / relative;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    return std::nullopt;
  }
  return file;
}

std::filesystem::path SourceFile(const std::string& relative) {
  return std::filesystem::path(RSSTAB_SOURCE_DIR) / relative;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "rsstab-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) {
    throw std::runtime_error("cannot make a temporary folder");
  }
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rsstab::testing
