// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_MEDIA_ENCODER_CHOICE_H_
#define RSSTAB_CLI_MEDIA_ENCODER_CHOICE_H_

// Which encoder serves a wish, and in which of its own words the wish is put. Plain data, knows no
// library.

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "igf/base/result.h"

namespace rsstab::media {

struct EncoderChoice {
  std::string encoder;  // libavcodec's name
  std::string warning;  // why it is not the first choice; empty if it is
};

using EncoderIsThere = std::function<bool(const std::string& encoder)>;

// `codec` as in WriterOptions; empty means H.264, and MPEG-4 where there is no encoder for it.
// Errors: kNotFound, with the encoders that would have done.
[[nodiscard]] Result<EncoderChoice> ChooseEncoder(const std::string& codec,
                                                  const EncoderIsThere& is_there);

// How one encoder is told quality, speed and threads.
struct EncoderSettings {
  std::vector<std::pair<std::string, std::string>> options;
  // Fixed quantiser for encoders without a constant-quality scale of their own.
  std::optional<double> quantiser;
  // Bits per pixel for encoders that only know a bit rate; 0: not needed.
  double bits_per_pixel = 0.0;
};

// crf and preset as in WriterOptions, num_threads 0 = automatic.
// Errors: kInvalidArgument for a crf outside 0..63, an unknown preset name.
[[nodiscard]] Result<EncoderSettings> SettingsFor(const std::string& encoder,
                                                  std::optional<double> crf,
                                                  const std::string& preset, int num_threads);

}  // namespace rsstab::media

#endif  // RSSTAB_CLI_MEDIA_ENCODER_CHOICE_H_
