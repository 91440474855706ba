// SPDX-License-Identifier: Apache-2.0
#include "igf/camera_profile_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "igf/base/json_fields_detail.h"
#include "igf/base/whole_file.h"
#include "igf/gyro_text_rows.h"

namespace rsstab::igf {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxProfileBytes = 16ULL << 20U;
constexpr double kAspectTolerance = 0.01;
constexpr double kNoStretchTolerance = 1e-3;

Result<CameraProfile> Checked(CameraProfile profile) {
  if (Status status = profile.camera.Validate(); !status) {
    return Propagate(Error{ErrorCode::kCorruptData, std::move(status).error().message});
  }
  return profile;
}

struct ModelName {
  std::string_view name;
  LensModel model;
};
constexpr std::array<ModelName, 3> kModels = {{{"pinhole", LensModel::kPinhole},
                                               {"fisheye", LensModel::kFisheye},
                                               {"brown", LensModel::kBrown}}};

Result<LensModel> ModelFromName(const std::string& name) {
  const auto found = std::find_if(kModels.begin(), kModels.end(),
                                  [&](const ModelName& m) { return m.name == name; });
  if (found == kModels.end()) {
    return Fail(ErrorCode::kUnsupported,
                "\"model\" is {}; known are \"pinhole\", \"fisheye\" and \"brown\"", Quoted(name));
  }
  return found->model;
}

// Signed readout of a lens profile, seconds.
Result<std::optional<double>> ReadoutOf(const json& root) {
  if (const json* global = FindField(root, "global_shutter");
      global != nullptr && global->is_boolean() && global->get<bool>()) {
    return std::optional(0.0);
  }
  const Result<std::optional<double>> readout_ms = NumberField(root, "frame_readout_time");
  if (!readout_ms) {
    return Propagate(readout_ms.error());
  }
  const json* direction = FindField(root, "frame_readout_direction");
  std::string name;
  if (direction != nullptr) {
    name = direction->is_string() ? ToLower(direction->get<std::string>())
                                  : (direction->is_number_integer() ? direction->dump() : "?");
  }
  const bool is_upwards = name == "1" || name == "180" || name == "bottomtotop";
  const bool is_downwards = name.empty() || name == "0" || name == "toptobottom";
  if (!*readout_ms || (!is_upwards && !is_downwards)) {
    return std::optional<double>();  // unknown, or along columns: as good as unknown
  }
  return std::optional(**readout_ms * (is_upwards ? -1e-3 : 1e-3));
}

// Refuses what the lens profile says beyond a central projection with OpenCV's distortion.
Status CheckSupported(const json& root) {
  for (const char* key : {"input_horizontal_stretch", "input_vertical_stretch"}) {
    const Result<std::optional<double>> stretch = NumberField(root, key);
    if (!stretch) {
      return Propagate(stretch.error());
    }
    // Gyroflow writes 0 or 1 for "none".
    if (*stretch && **stretch != 0.0 && std::abs(**stretch - 1.0) > kNoStretchTolerance) {
      return Fail(ErrorCode::kUnsupported,
                  "\"{}\" is {}; stretched (anamorphic) video is not "
                  "supported",
                  key, **stretch);
    }
  }
  const Result<std::string> digital = TextField(root, "digital_lens");
  if (!digital) {
    return Propagate(digital.error());
  }
  if (!digital->empty()) {
    return Fail(ErrorCode::kUnsupported, "\"digital_lens\" is {}, which is not supported",
                Quoted(*digital));
  }
  return {};
}

// Trailing zeros say nothing; what remains must be a length that the model has.
Status SetDistortion(std::vector<double> coefficients, LensModel model, Camera* camera) {
  const std::vector<std::size_t> lengths = model == LensModel::kFisheye
                                               ? std::vector<std::size_t>{4}
                                               : std::vector<std::size_t>{4, 5, 8};
  std::size_t used = coefficients.size();
  while (used > 0 && coefficients[used - 1] == 0.0) {
    --used;
  }
  const auto length =
      std::find_if(lengths.begin(), lengths.end(), [&](std::size_t n) { return n >= used; });
  if (length == lengths.end()) {
    return Fail(ErrorCode::kUnsupported,
                "\"distortion_coeffs\" has {} coefficients; this lens model takes {}", used,
                lengths.back());
  }
  coefficients.resize(*length, 0.0);
  camera->model = model;
  camera->distortion = std::move(coefficients);
  return {};
}

Status SetMatrix(const json& fisheye, Camera* camera) {
  const json* matrix = FindField(fisheye, "camera_matrix");
  const bool is_3x3 =
      matrix != nullptr && matrix->is_array() && matrix->size() == 3 &&
      std::all_of(matrix->begin(), matrix->end(), [](const json& row) {
        return row.is_array() && row.size() == 3 &&
               std::all_of(row.begin(), row.end(), [](const json& v) { return v.is_number(); });
      });
  if (!is_3x3) {
    return Fail(ErrorCode::kCorruptData,
                "\"fisheye_params.camera_matrix\" is not a matrix of 3x3 numbers");
  }
  camera->fx = (*matrix)[0][0].get<double>();
  camera->fy = (*matrix)[1][1].get<double>();
  camera->cx = (*matrix)[0][2].get<double>();
  camera->cy = (*matrix)[1][2].get<double>();
  return {};
}

// A lens profile, or the part of a project file that is one.
const json* LensProfileIn(const json& root) {
  if (root.contains("fisheye_params")) {
    return &root;
  }
  const json* data = FindField(root, "calibration_data");
  return data != nullptr && data->is_object() && data->contains("fisheye_params") ? data : nullptr;
}

Result<bool> FlagField(const json& root, const char* key, bool otherwise) {
  const json* flag = FindField(root, key);
  if (flag == nullptr) {
    return otherwise;
  }
  if (!flag->is_boolean()) {
    return Fail(ErrorCode::kCorruptData, "\"{}\" is neither true nor false", key);
  }
  return flag->get<bool>();
}

// How sure the file is of what it says; what it does not trust is forgotten.
Status ReadCertainty(const json& root, CameraProfile* profile) {
  for (const auto& [key, sigma] : {std::pair{"focal_sigma_px", &profile->focal_sigma_px},
                                   std::pair{"readout_sigma_s", &profile->readout_sigma_s}}) {
    const Result<std::optional<double>> value = NumberField(root, key);
    if (!value) {
      return Propagate(value.error());
    }
    if (*value && !(**value >= 0.0)) {
      return Fail(ErrorCode::kCorruptData, "\"{}\" is {}; it cannot be negative", key, **value);
    }
    *sigma = *value;
  }
  const auto trusted = FlagField(root, "trusted", true);
  if (!trusted) {
    return Propagate(trusted.error());
  }
  const auto focal_trusted = FlagField(root, "focal_trusted", *trusted);
  const auto readout_trusted = FlagField(root, "readout_trusted", *trusted);
  if (!focal_trusted || !readout_trusted) {
    return Propagate(!focal_trusted ? focal_trusted.error() : readout_trusted.error());
  }
  Camera& camera = profile->camera;
  if (!*focal_trusted) {
    camera.fx = camera.fy = kFocalPrior * camera.width;
    profile->focal_is_known = false;
  }
  if (!*readout_trusted) {
    camera.readout_s.reset();
  }
  return {};
}

Result<CameraProfile> CameraFromJson(const json& root) {
  constexpr std::array<std::string_view, 14> kKeys = {"width",
                                                      "height",
                                                      "fx",
                                                      "fy",
                                                      "cx",
                                                      "cy",
                                                      "readout_s",
                                                      "model",
                                                      "distortion",
                                                      "trusted",
                                                      "focal_trusted",
                                                      "readout_trusted",
                                                      "readout_sigma_s",
                                                      "focal_sigma_px"};
  for (const auto& [key, value] : root.items()) {
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) {
      return Fail(
          ErrorCode::kCorruptData,
          "unknown key {}; a camera has width, height, fx, fy, cx, cy, readout_s, model and "
          "distortion, a calibrated one readout_sigma_s, focal_sigma_px, trusted, "
          "readout_trusted and focal_trusted as well",
          Quoted(key));
    }
  }
  const Result<int> width = SizeField(root, "width");
  const Result<int> height = SizeField(root, "height");
  if (!width || !height) {
    return Propagate(!width ? width.error() : height.error());
  }
  CameraProfile profile;
  profile.camera = Camera::Pinhole(*width, *height, kFocalPrior * *width);
  Camera& camera = profile.camera;
  const std::array<std::pair<const char*, double*>, 4> lengths = {
      {{"fx", &camera.fx}, {"fy", &camera.fy}, {"cx", &camera.cx}, {"cy", &camera.cy}}};
  for (const auto& [key, target] : lengths) {
    const Result<std::optional<double>> value = NumberField(root, key);
    if (!value) {
      return Propagate(value.error());
    }
    *target = value->value_or(*target);
  }
  const bool has_fx = FindField(root, "fx") != nullptr;
  const bool has_fy = FindField(root, "fy") != nullptr;
  profile.focal_is_known = has_fx || has_fy;
  if (has_fx != has_fy) {
    camera.fx = camera.fy = has_fx ? camera.fx : camera.fy;
  }
  const Result<std::optional<double>> readout_s = NumberField(root, "readout_s");
  const Result<std::string> model_name = TextField(root, "model");
  Result<std::vector<double>> distortion = NumbersField(root, "distortion");
  if (!readout_s || !model_name || !distortion) {
    return Propagate(!readout_s    ? readout_s.error()
                     : !model_name ? model_name.error()
                                   : distortion.error());
  }
  camera.readout_s = *readout_s;
  const Result<LensModel> model = ModelFromName(model_name->empty() ? "pinhole" : *model_name);
  if (!model) {
    return Propagate(model.error());
  }
  camera.model = *model;
  camera.distortion = *std::move(distortion);
  if (Status status = ReadCertainty(root, &profile); !status) {
    return Propagate(std::move(status).error());
  }
  return Checked(std::move(profile));
}

