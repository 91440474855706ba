// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_SUPPORT_TEST_PATHS_H_
#define RSSTAB_TESTS_SUPPORT_TEST_PATHS_H_

#include <filesystem>
#include <optional>
#include <string>

namespace rsstab::testing {

// A file of the optional development data (real clips, gyro logs), for example
// "clips/karma.mp4". Looked for in $RSSTAB_DATA, else in ../shared/data beside the checkout; empty
// when absent. Tests then GTEST_SKIP() with a reason.
[[nodiscard]] std::optional<std::filesystem::path> DevelopmentData(const std::string& relative);

// A file of the source tree, for example "tests/rsdiff/data/tiny_model".
[[nodiscard]] std::filesystem::path SourceFile(const std::string& relative);

// A fresh, empty folder that is removed when the object dies.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_SUPPORT_TEST_PATHS_H_
