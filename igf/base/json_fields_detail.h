// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_BASE_JSON_FIELDS_DETAIL_H_
#define RSSTAB_IGF_BASE_JSON_FIELDS_DETAIL_H_

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "igf/base/result.h"

// Reading JSON without exceptions; for .cc files only. A key whose value is null
// counts as absent. Every error is kCorruptData and names the key.
namespace rsstab {

[[nodiscard]] Result<nlohmann::json> ParseJsonObject(std::string_view text);

// The value of a key, or null.
[[nodiscard]] const nlohmann::json* FindField(const nlohmann::json& object, const char* key);

// A finite number; empty when absent.
[[nodiscard]] Result<std::optional<double>> NumberField(const nlohmann::json& object,
                                                        const char* key);

// An image side: a whole number from 1 to 65535. Must be there.
[[nodiscard]] Result<int> SizeField(const nlohmann::json& object, const char* key);

// At most 16 finite numbers; none when absent.
[[nodiscard]] Result<std::vector<double>> NumbersField(const nlohmann::json& object,
                                                       const char* key);

// Text; empty when absent.
[[nodiscard]] Result<std::string> TextField(const nlohmann::json& object, const char* key);

}  // namespace rsstab

#endif  // RSSTAB_IGF_BASE_JSON_FIELDS_DETAIL_H_
