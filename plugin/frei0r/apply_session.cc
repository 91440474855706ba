// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/session.h"

namespace rsstab::frei0r {
namespace {

class ApplySession : public Session {
 public:
  ApplySession(InstanceHandle instance, const PictureShape& shape)
      : instance_(std::move(instance)), shape_(shape) {}

  std::string Process(std::optional<double> time_s, const std::uint8_t* in,
                      std::uint8_t* out) override {
    std::int64_t pts = 0;
    if (time_s) {
      pts = Ticks(*time_s);
    } else if (rsstab_frame_time(instance_.get(), next_frame_++, &pts) != RSSTAB_OK) {
      CopyPicture(in, out, shape_);
      return rsstab_error(instance_.get());
    }
    const rsstab_picture picture = PictureAt(in, shape_);
    const rsstab_buffer buffer = BufferAt(out, shape_);
    const rsstab_status status = rsstab_render(instance_.get(), &picture, pts, &buffer);
    if (status < 0) {
      CopyPicture(in, out, shape_);
    }
    return status == RSSTAB_OK ? "" : rsstab_error(instance_.get());
  }

  // The analysis decided all that the other parameters say.
  bool Accepts(const ParameterValues& /*values*/) override { return true; }

 private:
  InstanceHandle instance_;
  PictureShape shape_;
  // A host that passes no times passes the frames from the first to the last, each once.
  std::int64_t next_frame_ = 0;
};

}  // namespace

SessionResult OpenApplySession(const std::string& path, const PictureShape& shape) {
  const OptionsHandle options(rsstab_options_create());
  if (!options) {
    return {nullptr, rsstab_status_text(RSSTAB_ERROR_OUT_OF_MEMORY)};
  }
  const rsstab_video video = DescribeVideo(shape);
  rsstab_instance* instance = nullptr;
  if (rsstab_create_apply(options.get(), &video, path.c_str(), &instance) != RSSTAB_OK) {
    return {nullptr, rsstab_options_error(options.get())};
  }
  return {std::make_unique<ApplySession>(InstanceHandle(instance), shape), ""};
}

}  // namespace rsstab::frei0r
