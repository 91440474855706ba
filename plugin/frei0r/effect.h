// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_EFFECT_H_
#define RSSTAB_PLUGIN_FREI0R_EFFECT_H_

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "plugin/frei0r/host.h"
#include "plugin/frei0r/host_clock.h"
#include "plugin/frei0r/parameters.h"
#include "plugin/frei0r/session.h"

namespace rsstab::frei0r {

// One instance of the plugin. One call at a time (frei0r.h); distinct instances share nothing.
class Effect {
 public:
  Effect(unsigned width, unsigned height) : width_(width), height_(height) {}

  void SetText(int index, const char* text) { changed_ |= values_.SetText(index, text); }
  void SetNumber(int index, double number) { changed_ |= values_.SetNumber(index, number); }
  [[nodiscard]] const ParameterValues& values() const { return values_; }

  // One RGBA picture of the size in, one out; `return_address`: of the host's call. A frame that
  // cannot be made steady passes through, and the reason is printed; once, until the parameters
  // change.
  void Update(double host_time, const std::uint32_t* in, std::uint32_t* out,
              const void* return_address);

 private:
  void MeetHost(const void* return_address);
  void FollowParameters();
  void Complain(const std::string& reason);

  unsigned width_;
  unsigned height_;
  ParameterValues values_;
  bool changed_ = true;
  std::string path_;
  PictureShape shape_;
  std::optional<HostClock> clock_;
  std::unique_ptr<Session> session_;
  bool complained_ = false;
};

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_EFFECT_H_
