// SPDX-License-Identifier: Apache-2.0
#include "igf/base/json_fields_detail.h"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

namespace rsstab {
namespace {

constexpr int kMaxSize = 65535;    // as AllocateFrame
constexpr std::size_t kMost = 16;  // numbers in a list

}  // namespace

using nlohmann::json;

const json* FindField(const json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

Result<std::optional<double>> NumberField(const json& object, const char* key) {
  const json* value = FindField(object, key);
  if (value == nullptr) {
    return std::optional<double>();
  }
  if (!value->is_number() || !std::isfinite(value->get<double>())) {
    return Fail(ErrorCode::kCorruptData, "\"{}\" is not a finite number", key);
  }
  return std::optional(value->get<double>());
}

Result<int> SizeField(const json& object, const char* key) {
  const Result<std::optional<double>> value = NumberField(object, key);
  if (!value) {
    return Propagate(value.error());
  }
  if (!*value) {
    return Fail(ErrorCode::kCorruptData, "\"{}\" is missing", key);
  }
  const double size = **value;
  if (!(size >= 1.0 && size <= kMaxSize && size == std::floor(size))) {
    return Fail(ErrorCode::kCorruptData, "\"{}\" is {}, not a whole number from 1 to {}", key, size,
                kMaxSize);
  }
  return static_cast<int>(size);
}

Result<std::vector<double>> NumbersField(const json& object, const char* key) {
  std::vector<double> numbers;
  const json* value = FindField(object, key);
  if (value == nullptr) {
    return numbers;
  }
  if (!value->is_array() || value->size() > kMost) {
    return Fail(ErrorCode::kCorruptData, "\"{}\" is not a list of at most {} numbers", key, kMost);
  }
  for (const json& element : *value) {
    if (!element.is_number() || !std::isfinite(element.get<double>())) {
      return Fail(ErrorCode::kCorruptData, "\"{}\"[{}] is not a finite number", key,
                  numbers.size());
    }
    numbers.push_back(element.get<double>());
  }
  return numbers;
}

Result<std::string> TextField(const json& object, const char* key) {
  const json* value = FindField(object, key);
  if (value == nullptr) {
    return std::string();
  }
  if (!value->is_string()) {
    return Fail(ErrorCode::kCorruptData, "\"{}\" is not text", key);
  }
  return value->get<std::string>();
}

Result<json> ParseJsonObject(std::string_view text) {
  json root = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!root.is_object()) {
    return Fail(ErrorCode::kCorruptData, "not a whole JSON object; it may be cut off");
  }
  return root;
}

}  // namespace rsstab
