// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/backend/opencv_dnn_denoiser.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rsdiff/time_embedding.h"

namespace rsstab::rsdiff {
namespace {

using cv::dnn::Backend;
using cv::dnn::Target;

struct Device {
  std::string_view name;
  Backend backend;
  Target target;
};
constexpr std::array<Device, 5> kDevices = {{
    {"auto", cv::dnn::DNN_BACKEND_OPENCV, cv::dnn::DNN_TARGET_CPU},
    {"cpu", cv::dnn::DNN_BACKEND_OPENCV, cv::dnn::DNN_TARGET_CPU},
    {"cuda", cv::dnn::DNN_BACKEND_CUDA, cv::dnn::DNN_TARGET_CUDA},
    {"opencl", cv::dnn::DNN_BACKEND_OPENCV, cv::dnn::DNN_TARGET_OPENCL},
    {"openvino", cv::dnn::DNN_BACKEND_INFERENCE_ENGINE, cv::dnn::DNN_TARGET_CPU},
}};

bool IsAvailable(const Device& device) {
  const std::vector<Target> targets = cv::dnn::getAvailableTargets(device.backend);
  return std::find(targets.begin(), targets.end(), device.target) != targets.end();
}

Result<Device> FindDevice(const std::string& name) {
  std::string available;
  for (const Device& device : kDevices) {
    if (!IsAvailable(device)) {
      continue;
    }
    if (device.name == name) {
      return device;
    }
    available += fmt::format("{}{}", available.empty() ? "" : ", ", device.name);
  }
  return Fail(ErrorCode::kUnsupported,
              "this OpenCV cannot run networks on the device \"{}\"; it can on: {}", name,
              available);
}

// OpenCV's own message, without the line breaks and places in its source.
std::string Reason(const cv::Exception& e) {
  std::string text = e.err.empty() ? e.what() : e.err;
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// OpenCV prints what it throws. While this lives it does not, since the error says it.
class QuietOpenCv {
 public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

std::vector<int> Sizes(int batch, const Shape& shape) {
  return {batch, shape.channels, shape.rows, shape.columns};
}

std::string SizesText(const cv::Mat& mat) {
  std::string text;
  for (int i = 0; i < mat.dims; ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : "x", mat.size[i]);
  }
  return text;
}

Result<cv::dnn::Net> LoadNet(const WeightFile& weights, const Device& device) {
  const Result<std::string> bytes = ReadWeights(weights);
  if (!bytes) {
    return Propagate(bytes.error());
  }
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes->data(), bytes->size());
    net.setPreferableBackend(device.backend);
    net.setPreferableTarget(device.target);
    return net;
  } catch (const cv::Exception& e) {
    return Fail(ErrorCode::kCorruptData, "{}: not a network that this OpenCV can run: {}",
                weights.path.string(), Reason(e));
  }
}

// A denoiser exported for one batch size, with its repeated inputs.
struct Piece {
  int batch = 0;
  cv::dnn::Net net;
  cv::Mat image_features;  // of the last image, `batch` times; empty until asked for
  cv::Mat no_features;
};

// `one` (first dimension 1) `batch` times along the first dimension.
cv::Mat Repeat(const cv::Mat& one, int batch) {
  std::vector<int> sizes(one.size.p, one.size.p + one.dims);
  sizes[0] = batch;
  cv::Mat all(sizes, CV_32F);
  for (int i = 0; i < batch; ++i) {
    std::memcpy(all.ptr<float>(i), one.ptr<float>(), one.total() * sizeof(float));
  }
  return all;
}

class OpenCvDnnDenoiser final : public Denoiser {
 public:
  OpenCvDnnDenoiser(const ModelInfo& model, const cv::dnn::Net& encoder, std::vector<Piece> pieces)
      : state_shape_(model.motion),
        condition_shape_(model.condition),
        diffusion_steps_(model.diffusion_steps),
        embedding_size_(model.time_embedding_size),
        encoder_(encoder),
        pieces_(std::move(pieces)) {}

  [[nodiscard]] Shape StateShape() const override { return state_shape_; }
  [[nodiscard]] Shape ConditionShape() const override { return condition_shape_; }
  [[nodiscard]] Status Encode(const Tensor& condition) override;
  [[nodiscard]] Result<Tensor> Predict(const Tensor& states, int t,
                                       Conditioning conditioning) override;

 private:
  // The exported batch size that does `count` states in fewest pieces; the smaller one of equals.
  [[nodiscard]] Piece& PieceFor(int count);
  // Predicts states [begin, begin + piece.batch), as far as there are any.
  [[nodiscard]] Status PredictPiece(const Tensor& states, int begin, const cv::Mat& time,
                                    Conditioning conditioning, Piece& piece, Tensor& prediction);