Result<CameraProfile> CameraFromLensProfile(const json& root) {
  const json& fisheye = root["fisheye_params"];
  if (!fisheye.is_object()) {
    return Fail(ErrorCode::kCorruptData, "\"fisheye_params\" is not an object");
  }
  const json* size = FindField(root, "calib_dimension");
  if (size == nullptr || !size->is_object()) {
    return Fail(ErrorCode::kCorruptData, "\"calib_dimension\" (an object with w and h) is missing");
  }
  const Result<int> width = SizeField(*size, "w");
  const Result<int> height = SizeField(*size, "h");
  if (!width || !height) {
    return Propagate(!width ? width.error() : height.error(), "\"calib_dimension\"");
  }
  const Result<std::string> model_name = TextField(root, "distortion_model");
  Result<std::vector<double>> coefficients = NumbersField(fisheye, "distortion_coeffs");
  const Result<std::optional<double>> readout_s = ReadoutOf(root);
  if (!model_name || !coefficients || !readout_s) {
    return Propagate(!model_name     ? model_name.error()
                     : !coefficients ? coefficients.error()
                                     : readout_s.error());
  }
  const bool is_fisheye = model_name->empty() || *model_name == "opencv_fisheye";
  if (!is_fisheye && *model_name != "opencv_standard") {
    return Fail(ErrorCode::kUnsupported,
                "\"distortion_model\" is {}; known are \"opencv_fisheye\" and \"opencv_standard\"",
                Quoted(*model_name));
  }
  CameraProfile profile;
  profile.camera.width = *width;
  profile.camera.height = *height;
  profile.camera.readout_s = *readout_s;
  const LensModel model = is_fisheye ? LensModel::kFisheye : LensModel::kBrown;
  Status status = CheckSupported(root);
  if (status) {
    status = SetMatrix(fisheye, &profile.camera);
  }
  if (status) {
    status = SetDistortion(*std::move(coefficients), model, &profile.camera);
  }
  if (!status) {
    return Propagate(std::move(status).error());
  }
  return Checked(std::move(profile));
}

}  // namespace

