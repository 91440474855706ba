// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/model_file.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "igf/base/json_fields_detail.h"
#include "igf/base/whole_file.h"
#include "rsdiff/orientation_planes.h"

namespace rsstab::rsdiff {
namespace {

using nlohmann::json;

constexpr std::string_view kFormat = "rs-stabilize model";
constexpr int kVersion = 1;
constexpr std::uint64_t kMaxModelBytes = 1U << 20U;
constexpr std::uint64_t kMaxWeightBytes = std::uint64_t{2} << 30U;
constexpr int kMaxSide = 4096;
constexpr int kMaxBatch = 1024;
constexpr std::size_t kMaxDenoisers = 16;

template <typename Enum, std::size_t N>
using Names = std::array<std::pair<std::string_view, Enum>, N>;

constexpr Names<NetworkLibrary, 2> kLibraries = {
    {{"opencv-dnn", NetworkLibrary::kOpenCvDnn}, {"torch", NetworkLibrary::kTorch}}};
constexpr Names<ConditionKind, 2> kConditions = {
    {{"rgb", ConditionKind::kRgb}, {"orientation-planes", ConditionKind::kOrientationPlanes}}};
constexpr Names<MotionKind, 2> kMotions = {
    {{"rotation-curve", MotionKind::kRotationCurve}, {"dense-field", MotionKind::kDenseField}}};
constexpr Names<ReferenceRow, 2> kReferences = {
    {{"middle", ReferenceRow::kMiddle}, {"first", ReferenceRow::kFirst}}};
constexpr Names<ScheduleKind, 2> kSchedules = {
    {{"linear", ScheduleKind::kLinear}, {"cosine", ScheduleKind::kCosine}}};
constexpr Names<Objective, 3> kObjectives = {
    {{"x0", Objective::kX0}, {"noise", Objective::kNoise}, {"v", Objective::kV}}};

// One JSON object of the file, with the first thing that was wrong. Readers below return a value
// of no meaning once something was wrong, so that only the end has to ask.
class Fields {
 public:
  Fields(const json& object, std::string where, Status& status)
      : object_(object), where_(std::move(where)), status_(status) {}

  // The object under a key; must be there.
  [[nodiscard]] Fields Object(const char* key) const {
    static const json kEmpty = json::object();
    const json* found = FindField(object_, key);
    const std::string name = where_ + key + ".";
    if (found == nullptr || !found->is_object()) {
      Complain(ErrorCode::kCorruptData,
               fmt::format("\"{}{}\" is missing or no object", where_, key));
      return {kEmpty, name, status_};
    }
    return {*found, name, status_};
  }

  [[nodiscard]] double Number(const char* key, double low, double high,
                              std::optional<double> otherwise = {}) const {
    const auto number = NumberField(object_, key);
    if (!number) {
      Complain(number.error().code, where_ + ": " + number.error().message);
      return low;
    }
    const std::optional<double> value = *number ? *number : otherwise;
    if (!value) {
      Complain(ErrorCode::kCorruptData, fmt::format("\"{}{}\" is missing", where_, key));
      return low;
    }
    if (!(*value >= low && *value <= high)) {
      Complain(ErrorCode::kCorruptData,
               fmt::format("\"{}{}\" is {}, not within {} and {}", where_, key, *value, low, high));
      return low;
    }
    return *value;
  }

  [[nodiscard]] int Whole(const char* key, int low, int high,
                          std::optional<double> otherwise = {}) const {
    const double value = Number(key, low, high, otherwise);
    if (value != std::floor(value)) {
      Complain(ErrorCode::kCorruptData,
               fmt::format("\"{}{}\" is {}, not a whole number", where_, key, value));
      return low;
    }
    return static_cast<int>(value);
  }

  [[nodiscard]] std::string Text(const char* key) const {
    auto text = TextField(object_, key);
    if (!text || text->empty()) {
      Complain(ErrorCode::kCorruptData, fmt::format("\"{}{}\" is missing or no text", where_, key));
      return {};
    }
    return std::move(*text);
  }

  template <typename Enum, std::size_t N>
  [[nodiscard]] Enum Choice(const char* key, const Names<Enum, N>& names) const {
    const std::string text = Text(key);
    std::string known;
    for (const auto& [name, value] : names) {
      if (text == name) {
        return value;
      }
      known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", name);
    }
    Complain(ErrorCode::kUnsupported,
             fmt::format("\"{}{}\" is \"{}\"; this program knows {}", where_, key, text, known));
    return names.front().second;
  }