  Shape state_shape_;
  Shape condition_shape_;
  int diffusion_steps_;
  int embedding_size_;
  cv::dnn::Net encoder_;
  std::vector<Piece> pieces_;  // ascending batch size
  cv::Mat features_;           // of the last image
};

Status OpenCvDnnDenoiser::Encode(const Tensor& condition) {
  if (condition.batch != 1 || condition.shape != condition_shape_) {
    return Fail(ErrorCode::kInvalidArgument,
                "a condition of {}x{}x{}x{} does not fit a network that takes 1x{}x{}x{}",
                condition.batch, condition.shape.channels, condition.shape.rows,
                condition.shape.columns, condition_shape_.channels, condition_shape_.rows,
                condition_shape_.columns);
  }
  try {
    cv::Mat input(Sizes(1, condition_shape_), CV_32F);
    std::memcpy(input.ptr<float>(), condition.values.data(),
                condition.values.size() * sizeof(float));
    encoder_.setInput(input, "condition");
    // The network owns its output and overwrites it on the next run.
    features_ = encoder_.forward().clone();
  } catch (const cv::Exception& e) {
    features_.release();
    return Fail(ErrorCode::kInternal, "the image encoder failed: {}", Reason(e));
  }
  if (features_.dims < 2 || features_.size[0] != 1) {
    return Fail(ErrorCode::kCorruptData, "the image encoder gives {}, not one set of features",
                SizesText(features_));
  }
  for (Piece& piece : pieces_) {
    piece.image_features.release();
  }
  return {};
}

Piece& OpenCvDnnDenoiser::PieceFor(int count) {
  const auto runs = [count](const Piece& piece) { return (count + piece.batch - 1) / piece.batch; };
  return *std::min_element(pieces_.begin(), pieces_.end(),
                           [&](const Piece& a, const Piece& b) { return runs(a) < runs(b); });
}

Status OpenCvDnnDenoiser::PredictPiece(const Tensor& states, int begin, const cv::Mat& time,
                                       Conditioning conditioning, Piece& piece,
                                       Tensor& prediction) {
  const std::size_t each = state_shape_.Count();
  const auto first = static_cast<std::size_t>(begin) * each;
  const auto used = static_cast<std::size_t>(std::min(piece.batch, states.batch - begin)) * each;
  try {
    cv::Mat input(Sizes(piece.batch, state_shape_), CV_32F, cv::Scalar(0.0));
    std::memcpy(input.ptr<float>(), states.values.data() + first, used * sizeof(float));
    cv::Mat& features =
        conditioning == Conditioning::kWithImage ? piece.image_features : piece.no_features;
    if (features.empty()) {
      features = Repeat(features_, piece.batch);
      if (conditioning == Conditioning::kWithoutImage) {
        features.setTo(0.0);
      }
    }
    piece.net.setInput(input, "x");
    piece.net.setInput(time, "time");
    piece.net.setInput(features, "features");
    const cv::Mat output = piece.net.forward();
    if (output.total() != input.total()) {
      return Fail(ErrorCode::kCorruptData, "the denoiser gives {} for states of {}",
                  SizesText(output), SizesText(input));
    }
    std::memcpy(prediction.values.data() + first, output.ptr<float>(), used * sizeof(float));
  } catch (const cv::Exception& e) {
    return Fail(ErrorCode::kInternal, "the denoiser failed: {}", Reason(e));
  }
  return {};
}

Result<Tensor> OpenCvDnnDenoiser::Predict(const Tensor& states, int t, Conditioning conditioning) {
  if (states.batch < 1 || states.shape != state_shape_) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} motion states of {}x{}x{} do not fit a network of {}x{}x{}", states.batch,
                states.shape.channels, states.shape.rows, states.shape.columns,
                state_shape_.channels, state_shape_.rows, state_shape_.columns);
  }
  if (features_.empty()) {
    return Fail(ErrorCode::kInvalidArgument, "no image was encoded before the first prediction");
  }
  Piece& piece = PieceFor(states.batch);
  const std::vector<float> embedding = TimeEmbedding(t, diffusion_steps_, embedding_size_);
  cv::Mat one(Sizes(1, {embedding_size_, state_shape_.rows, 1}), CV_32F);
  for (int e = 0; e < embedding_size_; ++e) {
    std::fill_n(one.ptr<float>(0, e), state_shape_.rows, embedding[static_cast<std::size_t>(e)]);
  }
  const cv::Mat time = Repeat(one, piece.batch);
  Tensor prediction(states.batch, state_shape_);
  for (int begin = 0; begin < states.batch; begin += piece.batch) {
    if (Status status = PredictPiece(states, begin, time, conditioning, piece, prediction);
        !status) {
      return Propagate(status.error());
    }
  }
  return prediction;
}

// Runs the network once on zeros, so that a wrong shape is found now and not with the first image.
Status TryOut(Denoiser& denoiser, const std::vector<WeightFile>& denoisers) {
  if (Status status = denoiser.Encode(Tensor(1, denoiser.ConditionShape())); !status) {
    return status;
  }
  for (const WeightFile& weights : denoisers) {
    const Result<Tensor> prediction =
        denoiser.Predict(Tensor(weights.batch, denoiser.StateShape()), 0, Conditioning::kWithImage);
    if (!prediction) {
      return Propagate(prediction.error(), weights.path.string());
    }
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<Denoiser>> LoadOpenCvDnnDenoiser(const ModelInfo& model,
                                                        const BackendOptions& options) {
  const Result<Device> device = FindDevice(options.device);
  if (!device) {
    return Propagate(device.error());
  }
  const QuietOpenCv quiet;
  const Result<cv::dnn::Net> encoder = LoadNet(model.encoder, *device);
  if (!encoder) {
    return Propagate(encoder.error());
  }
  std::vector<Piece> pieces;
  for (const WeightFile& weights : model.denoisers) {
    const Result<cv::dnn::Net> net = LoadNet(weights, *device);
    if (!net) {
      return Propagate(net.error());
    }
    pieces.push_back({weights.batch, *net, {}, {}});
  }
  auto denoiser = std::make_unique<OpenCvDnnDenoiser>(model, *encoder, std::move(pieces));
  if (const Status status = TryOut(*denoiser, model.denoisers); !status) {
    return Fail(ErrorCode::kCorruptData,
                "model {}: its networks do not have the shapes that the model file states: {}",
                model.file.string(), status.error().message);
  }
  return denoiser;
}

}  // namespace rsstab::rsdiff
