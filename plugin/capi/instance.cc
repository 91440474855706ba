// SPDX-License-Identifier: Apache-2.0
#include "plugin/capi/instance.h"

#include <algorithm>

namespace rsstab::capi {
namespace {

Reply NotHere(const char* what) {
  return {RSSTAB_ERROR_BAD_STATE, std::string("an instance of this mode has no ") + what};
}

}  // namespace

Reply Instance::Peek(NextFrame& /*next*/) { return NotHere("frames to give"); }
Reply Instance::Pull(const rsstab_buffer& /*buffer*/, NextFrame& /*next*/) {
  return NotHere("frames to give");
}
Reply Instance::Render(const rsstab_picture& /*picture*/, std::int64_t /*pts*/,
                       const rsstab_buffer& /*buffer*/) {
  return NotHere("rsstab_render(); push and pull");
}
Reply Instance::FrameTime(std::int64_t /*index*/, std::int64_t& /*pts*/) const {
  return NotHere("analysis file to ask");
}
Reply Instance::Reset() { return NotHere("second beginning"); }
Reply Instance::Set(const std::string& name, const std::string& /*value*/) {
  return {RSSTAB_ERROR_UNSUPPORTED,
          "the option '" + name + "' cannot be changed in an instance of this mode"};
}

Status SetOption(pipeline::OnlineOptions& options, const std::string& name,
                 const std::string& value) {
  const auto& table = pipeline::OnlineOptionTable();
  const auto spec = std::find_if(table.begin(), table.end(),
                                 [&name](const auto& option) { return option.name == name; });
  if (spec == table.end()) {
    return Fail(ErrorCode::kNotFound, "there is no option '{}'", name);
  }
  return spec->set(options, value);
}

}  // namespace rsstab::capi
