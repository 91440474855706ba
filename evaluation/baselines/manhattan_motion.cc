// SPDX-License-Identifier: Apache-2.0
#include "evaluation/baselines/manhattan_motion.h"

#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "evaluation/baselines/manhattan_residuals.h"
#include "igf/base/rotation.h"
#include "igf/base/seeded_random.h"

namespace rsstab::evaluation {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kHypotheses = 600;
// A segment may be off its vanishing point by so much: a strong motion skews a picture by several
// degrees before it is known, and by less in each round.
constexpr std::array<double, 5> kTolerances = {8 * kDegree, 6 * kDegree, 4 * kDegree, 3 * kDegree,
                                               2 * kDegree};
constexpr int kLeastPerDirection = 8;
constexpr double kLeastInlierShare = 0.4;  // of the length: three directions catch 25% of anything
constexpr double kLoss_px = 0.7;
// One standard deviation of the motion, as displacement from top to bottom, in picture heights.
constexpr double kRateSpread = 0.05;
constexpr double kChangeSpread = 0.02;
// The segments of a picture are wrong together (a focal length that is not one width, facades that
// are not quite at right angles), so that they count as so many at most. Otherwise hundreds of them
// outvote the pull towards rest about what a picture hardly tells, its pitch above all.
constexpr double kMostIndependent = 20.0;
// Farther than this, in picture heights from top to bottom, no hand turns a camera in a readout.
constexpr double kMostMotion = 0.25;
// Pieces of one edge: ends this near, directions this alike.
constexpr double kJoint_px = 12.0;
constexpr double kJointAngle = 10 * kDegree;

struct Edge {
  EdgePoint a;
  EdgePoint b;
  double length_px = 0.0;
  int axis = -1;  // of the Manhattan frame; -1 = none
};

using Motion = std::array<double, 6>;

std::vector<Edge> EdgesOf(std::span<const EdgeSegment> segments, const Camera& camera) {
  const Eigen::Matrix3d k_inverse = camera.K().inverse();
  const auto point = [&](const Eigen::Vector2d& pixel) {
    return EdgePoint{k_inverse * pixel.homogeneous(), (pixel.y() + 0.5) / camera.height - 0.5};
  };
  std::vector<Edge> edges;
  for (const EdgeSegment& segment : segments) {
    edges.push_back({point(segment.a), point(segment.b), segment.Length(), -1});
  }
  return edges;
}

double OffDirection(const Edge& edge, const Motion& motion, const Eigen::Vector3d& direction) {
  return std::abs(OffVanishingLine<double>(edge.a, edge.b, motion.data(), direction));
}

// Length of the edges that lead to one of the axes, less where they do so badly.
double Support(const std::vector<Edge>& edges, const Motion& motion, const Eigen::Matrix3d& axes,
               double tolerance) {
  double support = 0.0;
  for (const Edge& edge : edges) {
    double best = tolerance;
    for (int axis = 0; axis < 3; ++axis) {
      best = std::min(best, OffDirection(edge, motion, axes.col(axis)));
    }
    support += edge.length_px * (1.0 - best / tolerance);
  }
  return support;
}

Eigen::Vector3d PlaneNormal(const Edge& edge) { return edge.a.ray.cross(edge.b.ray).normalized(); }

// Two segments meet in a first vanishing point, a third one fixes the second at right angles to it.
std::optional<Eigen::Matrix3d> FindAxes(const std::vector<Edge>& edges, const Motion& motion,
                                        SeededRandom& random) {
  std::optional<Eigen::Matrix3d> best;
  double best_support = 0.0;
  const int last = static_cast<int>(edges.size()) - 1;
  for (int i = 0; i < kHypotheses; ++i) {
    const auto draw = [&] {
      return PlaneNormal(edges[static_cast<std::size_t>(random.Integer(0, last))]);
    };
    const Eigen::Vector3d first_normal = draw();
    const Eigen::Vector3d second_normal = draw();
    const Eigen::Vector3d third_normal = draw();
    const Eigen::Vector3d first = first_normal.cross(second_normal);
    const Eigen::Vector3d second = first.cross(third_normal);
    if (first.norm() < 1e-3 || second.norm() < 1e-3) {
      continue;
    }
    Eigen::Matrix3d axes;
    axes.col(0) = first.normalized();
    axes.col(1) = second.normalized();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    const double support = Support(edges, motion, axes, kTolerances.front());
    if (support > best_support) {
      best_support = support;
      best = axes;
    }
  }
  return best;
}

void Assign(const Motion& motion, const Eigen::Matrix3d& axes, double tolerance,
            std::vector<Edge>& edges) {
  for (Edge& edge : edges) {
    edge.axis = -1;
    double best = tolerance;
    for (int axis = 0; axis < 3; ++axis) {
      const double off = OffDirection(edge, motion, axes.col(axis));
      if (off < best) {
        best = off;
        edge.axis = axis;
      }
    }
  }
}

// Segments that go on where another ends, in nearly its direction: first edge, second edge, both
// turned so that they follow one another.
std::vector<std::pair<Edge, Edge>> Joints(const std::vector<Edge>& edges, const Camera& camera) {
  const auto reversed = [](Edge edge) {
    std::swap(edge.a, edge.b);
    return edge;
  };
  std::vector<std::pair<Edge, Edge>> joints;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      for (const Edge& first : {edges[i], reversed(edges[i])}) {
        for (const Edge& second : {edges[j], reversed(edges[j])}) {
          const Eigen::Vector2d gap = (second.a.ray - first.b.ray).head<2>();
          const Eigen::Vector2d u = (first.b.ray - first.a.ray).head<2>().normalized();
          const Eigen::Vector2d v = (second.b.ray - second.a.ray).head<2>().normalized();
          if (camera.fx * gap.norm() < kJoint_px && u.dot(v) > std::cos(kJointAngle)) {
            joints.emplace_back(first, second);
          }
        }
      }
    }
  }
  return joints;
}

