// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <utility>

#include "igf/base/whole_file.h"
#include "igf/camera_profile_reader.h"

namespace rsstab::igf {
namespace {

const char* NameOf(LensModel model) {
  switch (model) {
    case LensModel::kFisheye:
      return "fisheye";
    case LensModel::kBrown:
      return "brown";
    case LensModel::kPinhole:
      break;
  }
  return "pinhole";
}

nlohmann::ordered_json ToJson(const Camera& camera) {
  nlohmann::ordered_json root;
  root["width"] = camera.width;
  root["height"] = camera.height;
  root["fx"] = camera.fx;
  root["fy"] = camera.fy;
  root["cx"] = camera.cx;
  root["cy"] = camera.cy;
  if (camera.readout_s) {
    root["readout_s"] = *camera.readout_s;
  }
  root["model"] = NameOf(camera.model);
  if (!camera.distortion.empty()) {
    root["distortion"] = camera.distortion;
  }
  return root;
}

std::string ToText(const nlohmann::ordered_json& root) {
  constexpr int kIndent = 2;
  return root.dump(kIndent) + "\n";
}

}  // namespace

std::string FormatCameraJson(const Camera& camera) { return ToText(ToJson(camera)); }

std::string FormatCameraJson(const CalibratedCamera& calibrated) {
  nlohmann::ordered_json root = ToJson(calibrated.camera);
  root["readout_sigma_s"] = calibrated.readout_sigma_s;
  root["focal_sigma_px"] = calibrated.focal_sigma_px;
  root["trusted"] = calibrated.readout_trusted && calibrated.focal_trusted;
  root["readout_trusted"] = calibrated.readout_trusted;
  root["focal_trusted"] = calibrated.focal_trusted;
  return ToText(root);
}

Status WriteCameraProfile(const std::string& path, const Camera& camera) {
  if (Status status = camera.Validate(); !status) {
    return Propagate(std::move(status).error(), path);
  }
  return WriteWholeFile(path, FormatCameraJson(camera));
}

}  // namespace rsstab::igf
