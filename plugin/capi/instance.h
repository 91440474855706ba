// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_CAPI_INSTANCE_H_
#define RSSTAB_PLUGIN_CAPI_INSTANCE_H_

#include <cstdint>
#include <memory>
#include <string>

#include "igf/base/log.h"
#include "igf/base/result.h"
#include "plugin/capi/host_frame.h"
#include "plugin/capi/picture_format.h"
#include "plugin/capi/reply.h"
#include "plugin/capi/rsstab.h"
#include "stabilizer/pipeline/online_options.h"

namespace rsstab::capi {

// What an instance is made from.
struct InstanceSetup {
  pipeline::OnlineOptions options;
  VideoFormat format;
  std::string path;  // analysis file; empty in live mode
  Logger logger;
};

// A frame about to come out.
struct NextFrame {
  std::int64_t pts = 0;
  void* frame_data = nullptr;
};

// One of the three modes; every function is the C function of its name (rsstab.h). What a mode does
// not have answers RSSTAB_ERROR_BAD_STATE.
class Instance {
 public:
  virtual ~Instance() = default;

  [[nodiscard]] virtual Reply Push(const PushedFrame& pushed) = 0;
  [[nodiscard]] virtual Reply Flush() = 0;
  [[nodiscard]] virtual Reply Peek(NextFrame& next);
  [[nodiscard]] virtual Reply Pull(const rsstab_buffer& buffer, NextFrame& next);
  [[nodiscard]] virtual Reply Render(const rsstab_picture& picture, std::int64_t pts,
                                     const rsstab_buffer& buffer);
  [[nodiscard]] virtual Reply FrameTime(std::int64_t index, std::int64_t& pts) const;
  [[nodiscard]] virtual Reply Reset();
  [[nodiscard]] virtual Reply Set(const std::string& name, const std::string& value);
  [[nodiscard]] virtual int Delay() const { return 0; }
};

// Sets option `name` of `options` from text; kNotFound when there is none.
[[nodiscard]] Status SetOption(pipeline::OnlineOptions& options, const std::string& name,
                               const std::string& value);

[[nodiscard]] Result<std::unique_ptr<Instance>> MakeApplyInstance(const InstanceSetup& setup);
[[nodiscard]] Result<std::unique_ptr<Instance>> MakeAnalyzeInstance(const InstanceSetup& setup);
[[nodiscard]] Result<std::unique_ptr<Instance>> MakeLiveInstance(const InstanceSetup& setup);

}  // namespace rsstab::capi

#endif  // RSSTAB_PLUGIN_CAPI_INSTANCE_H_