Result<CameraProfile> ParseCameraJson(std::string_view text) {
  return ParseJsonObject(text).and_then(CameraFromJson);
}

Result<CameraProfile> ParseLensProfile(std::string_view text) {
  return ParseJsonObject(text).and_then([](const json& root) -> Result<CameraProfile> {
    const json* profile = LensProfileIn(root);
    if (profile == nullptr) {
      return Fail(ErrorCode::kCorruptData, "\"fisheye_params\" is missing");
    }
    return CameraFromLensProfile(*profile);
  });
}

Result<CameraProfile> ProfileForVideo(const CameraProfile& profile, int width, int height) {
  const Camera& camera = profile.camera;
  if (width < 1 || height < 1) {
    return Fail(ErrorCode::kInvalidArgument, "video size {}x{} is not positive", width, height);
  }
  const double shape = static_cast<double>(camera.width) / camera.height;
  const double video_shape = static_cast<double>(width) / height;
  if (std::abs(video_shape / shape - 1.0) > kAspectTolerance) {
    return Fail(ErrorCode::kInvalidArgument,
                "the camera profile is for {}x{} (aspect {:.3f}) and the video is {}x{} ({:.3f}); "
                "use a profile of the mode that the video was recorded in",
                camera.width, camera.height, shape, width, height, video_shape);
  }
  CameraProfile fitted = profile;
  fitted.camera = camera.Rescaled(width, height);
  if (fitted.focal_sigma_px) {
    *fitted.focal_sigma_px *= static_cast<double>(width) / camera.width;
  }
  return fitted;
}

Result<CameraProfile> ReadCameraProfile(const std::string& path) {
  const Result<std::string> text = ReadWholeFile(path, kMaxProfileBytes);
  if (!text) {
    return Propagate(text.error());
  }
  Result<CameraProfile> profile =
      ParseJsonObject(*text).and_then([](const json& root) -> Result<CameraProfile> {
        const json* lens = LensProfileIn(root);
        return lens != nullptr ? CameraFromLensProfile(*lens) : CameraFromJson(root);
      });
  if (!profile) {
    return Propagate(std::move(profile).error(), path);
  }
  return profile;
}

}  // namespace rsstab::igf