  [[nodiscard]] const json* Find(const char* key) const { return FindField(object_, key); }

  void Complain(ErrorCode code, std::string message) const {
    if (status_) {
      status_ = tl::unexpected<Error>(Error{code, std::move(message)});
    }
  }

 private:
  const json& object_;
  std::string where_;  // "motion.", for messages
  Status& status_;
};

void ReadCondition(const Fields& fields, ModelInfo& info) {
  info.condition_kind = fields.Choice("kind", kConditions);
  info.condition = {fields.Whole("channels", 1, kMaxSide), fields.Whole("rows", 1, kMaxSide),
                    fields.Whole("columns", 1, kMaxSide)};
  if (info.condition_kind == ConditionKind::kRgb && info.condition.channels != 3) {
    fields.Complain(ErrorCode::kCorruptData, "a condition of kind \"rgb\" has 3 channels");
  }
  if (info.condition_kind == ConditionKind::kOrientationPlanes &&
      info.condition != kOrientationShape) {
    fields.Complain(
        ErrorCode::kUnsupported,
        fmt::format("orientation planes of {}x{}x{} are not known to this program, "
                    "which makes {}x{}x{}",
                    info.condition.channels, info.condition.rows, info.condition.columns,
                    kOrientationShape.channels, kOrientationShape.rows, kOrientationShape.columns));
  }
}

void ReadMotion(const Fields& fields, ModelInfo& info) {
  info.motion_kind = fields.Choice("kind", kMotions);
  if (info.motion_kind == MotionKind::kDenseField) {
    info.motion = {2, fields.Whole("rows", 2, kMaxSide), fields.Whole("columns", 2, kMaxSide)};
    info.reference_row = fields.Choice("reference_row", kReferences);
    return;
  }
  info.motion = {3, fields.Whole("bands", 1, kMaxSide), 1};
  const json* scale = fields.Find("scale");
  const bool three = scale != nullptr && scale->is_array() && scale->size() == 3;
  for (int c = 0; c < 3; ++c) {
    const json* value = three ? &(*scale)[static_cast<std::size_t>(c)] : nullptr;
    if (value == nullptr || !value->is_number() || !std::isfinite(value->get<double>()) ||
        value->get<double>() <= 0.0) {
      fields.Complain(ErrorCode::kCorruptData,
                      "\"motion.scale\" is not a list of 3 numbers above 0");
      return;
    }
    info.curve_scale[c] = value->get<double>();
  }
}

void ReadDiffusion(const Fields& root, ModelInfo& info) {
  const Fields diffusion = root.Object("diffusion");
  info.diffusion_steps = diffusion.Whole("steps", 1, 100000);
  info.schedule = diffusion.Choice("schedule", kSchedules);
  info.objective = diffusion.Choice("objective", kObjectives);
  const Fields sampling = root.Object("sampling");
  const DdimOptions plain;
  info.sampling.steps = sampling.Whole("steps", 1, info.diffusion_steps);
  info.sampling.eta = sampling.Number("eta", 0.0, 1.0, plain.eta);
  info.sampling.clip_range = sampling.Number("clip_range", 1e-6, 1e6, plain.clip_range);
  info.sampling.guidance = sampling.Number("guidance", 0.0, 100.0, plain.guidance);
  info.sampling.guidance_rescale =
      sampling.Number("guidance_rescale", 0.0, 1.0, plain.guidance_rescale);
  info.spread_scale = sampling.Number("spread_scale", 0.01, 100.0, info.spread_scale);
}

WeightFile ReadWeight(const Fields& fields, const std::filesystem::path& folder) {
  const std::filesystem::path name = fields.Text("file");
  if (name.has_parent_path() || name == "." || name == "..") {
    fields.Complain(
        ErrorCode::kCorruptData,
        fmt::format("weight file \"{}\" must lie in the model's own folder", name.string()));
  }
  WeightFile weights{folder / name, fields.Text("sha256"), 0};
  const bool is_digest = weights.sha256.size() == 64 &&
                         weights.sha256.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!is_digest) {
    fields.Complain(ErrorCode::kCorruptData,
                    fmt::format("the \"sha256\" of weight file \"{}\" is not 64 lower-case "
                                "hexadecimal digits",
                                name.string()));
  }
  return weights;
}

void ReadOnnxParts(const Fields& root, const std::filesystem::path& folder, Status& status,
                   ModelInfo& info) {
  info.time_embedding_size = root.Object("time_embedding").Whole("size", 2, 65536);
  if (info.time_embedding_size % 2 != 0) {
    root.Complain(ErrorCode::kCorruptData, "\"time_embedding.size\" must be even");
  }
  const Fields weights = root.Object("weights");
  info.encoder = ReadWeight(weights.Object("encoder"), folder);
  const json* list = weights.Find("denoiser");
  if (list == nullptr || !list->is_array() || list->empty() || list->size() > kMaxDenoisers) {
    root.Complain(ErrorCode::kCorruptData,
                  "\"weights.denoiser\" is not a list of at least one file");
    return;
  }
  for (const json& element : *list) {
    if (!element.is_object()) {
      root.Complain(ErrorCode::kCorruptData, "\"weights.denoiser\" holds what is no object");
      return;
    }
    const Fields fields(element, "weights.denoiser.", status);
    info.denoisers.push_back(ReadWeight(fields, folder));
    info.denoisers.back().batch = fields.Whole("batch", 1, kMaxBatch);
  }
  std::sort(info.denoisers.begin(), info.denoisers.end(),
            [](const WeightFile& a, const WeightFile& b) { return a.batch < b.batch; });
}

Result<ModelInfo> ParseModel(const std::string& text, const std::filesystem::path& file) {
  const Result<json> parsed = ParseJsonObject(text);
  if (!parsed) {
    return Propagate(parsed.error());
  }
  Status status;
  const Fields root(*parsed, "", status);
  if (const std::string format = root.Text("format"); format != kFormat) {
    return Fail(ErrorCode::kCorruptData, "not a model file: its \"format\" is not \"{}\"", kFormat);
  }
  if (const double version = root.Number("version", 0.0, 1e9); status && version != kVersion) {
    return Fail(ErrorCode::kUnsupported,
                "model file version {} is not known to this program, which reads version {}",
                version, kVersion);
  }
  ModelInfo info;
  info.file = file;
  info.name = root.Text("name");
  info.library = root.Choice("backend", kLibraries);
  ReadCondition(root.Object("condition"), info);
  ReadMotion(root.Object("motion"), info);
  ReadDiffusion(root, info);
  if (info.library == NetworkLibrary::kOpenCvDnn) {
    ReadOnnxParts(root, file.parent_path(), status, info);
  } else {
    info.network = ReadWeight(root.Object("weights").Object("network"), file.parent_path());
  }
  if (!status) {
    return Propagate(status.error());
  }
  return info;
}

}  // namespace

