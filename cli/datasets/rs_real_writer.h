// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_CLI_DATASETS_RS_REAL_WRITER_H_
#define RSSTAB_CLI_DATASETS_RS_REAL_WRITER_H_

#include <cstdint>
#include <filesystem>
#include <string>

#include "evaluation/hand_motion.h"
#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/result.h"

namespace rsstab::datasets {

// One clip (or, of one frame, one sample) of a made-up RS-Real set.
struct RsRealClip {
  std::string split;  // "train" or "test"
  std::string name;   // "0007"; of several frames "seq_0007"
  int frames = 1;
  std::string source;  // the photograph's name
  const evaluation::MotionStrength* strength = nullptr;
  Camera camera;  // with its readout time
  double frame_interval_s = 1.0 / 30.0;
  double image_noise = 2.0;       // 8-bit levels, of the RS pictures
  double gyro_rate_hz = 1000.0;   // of the log beside each sample
  double gyro_noise_rad_s = 0.0;  // standard deviation per axis and sample
  double gyro_bias_rad_s = 0.0;   // length of a constant error
  std::uint64_t seed = 1;
};

// Records a photograph (packed 8-bit RGB) along a motion and writes what rs_real_set.h reads, into
// folder/train/npz or folder/test/npz, pictures of the test split also into folder/test/jpg. As in
// RS-Real the first row is the reference, and GS pixels without a source in the RS picture are
// black. Labels are exact; files that exist are replaced.
// Errors: those of MakeHandMotion and PhotoScene; kIo.
[[nodiscard]] Status WriteRsRealClip(const std::filesystem::path& folder, const FrameView& photo,
                                     const RsRealClip& clip);

}  // namespace rsstab::datasets

#endif  // RSSTAB_CLI_DATASETS_RS_REAL_WRITER_H_
