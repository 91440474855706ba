// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_TESTS_RSDIFF_REFERENCE_MODELS_H_
#define RSSTAB_TESTS_RSDIFF_REFERENCE_MODELS_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <string>

#include "rsdiff/tensor.h"
#include "tests/cli/images/npz_reader.h"

namespace rsstab::testing {

// A model folder that data/make_reference_models.py wrote ("small", "published"); empty when there
// is none.
[[nodiscard]] inline std::filesystem::path ReferenceModel(const std::string& name) {
  const char* root = std::getenv("RSSTAB_REFERENCE_MODELS");
  const std::filesystem::path folder = std::filesystem::path(root == nullptr ? "" : root) / name;
  return std::filesystem::exists(folder / "model.json") ? folder : std::filesystem::path();
}

// The arrays of a model folder's answers.npz.
class Answers {
 public:
  Answers() = default;
  explicit Answers(const std::filesystem::path& folder) {
    std::ifstream file(folder / "answers.npz", std::ios::binary);
    arrays_ = ReadNpz(std::string(std::istreambuf_iterator<char>(file), {}));
  }

  // As many items of a shape as there are. Throws std::out_of_range for a name that is absent.
  [[nodiscard]] rsdiff::Tensor Get(const std::string& name, const rsdiff::Shape& shape) const {
    rsdiff::Tensor tensor;
    tensor.values = arrays_.at(name + ".npy").values;
    tensor.shape = shape;
    tensor.batch = static_cast<int>(tensor.values.size() / shape.Count());
    return tensor;
  }

 private:
  std::map<std::string, NpyContent> arrays_;
};

// Infinite for tensors of unlike size.
[[nodiscard]] inline double LargestDifference(const rsdiff::Tensor& a, const rsdiff::Tensor& b) {
  if (a.values.empty() || a.values.size() != b.values.size()) {
    return std::numeric_limits<double>::infinity();
  }
  double largest = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(a.values[i] - b.values[i])));
  }
  return largest;
}

}  // namespace rsstab::testing

#endif  // RSSTAB_TESTS_RSDIFF_REFERENCE_MODELS_H_
