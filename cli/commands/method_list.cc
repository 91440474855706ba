// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/method_list.h"

#include <algorithm>
#include <sstream>

namespace rsstab::cli {
namespace {

Status AddSetting(const std::string& text, MethodSpec& method) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    return Fail(ErrorCode::kInvalidArgument,
                "--methods: '{}' of '{}' is no setting; write name=value.", text, method.name);
  }
  method.settings[text.substr(0, equals)] = text.substr(equals + 1);
  return {};
}

}  // namespace

Result<std::vector<MethodSpec>> ParseMethodList(const std::string& list) {
  std::vector<MethodSpec> methods;
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t at = part.find('@');
    if (at == std::string::npos && part.find('=') != std::string::npos) {
      // One more setting of the method before.
      if (methods.empty() || methods.back().settings.empty()) {
        return Fail(ErrorCode::kInvalidArgument,
                    "--methods: '{}' is a setting without a method; write method@{}.", part, part);
      }
      if (Status status = AddSetting(part, methods.back()); !status) {
        return Propagate(status.error());
      }
      methods.back().text += "," + part;
      continue;
    }
    MethodSpec method;
    method.text = part;
    method.name = part.substr(0, at);
    if (method.name.empty()) {
      return Fail(ErrorCode::kInvalidArgument, "--methods: '{}' names no method.", list);
    }
    if (at != std::string::npos) {
      if (Status status = AddSetting(part.substr(at + 1), method); !status) {
        return Propagate(status.error());
      }
    }
    methods.push_back(std::move(method));
  }
  std::vector<MethodSpec> distinct;
  for (MethodSpec& method : methods) {
    if (std::none_of(distinct.begin(), distinct.end(),
                     [&](const MethodSpec& other) { return other.text == method.text; })) {
      distinct.push_back(std::move(method));
    }
  }
  return distinct;
}

}  // namespace rsstab::cli