Result<ModelInfo> ReadModelFile(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::filesystem::path file =
      std::filesystem::is_directory(path, ignored) ? path / "model.json" : path;
  const Result<std::string> text = ReadWholeFile(file.string(), kMaxModelBytes);
  if (!text) {
    return Propagate(text.error(), "model");
  }
  Result<ModelInfo> info = ParseModel(*text, file);
  if (!info) {
    return Propagate(info.error(), "model " + file.string());
  }
  return info;
}

Result<std::string> ReadWeights(const WeightFile& weights) {
  Result<std::string> bytes = ReadWholeFile(weights.path.string(), kMaxWeightBytes);
  if (!bytes) {
    return Propagate(bytes.error(), "model weights");
  }
  const Result<std::string> digest = Sha256(*bytes);
  if (!digest) {
    return Propagate(digest.error());
  }
  if (*digest != weights.sha256) {
    return Fail(ErrorCode::kCorruptData,
                "model weights: {} is damaged or belongs to another model (its SHA-256 is {}, the "
                "model file says {}); install the model again",
                weights.path.string(), *digest, weights.sha256);
  }
  return bytes;
}

Result<std::string> Sha256(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1) {
    return Fail(ErrorCode::kInternal, "the cryptography library computes no SHA-256");
  }
  std::string text;
  for (unsigned int i = 0; i < length; ++i) {
    text += fmt::format("{:02x}", digest[i]);
  }
  return text;
}

}  // namespace rsstab::rsdiff