void AddStraightness(const std::vector<std::pair<Edge, Edge>>& joints, Motion& motion,
                     ceres::Problem& problem) {
  for (const auto& [first, second] : joints) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<StraightnessResidual, 2, 6>(new StraightnessResidual(
            first.a, first.b, second.a, second.b, first.length_px + second.length_px)),
        new ceres::CauchyLoss(kLoss_px), motion.data());
  }
}

bool Solve(const std::vector<Edge>& edges, const std::vector<std::pair<Edge, Edge>>& joints,
           const Camera& camera, Motion& motion, Eigen::Matrix3d& axes) {
  Eigen::Quaterniond frame(axes);
  ceres::Problem problem;
  problem.AddParameterBlock(frame.coeffs().data(), 4, new ceres::EigenQuaternionManifold);
  for (const Edge& edge : edges) {
    if (edge.axis >= 0) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<ManhattanResidual, 1, 6, 4>(
              new ManhattanResidual(edge.a, edge.b, edge.axis, edge.length_px / 2.0)),
          new ceres::CauchyLoss(kLoss_px), motion.data(), frame.coeffs().data());
    }
  }
  AddStraightness(joints, motion, problem);
  const double height_rad = camera.height / camera.fy;
  const double pull =
      std::sqrt(std::max(1.0, static_cast<double>(edges.size()) / kMostIndependent));
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<SmallMotionResidual, 6, 6>(new SmallMotionResidual{
          pull / (kRateSpread * height_rad), pull / (kChangeSpread * height_rad)}),
      nullptr, motion.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 25;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  axes = frame.toRotationMatrix();
  return summary.IsSolutionUsable();
}

// Two directions at least, and more than chance would give.
bool IsManhattan(const std::vector<Edge>& edges) {
  std::array<int, 3> count{};
  double inside = 0.0;
  double all = 0.0;
  for (const Edge& edge : edges) {
    all += edge.length_px;
    if (edge.axis >= 0) {
      ++count[static_cast<std::size_t>(edge.axis)];
      inside += edge.length_px;
    }
  }
  return std::count_if(count.begin(), count.end(), [](int n) { return n >= kLeastPerDirection; }) >=
             2 &&
         inside > kLeastInlierShare * all;
}

}  // namespace

Eigen::Quaterniond RowMotion::AtRow(double row, int height) const {
  const double s = (row + 0.5) / height - 0.5;
  return ExpSo3(Eigen::Vector3d(s * rate + s * s * change));
}

Result<RowMotion> FitManhattanMotion(std::span<const EdgeSegment> segments, const Camera& camera,
                                     std::uint64_t seed) {
  const char* const kRefusal =
      "the picture shows too few straight edges in directions at right "
      "angles to tell its motion";
  std::vector<Edge> edges = EdgesOf(segments, camera);
  if (static_cast<int>(edges.size()) < 2 * kLeastPerDirection) {
    return Fail(ErrorCode::kUntrustworthy, "{}", kRefusal);
  }
  SeededRandom random(seed);
  Motion motion{};
  auto axes = FindAxes(edges, motion, random);
  if (!axes) {
    return Fail(ErrorCode::kUntrustworthy, "{}", kRefusal);
  }
  const auto joints = Joints(edges, camera);
  for (const double tolerance : kTolerances) {
    Assign(motion, *axes, tolerance, edges);
    if (!IsManhattan(edges) || !Solve(edges, joints, camera, motion, *axes)) {
      return Fail(ErrorCode::kUntrustworthy, "{}", kRefusal);
    }
  }
  const Eigen::Map<const Eigen::Vector3d> rate(motion.data());
  const Eigen::Map<const Eigen::Vector3d> change(motion.data() + 3);
  if (rate.norm() + change.norm() > kMostMotion * camera.height / camera.fy) {
    return Fail(ErrorCode::kUntrustworthy, "the edges ask for a motion that no camera makes");
  }
  RowMotion result;
  result.rate = rate;
  result.change = change;
  result.inliers = static_cast<int>(
      std::count_if(edges.begin(), edges.end(), [](const Edge& edge) { return edge.axis >= 0; }));
  return result;
}

}  // namespace rsstab::evaluation
