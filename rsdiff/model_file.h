// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_RSDIFF_MODEL_FILE_H_
#define RSSTAB_RSDIFF_MODEL_FILE_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "igf/base/result.h"
#include "rsdiff/ddim_sampler.h"
#include "rsdiff/noise_schedule.h"
#include "rsdiff/tensor.h"

namespace rsstab::rsdiff {

enum class NetworkLibrary { kOpenCvDnn, kTorch };

enum class ConditionKind {
  kRgb,                // 3 x rows x columns, the picture itself
  kOrientationPlanes,  // C x rows x columns, see orientation_planes.h
};

enum class MotionKind {
  kRotationCurve,  // 3 x bands x 1, see rotation_curve.h
  kDenseField,     // 2 x rows x columns, see dense_field.h
};

enum class ReferenceRow { kMiddle, kFirst };

// One file with weights.
struct WeightFile {
  std::filesystem::path path;  // absolute, or relative to the current folder
  std::string sha256;          // 64 hexadecimal digits, lower case
  int batch = 0;               // denoisers: the batch size it was exported for; others 0
};

// What a model file says of a network. The file is JSON:
//   {"format": "rs-stabilize model", "version": 1, "name": "compact",
//    "backend": "opencv-dnn",                 or "torch"
//    "condition": {"kind": "orientation-planes", "channels": 73, "rows": 24, "columns": 16},
//                                             or "rgb" with 3 channels
//    "motion": {"kind": "rotation-curve", "bands": 24, "scale": [0.01, 0.01, 0.02]},
//                                             or {"kind": "dense-field", "rows": 64, "columns": 64,
//                                                 "reference_row": "first"}   (or "middle")
//    "diffusion": {"steps": 1000, "schedule": "linear", "objective": "x0"},
//                                             schedule "linear", "cosine"; objective "x0", "noise",
//                                             "v"
//    "sampling": {"steps": 4, "eta": 0, "clip_range": 1, "guidance": 1, "guidance_rescale": 0,
//                 "spread_scale": 1},         all but "steps" optional
//    "time_embedding": {"size": 16},          opencv-dnn only, see time_embedding.h
//    "weights": {"encoder": {"file": "encoder.onnx", "sha256": "..."},
//                "denoiser": [{"file": "denoiser_1.onnx", "sha256": "...", "batch": 1},
//                             {"file": "denoiser_8.onnx", "sha256": "...", "batch": 8}]}}
//                                             torch: {"network": {"file": .., "sha256": ..}}
// Files are named relative to the JSON's folder and lie in it. Other keys are left to whoever
// trained the model ("training", "card").
struct ModelInfo {
  std::filesystem::path file;  // the JSON
  std::string name;
  NetworkLibrary library = NetworkLibrary::kOpenCvDnn;
  ConditionKind condition_kind = ConditionKind::kRgb;
  Shape condition;
  MotionKind motion_kind = MotionKind::kRotationCurve;
  Shape motion;
  // Rotation curves: value of (a, b, r) at network unit 1.
  Eigen::Vector3d curve_scale = Eigen::Vector3d::Ones();
  // Dense fields: the row on which the network's fields are zero.
  ReferenceRow reference_row = ReferenceRow::kMiddle;
  ScheduleKind schedule = ScheduleKind::kLinear;
  int diffusion_steps = 1000;
  Objective objective = Objective::kX0;
  DdimOptions sampling;  // the defaults of this model
  // Samples' distance from their mean is multiplied by it: few steps draw them too close together,
  // and by how much is measured when the model is made.
  double spread_scale = 1.0;
  int time_embedding_size = 0;        // opencv-dnn
  WeightFile encoder;                 // opencv-dnn
  std::vector<WeightFile> denoisers;  // opencv-dnn, ascending batch size, at least one
  WeightFile network;                 // torch
};

// Reads a model file. `path` names the JSON or the folder with a model.json in it. Weight files are
// not touched.
// Errors: kNotFound, kIo; kCorruptData for what is not such a file or contradicts itself;
// kUnsupported for a version, kind or backend that this program does not know.
[[nodiscard]] Result<ModelInfo> ReadModelFile(const std::filesystem::path& path);

// The bytes of a weight file, after comparing their SHA-256 with what the model file says.
// Errors: kNotFound, kIo; kCorruptData when the checksum differs.
[[nodiscard]] Result<std::string> ReadWeights(const WeightFile& weights);

// SHA-256 of some bytes, 64 lower-case hexadecimal digits.
[[nodiscard]] Result<std::string> Sha256(const std::string& bytes);

}  // namespace rsstab::rsdiff

#endif  // RSSTAB_RSDIFF_MODEL_FILE_H_
