// SPDX-License-Identifier: Apache-2.0
#ifndef RSSTAB_EVALUATION_MOTION_METHOD_H_
#define RSSTAB_EVALUATION_MOTION_METHOD_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/readout_curve.h"
#include "igf/base/camera.h"
#include "igf/base/frame.h"
#include "igf/base/motion_field.h"
#include "igf/base/result.h"
#include "igf/gyro_log.h"
#include "rsdiff/rotation_curve.h"
#include "rsdiff/single_image_motion.h"

namespace rsstab::evaluation {

// What a method is given. Everything outlives the call only.
struct MethodInput {
  FrameView rs;            // the rolling-shutter picture
  std::uint64_t seed = 0;  // for methods that draw numbers
  // The true camera and motion of the picture; null where nobody knows them. For methods that are
  // told (a gyro log, a calibrated lens), not for those that are to find out.
  const Camera* camera = nullptr;  // its readout_s too, where known
  const ReadoutCurve* motion = nullptr;
  const igf::GyroLog* gyro = nullptr;  // at time 0 the picture's middle row was exposed
  // The frames before and after, where the picture is one of a clip: of its size and layout.
  const FrameView* previous = nullptr;
  const FrameView* next = nullptr;
  double frame_interval_s = 0.0;  // from one to the next; 0 = nobody knows
  // The row whose instant the answer should refer to; the middle one unless given.
  std::optional<double> reference_row;

  [[nodiscard]] double ReferenceRow() const {
    return reference_row.value_or((rs.height - 1) / 2.0);
  }
};

struct MethodAnswer {
  // Of the picture's size. It says its reference row: the one that was asked for, or the middle.
  MotionField field;
  // Methods that draw rotation curves: each of them, zero at the middle row. Else empty.
  std::vector<rsdiff::RotationCurve> curves;
};

// One way to tell how the camera moved during a picture's readout. Not thread safe.
class MotionMethod {
 public:
  virtual ~MotionMethod() = default;

  // What tables, CSV and JSON call it.
  [[nodiscard]] virtual std::string Name() const = 0;

  // Errors: kUntrustworthy when the picture does not tell (it is then left as it is); kUnsupported
  // when the input lacks what the method needs (a gyro log, a second frame).
  [[nodiscard]] virtual Result<MethodAnswer> Estimate(const MethodInput& input) = 0;
};

// Asks a method, and leaves the picture as it is (the zero field, `declined`) where the method says
// that the picture does not tell. Errors: those of Estimate but kUntrustworthy.
[[nodiscard]] Result<MethodAnswer> EstimateOrDecline(MotionMethod& method, const MethodInput& input,
                                                     bool& declined);

// Leaves every picture as it is: the zero field.
class NoCorrection final : public MotionMethod {
 public:
  [[nodiscard]] std::string Name() const override { return "none"; }
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override;
};

// A network of rsdiff. Several methods may share one estimator, on one thread.
class SingleImageMethod final : public MotionMethod {
 public:
  // The seed of `sampling` is replaced by that of each input. `know_focal`: tell the estimator the
  // true focal length, where it is known; otherwise it assumes its default.
  SingleImageMethod(std::string name, std::shared_ptr<rsdiff::SingleImageEstimator> estimator,
                    const rsdiff::SamplingOptions& sampling, bool know_focal)
      : name_(std::move(name)),
        estimator_(std::move(estimator)),
        sampling_(sampling),
        know_focal_(know_focal) {}

  [[nodiscard]] std::string Name() const override { return name_; }
  // Errors: those of SingleImageEstimator::Estimate.
  [[nodiscard]] Result<MethodAnswer> Estimate(const MethodInput& input) override;

 private:
  std::string name_;
  std::shared_ptr<rsdiff::SingleImageEstimator> estimator_;
  rsdiff::SamplingOptions sampling_;
  bool know_focal_;
};

// The methods of one thread.
struct MethodSet {
  std::vector<std::unique_ptr<MotionMethod>> methods;  // the first one leaves the pictures alone
  std::unique_ptr<MotionMethod> sampler;  // draws the curves for the calibration; may be null
  std::unique_ptr<MotionMethod> skew;     // judged for linearity; may be null
};

// Makes the methods of one more thread. Any thread.
using MethodFactory = std::function<Result<MethodSet>()>;

}  // namespace rsstab::evaluation

#endif  // RSSTAB_EVALUATION_MOTION_METHOD_H_
