// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_IGF_CAMERA_PROFILE_READER_H_
#define RSSTAB_IGF_CAMERA_PROFILE_READER_H_

#include <optional>
#include <string>
#include <string_view>

#include "igf/base/camera.h"
#include "igf/base/result.h"

namespace rsstab::igf {

struct CameraProfile {
  Camera camera;  // valid; of the size that the file states
  // False when the file gives no focal length, or one that it does not trust: camera then has
  // kFocalPrior times its width.
  bool focal_is_known = true;
  // One standard deviation, where the file tells: of camera.fx (px) and camera.readout_s.
  std::optional<double> focal_sigma_px;
  std::optional<double> readout_sigma_s;
};

// Focal length over image width of a camera of which nothing is known (64 degrees across).
inline constexpr double kFocalPrior = 0.8;

// Camera JSON: {"width", "height", "fx", "fy", "cx", "cy", "readout_s", "model", "distortion"}.
// Sizes and lengths in px (pixel centres at integers), readout_s signed seconds, model "pinhole",
// "fisheye" or "brown" (OpenCV's). Every key but the size may be left out: fy = fx, the centre is
// the image's, the model pinhole. A calibration adds "focal_sigma_px" and "readout_sigma_s" (one
// standard deviation), "trusted" (both values are), "focal_trusted" and "readout_trusted" (each;
// as "trusted" where left out): a value that is not trusted is as good as absent. A key that is
// none of these is refused, as it would be a typing error of one.
// Errors: kCorruptData naming the key; kUnsupported for an unknown model.
[[nodiscard]] Result<CameraProfile> ParseCameraJson(std::string_view text);

// The inverse: exact to the last bit.
[[nodiscard]] std::string FormatCameraJson(const Camera& camera);

// What a calibration found, sure or not.
struct CalibratedCamera {
  Camera camera;  // with a readout
  double focal_sigma_px = 0.0;
  double readout_sigma_s = 0.0;
  bool focal_trusted = false;
  bool readout_trusted = false;
};
[[nodiscard]] std::string FormatCameraJson(const CalibratedCamera& calibrated);

// Gyroflow's lens profile (JSON): fisheye_params.camera_matrix and .distortion_coeffs at
// calib_dimension, distortion_model (OpenCV fisheye when absent; "opencv_standard" is Brown),
// frame_readout_time (ms) with its direction, global_shutter. Calibration data of the first
// Gyroflow's project files ("calibration_data") are of the same form.
// Errors: kCorruptData naming the key; kUnsupported for other lens models, for digital lenses
// (SuperView ..) and for anamorphic stretch.
[[nodiscard]] Result<CameraProfile> ParseLensProfile(std::string_view text);

// The profile for a video of another size. Sizes of one shape (aspect ratio within 1 %) are taken
// for the same picture, scaled. Another shape means that the camera crops its sensor in a way that
// the profile does not tell, and is refused: kInvalidArgument.
[[nodiscard]] Result<CameraProfile> ProfileForVideo(const CameraProfile& profile, int width,
                                                    int height);

// Reads a camera JSON or a lens profile (told apart by content). Every error names the file.
// Errors: kNotFound, kIo, and those of the parsers. Any thread.
[[nodiscard]] Result<CameraProfile> ReadCameraProfile(const std::string& path);

// Writes a camera JSON, completely or not at all. Errors: of StagedFile, of an invalid camera; kIo.
[[nodiscard]] Status WriteCameraProfile(const std::string& path, const Camera& camera);

}  // namespace rsstab::igf

#endif  // RSSTAB_IGF_CAMERA_PROFILE_READER_H_
