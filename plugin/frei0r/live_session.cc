// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "plugin/frei0r/session.h"

namespace rsstab::frei0r {
namespace {

// Where the host passes no times, and until two frames have told.
constexpr double kAssumedFrame_s = 1.0 / 30.0;
// Containers with times in milliseconds are off by less: 33 for 33.3.
constexpr double kRateTolerance = 0.03;
constexpr double kShortestFrame_s = 1e-3;
constexpr double kLongestFrame_s = 1.0;
// A longer step is a seek of the host's.
constexpr double kSeek_s = 1.0;

class LiveSession : public Session {
 public:
  LiveSession(ParameterValues values, const PictureShape& shape)
      : values_(std::move(values)), shape_(shape), shown_(PictureBytes()) {}

  // Makes the instance, for frames that follow each other by `frame_s`; "" or why not.
  std::string Open(double frame_s);

  std::string Process(std::optional<double> time_s, const std::uint8_t* in,
                      std::uint8_t* out) override {
    const double now = time_s.value_or(last_s_ + kAssumedFrame_s);
    const double step = now - last_s_;
    if (num_frames_ > 0 && step == 0.0) {  // the host asks again for what it got
      CopyPicture(shown_.data(), out, shape_);
      return "";
    }
    if (num_frames_ > 0 && (step < 0.0 || step > std::max(kSeek_s, 2.0 * frame_s_))) {
      rsstab_reset(instance_.get());
      num_frames_ = 0;
    }
    std::string error;
    if (num_frames_ == 0) {
      first_.resize(PictureBytes());
      CopyPicture(in, first_.data(), shape_);
      CopyPicture(in, shown_.data(), shape_);  // what a delay is bridged with
    } else if (num_frames_ == 1) {
      error = FollowRate(std::clamp(step, kShortestFrame_s, kLongestFrame_s));
      first_ = {};
    }
    last_s_ = now;
    ++num_frames_;
    if (error.empty()) {
      error = Exchange(in, now);
    }
    CopyPicture(error.empty() ? shown_.data() : in, out, shape_);
    return error;
  }

  bool Accepts(const ParameterValues& values) override {
    const bool same_kind = values.rolling_shutter == values_.rolling_shutter &&
                           values.ZoomOption() == values_.ZoomOption() &&
                           values.LookaheadOption() == values_.LookaheadOption();
    values_ = values;
    return same_kind && Set("smoothness", values.SmoothnessOption()) &&
           Set("crop", values.CropOption());
  }

 private:
  [[nodiscard]] std::size_t PictureBytes() const {
    return static_cast<std::size_t>(shape_.row_bytes) * shape_.height;
  }

  bool Set(const char* name, const std::string& value) {
    return rsstab_set(instance_.get(), name, value.c_str()) == RSSTAB_OK;
  }

  // Begins anew with the first frame when the clip's rate is not the one the instance was made for.
  std::string FollowRate(double frame_s) {
    if (std::abs(frame_s - frame_s_) <= kRateTolerance * frame_s_) {
      return "";
    }
    std::string error = Open(frame_s);
    return error.empty() ? Exchange(first_.data(), last_s_) : error;
  }

  // A frame in, and the one that is ready, if any, to shown_.
  std::string Exchange(const std::uint8_t* in, double time_s) {
    const rsstab_picture picture = PictureAt(in, shape_);
    if (rsstab_push(instance_.get(), &picture, Ticks(time_s), nullptr, nullptr) < 0) {
      return rsstab_error(instance_.get());
    }
    const rsstab_buffer buffer = BufferAt(shown_.data(), shape_);
    if (rsstab_pull(instance_.get(), &buffer, nullptr, nullptr) < 0) {
      return rsstab_error(instance_.get());
    }
    return "";
  }

  ParameterValues values_;
  PictureShape shape_;
  InstanceHandle instance_;
  double frame_s_ = kAssumedFrame_s;
  std::int64_t num_frames_ = 0;  // since the start or the last seek
  double last_s_ = 0.0;
  std::vector<std::uint8_t> first_;  // until the second frame has told the rate
  std::vector<std::uint8_t> shown_;
};

std::string LiveSession::Open(double frame_s) {
  const OptionsHandle options(rsstab_options_create());
  if (!options) {
    return rsstab_status_text(RSSTAB_ERROR_OUT_OF_MEMORY);
  }
  const std::pair<const char*, std::string> wanted[] = {{"rs", values_.rolling_shutter},
                                                        {"smoothness", values_.SmoothnessOption()},
                                                        {"crop", values_.CropOption()},
                                                        {"zoom", values_.ZoomOption()},
                                                        {"lookahead", values_.LookaheadOption()}};
  for (const auto& [name, value] : wanted) {
    if (rsstab_options_set(options.get(), name, value.c_str()) != RSSTAB_OK) {
      return rsstab_options_error(options.get());
    }
  }
  rsstab_video video = DescribeVideo(shape_);
  video.frame_rate_num = kTicksPerSecond;
  video.frame_rate_den = static_cast<std::int32_t>(Ticks(frame_s));
  rsstab_instance* instance = nullptr;
  if (rsstab_create_live(options.get(), &video, &instance) != RSSTAB_OK) {
    return rsstab_options_error(options.get());
  }
  instance_.reset(instance);
  frame_s_ = frame_s;
  return "";
}

}  // namespace

SessionResult OpenLiveSession(const ParameterValues& values, const PictureShape& shape) {
  auto session = std::make_unique<LiveSession>(values, shape);
  if (std::string error = session->Open(kAssumedFrame_s); !error.empty()) {
    return {nullptr, std::move(error)};
  }
  return {std::move(session), ""};
}

}  // namespace rsstab::frei0r
