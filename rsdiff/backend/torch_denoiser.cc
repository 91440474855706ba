// SPDX-License-Identifier: Apache-2.0
#include "rsdiff/backend/torch_denoiser.h"

#include <ATen/Parallel.h>
#include <torch/cuda.h>
#include <torch/script.h>

#include <algorithm>
#include <exception>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace rsstab::rsdiff {
namespace {

Result<torch::Device> FindDevice(const std::string& name) {
  const bool has_cuda = torch::cuda::is_available();
  if (name == "cuda" || (name == "auto" && has_cuda)) {
    if (has_cuda) {
      return torch::Device(torch::kCUDA);
    }
  } else if (name == "cpu" || name == "auto") {
    return torch::Device(torch::kCPU);
  }
  return Fail(ErrorCode::kUnsupported,
              "this libtorch cannot run networks on the device \"{}\"; it can on: cpu{}", name,
              has_cuda ? ", cuda" : "");
}

// libtorch's own message, its first line: the rest is stack traces.
std::string Reason(const std::exception& e) {
  const auto* own = dynamic_cast<const c10::Error*>(&e);
  const std::string text = own != nullptr ? own->what_without_backtrace() : e.what();
  return text.substr(0, text.find('\n'));
}

// libtorch has one thread count for the process. While this lives it is the asked one.
class ThreadCount {
 public:
  explicit ThreadCount(int wanted) : before_(at::get_num_threads()) { Set(wanted); }
  ~ThreadCount() { Set(before_); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;

 private:
  static void Set(int count) {
    if (count > 0 && count != at::get_num_threads()) {
      at::set_num_threads(count);
    }
  }
  int before_;
};

class TorchDenoiser final : public Denoiser {
 public:
  TorchDenoiser(const ModelInfo& model, torch::jit::Module network, torch::Device device,
                int num_threads)
      : state_shape_(model.motion),
        condition_shape_(model.condition),
        diffusion_steps_(model.diffusion_steps),
        network_(std::move(network)),
        device_(device),
        num_threads_(num_threads) {}

  [[nodiscard]] Shape StateShape() const override { return state_shape_; }
  [[nodiscard]] Shape ConditionShape() const override { return condition_shape_; }
  [[nodiscard]] Status Encode(const Tensor& condition) override;
  [[nodiscard]] Result<Tensor> Predict(const Tensor& states, int t,
                                       Conditioning conditioning) override;

 private:
  [[nodiscard]] torch::Tensor ToTorch(const Tensor& tensor) const {
    const std::vector<std::int64_t> sizes = {tensor.batch, tensor.shape.channels, tensor.shape.rows,
                                             tensor.shape.columns};
    return torch::tensor(at::ArrayRef<float>(tensor.values)).reshape(sizes).to(device_);
  }

  Shape state_shape_;
  Shape condition_shape_;
  int diffusion_steps_;
  torch::jit::Module network_;
  torch::Device device_;
  int num_threads_;
  torch::IValue features_;  // of the last image; None before
};

Status TorchDenoiser::Encode(const Tensor& condition) {
  if (condition.batch != 1 || condition.shape != condition_shape_) {
    return Fail(ErrorCode::kInvalidArgument,
                "a condition of {} x {}x{}x{} does not fit a network that takes 1 x {}x{}x{}",
                condition.batch, condition.shape.channels, condition.shape.rows,
                condition.shape.columns, condition_shape_.channels, condition_shape_.rows,
                condition_shape_.columns);
  }
  features_ = {};
  try {
    const c10::InferenceMode inference;
    const ThreadCount threads(num_threads_);
    features_ = network_.get_method("encode")({ToTorch(condition)});
    return {};
  } catch (const std::exception& e) {
    return Fail(ErrorCode::kInternal, "libtorch failed to encode the image: {}", Reason(e));
  }
}

Result<Tensor> TorchDenoiser::Predict(const Tensor& states, int t, Conditioning conditioning) {
  if (states.batch < 1 || states.shape != state_shape_ || t < 0 || t >= diffusion_steps_) {
    return Fail(ErrorCode::kInvalidArgument,
                "{} states of {}x{}x{} at time step {} do not fit a network of {}x{}x{} and {} "
                "time steps",
                states.batch, states.shape.channels, states.shape.rows, states.shape.columns, t,
                state_shape_.channels, state_shape_.rows, state_shape_.columns, diffusion_steps_);
  }
  if (features_.isNone()) {
    return Fail(ErrorCode::kInvalidArgument, "a prediction was asked for before any image");
  }
  try {
    const c10::InferenceMode inference;
    const ThreadCount threads(num_threads_);
    const auto time = torch::full({states.batch}, t, torch::dtype(torch::kInt64).device(device_));
    const auto drop = torch::full({states.batch}, conditioning == Conditioning::kWithoutImage,
                                  torch::dtype(torch::kBool).device(device_));
    const torch::Tensor prediction =
        network_.get_method("denoise")({ToTorch(states), time, features_, drop})
            .toTensor()
            .to(torch::kCPU, torch::kFloat32)
            .contiguous();
    Tensor result(states.batch, state_shape_);
    if (static_cast<std::size_t>(prediction.numel()) != result.values.size()) {
      return Fail(ErrorCode::kInternal, "the network returned {} numbers instead of {}",
                  prediction.numel(), result.values.size());
    }
    std::copy_n(prediction.data_ptr<float>(), result.values.size(), result.values.begin());
    return result;
  } catch (const std::exception& e) {
    return Fail(ErrorCode::kInternal, "libtorch failed at time step {}: {}", t, Reason(e));
  }
}

}  // namespace

Result<std::unique_ptr<Denoiser>> LoadTorchDenoiser(const ModelInfo& model,
                                                    const BackendOptions& options) {
  const std::string name = model.network.path.string();
  try {
    const auto device = FindDevice(options.device);
    if (!device) {
      return Propagate(device.error());
    }
    Result<std::string> bytes = ReadWeights(model.network);
    if (!bytes) {
      return Propagate(bytes.error());
    }
    std::istringstream stream(std::move(*bytes));
    torch::jit::Module network = torch::jit::load(stream, *device);
    for (const char* method : {"encode", "denoise"}) {
      if (!network.find_method(method)) {
        return Fail(ErrorCode::kCorruptData, "{}: the network has no method \"{}\"", name, method);
      }
    }
    network.eval();
    return std::make_unique<TorchDenoiser>(model, std::move(network), *device, options.num_threads);
  } catch (const std::exception& e) {
    return Fail(ErrorCode::kCorruptData, "{}: not a network that this libtorch can run: {}", name,
                Reason(e));
  }
}

}  // namespace rsstab::rsdiff
