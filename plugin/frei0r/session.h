// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_PLUGIN_FREI0R_SESSION_H_
#define RSSTAB_PLUGIN_FREI0R_SESSION_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "plugin/capi/rsstab.h"
#include "plugin/frei0r/parameters.h"

namespace rsstab::frei0r {

// Size of the host's RGBA pictures.
struct PictureShape {
  unsigned width = 0;
  unsigned height = 0;
  std::ptrdiff_t row_bytes = 0;
};

// Timestamps are handed to the C interface in microseconds.
inline constexpr std::int32_t kTicksPerSecond = 1'000'000;

// One way of making steady frames, from when the host chose it until it chooses another. Not thread
// safe.
class Session {
 public:
  Session() = default;
  virtual ~Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Writes the answer to the frame `in` to `out`, whatever happens. `time_s`: as HostClock says.
  // Returns why the frame could not be made steady, "" when it was.
  virtual std::string Process(std::optional<double> time_s, const std::uint8_t* in,
                              std::uint8_t* out) = 0;

  // The values changed. False: they need another session.
  virtual bool Accepts(const ParameterValues& values) = 0;
};

// Either a session, or why there is none.
struct SessionResult {
  std::unique_ptr<Session> session;
  std::string error;
};

// By an analysis file; frames in any order, memory for none (apply_session.cc).
[[nodiscard]] SessionResult OpenApplySession(const std::string& path, const PictureShape& shape);
// Without one: looks ahead as far as the values say (live_session.cc).
[[nodiscard]] SessionResult OpenLiveSession(const ParameterValues& values,
                                            const PictureShape& shape);

// What the two have in common.
struct DestroyOptions {
  void operator()(rsstab_options* options) const { rsstab_options_destroy(options); }
};
struct DestroyInstance {
  void operator()(rsstab_instance* instance) const { rsstab_destroy(instance); }
};
using OptionsHandle = std::unique_ptr<rsstab_options, DestroyOptions>;
using InstanceHandle = std::unique_ptr<rsstab_instance, DestroyInstance>;

[[nodiscard]] rsstab_video DescribeVideo(const PictureShape& shape);
[[nodiscard]] rsstab_picture PictureAt(const std::uint8_t* data, const PictureShape& shape);
[[nodiscard]] rsstab_buffer BufferAt(std::uint8_t* data, const PictureShape& shape);
// Copies the pixels, not what lies between the rows.
void CopyPicture(const std::uint8_t* in, std::uint8_t* out, const PictureShape& shape);
[[nodiscard]] std::int64_t Ticks(double time_s);

}  // namespace rsstab::frei0r

#endif  // RSSTAB_PLUGIN_FREI0R_SESSION_H_
