// SPDX-License-Identifier: Apache-2.0
#include "plugin/frei0r/effect.h"

#include <utility>

#include "plugin/frei0r/analysis_path.h"
#include "plugin/frei0r/say_once.h"

namespace rsstab::frei0r {

void Effect::Update(double host_time, const std::uint32_t* in, std::uint32_t* out,
                    const void* return_address) {
  if (!clock_) {
    MeetHost(return_address);
  }
  if (std::exchange(changed_, false)) {
    FollowParameters();
  }
  const auto* source = reinterpret_cast<const std::uint8_t*>(in);
  auto* target = reinterpret_cast<std::uint8_t*>(out);
  const std::optional<double> time_s = clock_->Seconds(host_time);
  if (!session_) {
    CopyPicture(source, target, shape_);
    return;
  }
  if (const std::string reason = session_->Process(time_s, source, target); !reason.empty()) {
    Complain(reason);
  }
}

void Effect::MeetHost(const void* return_address) {
  const HostTraits host = TraitsOfCaller(return_address);
  clock_.emplace(host.time_unit);
  shape_ = {width_, height_, RowBytes(host, width_)};
}

void Effect::FollowParameters() {
  std::string path = AnalysisPath(values_.analysis_file);
  if (session_ && path == path_ && session_->Accepts(values_)) {
    return;
  }
  path_ = std::move(path);
  session_.reset();  // its memory and threads go before new ones come
  SessionResult result =
      path_.empty() ? OpenLiveSession(values_, shape_) : OpenApplySession(path_, shape_);
  session_ = std::move(result.session);
  complained_ = false;
  if (!session_) {
    Complain(result.error);
  }
}

void Effect::Complain(const std::string& reason) {
  if (!std::exchange(complained_, true)) {
    SayOnce(reason + "; frames pass through unchanged");
  }
}

}  // namespace rsstab::frei0r
