#include "recollect/cnn/motion_solver.h"

#include <ATen/Parallel.h>

#include "recollect/cnn/layers.h"

namespace recollect::cnn {
namespace {

constexpr double kNearest = 0.5;  // metres; what would come closer than this is not used

struct Residuals {
  torch::Tensor turned;           // [B, 3, N]: R p
  torch::Tensor x, y, inverse_z;  // [B, N]: projections under the motion
  torch::Tensor dx, dy;           // [B, N]: seen less projected
  torch::Tensor weight;           // [B, N]
};

Residuals Evaluate(const torch::Tensor& motion, const Sightings& sightings) {
  Residuals r;
  r.turned = torch::matmul(motion.slice(2, 0, 3), sightings.points);
  const torch::Tensor moved = r.turned + motion.slice(2, 3, 4);
  const torch::Tensor z = moved.select(1, 2);
  r.inverse_z = z.clamp_min(kNearest).reciprocal();
  r.x = moved.select(1, 0) * r.inverse_z;
  r.y = moved.select(1, 1) * r.inverse_z;
  r.dx = sightings.seen.select(1, 0) - r.x;
  r.dy = sightings.seen.select(1, 1) - r.y;
  r.weight = sightings.weight * (z > kNearest);
  return r;
}

// Least squares for a step: normal * step = right.
struct System {
  torch::Tensor normal, right;  // [B, 6, 6], [B, 6, 1]
};

System SystemFrom(const Residuals& r, const torch::Tensor& weight, const SolverOptions& options) {
  // q = R p + t moves by dq = dw x (R p) + dt, its projection x = X / Z by (dX - x dZ) / Z.
  const torch::Tensor a = r.turned.select(1, 0), b = r.turned.select(1, 1),
                      c = r.turned.select(1, 2);
  const torch::Tensor zero = torch::zeros_like(r.x), i = r.inverse_z;
  const torch::Tensor row_x =
      torch::stack({-r.x * b * i, (c + r.x * a) * i, -b * i, i, zero, -r.x * i}, 2);
  const torch::Tensor row_y =
      torch::stack({-(c + r.y * b) * i, r.y * a * i, a * i, zero, i, -r.y * i}, 2);
  const torch::Tensor jacobian = torch::cat({row_x, row_y}, 1);  // [B, 2 N, 6]
  const torch::Tensor residual = torch::cat({r.dx, r.dy}, 1).unsqueeze(2);
  const torch::Tensor weights = torch::cat({weight, weight}, 1).unsqueeze(2);
  const torch::Tensor weighted = (jacobian * weights).transpose(1, 2);

  const double rotation = options.sighting_sd / options.prior_rotation_sd;
  const double translation = options.sighting_sd / options.prior_translation_sd;
  const torch::Tensor sd = torch::tensor(
      {rotation, rotation, rotation, translation, translation, translation}, weight.options());
  return {torch::bmm(weighted, jacobian) + torch::diag(sd.square()),
          torch::bmm(weighted, residual)};
}

torch::Tensor StepFrom(const Residuals& r, const torch::Tensor& weight,
                       const SolverOptions& options) {
  const System system = SystemFrom(r, weight, options);
  return torch::linalg_solve(system.normal, system.right).squeeze(2);
}

torch::Tensor RobustWeight(const Residuals& r, const SolverOptions& options) {
  const torch::Tensor square =
      (r.dx.square() + r.dy.square()) / (options.outlier * options.outlier);
  return r.weight / (1.0 + square.detach());
}

// Without gradients: pair by pair, and so without the cost of a hundred small operations.
torch::Tensor SolveEach(const Sightings& sightings, const SolverOptions& options) {
  const std::int64_t batch = sightings.points.size(0), cells = sightings.points.size(2);
  const torch::Tensor points = sightings.points.contiguous(), seen = sightings.seen.contiguous(),
                      weight = sightings.weight.contiguous();
  torch::Tensor motions = torch::empty({batch, 3, 4});
  using Rows = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;
  at::parallel_for(0, batch, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      Eigen::Map<Rows>(motions.data_ptr<float>() + 12 * i) =
          SolveCells(points.data_ptr<float>() + 3 * cells * i,
                     seen.data_ptr<float>() + 2 * cells * i, weight.data_ptr<float>() + cells * i,
                     cells, options)
              .cast<float>();
    }
  });
  return motions;
}

}  // namespace

torch::Tensor Moved(const torch::Tensor& motion, const torch::Tensor& delta) {
  const torch::Tensor step = Se3Layer(delta);
  return torch::cat({torch::bmm(step.slice(2, 0, 3), motion.slice(2, 0, 3)),
                     motion.slice(2, 3, 4) + step.slice(2, 3, 4)},
                    2);
}

torch::Tensor SolverStep(const torch::Tensor& motion, const Sightings& sightings,
                         const SolverOptions& options) {
  const Residuals residuals = Evaluate(motion, sightings);
  return StepFrom(residuals, residuals.weight, options);
}

torch::Tensor MotionPrecision(const torch::Tensor& motion, const Sightings& sightings,
                              const SolverOptions& options) {
  const Residuals residuals = Evaluate(motion, sightings);
  const System system = SystemFrom(residuals, RobustWeight(residuals, options), options);
  // To the first order a step is (R, R) x.
  const torch::Tensor turn = motion.slice(2, 0, 3), none = torch::zeros_like(turn);
  const torch::Tensor by =
      torch::cat({torch::cat({turn, none}, 2), torch::cat({none, turn}, 2)}, 1);
  return torch::bmm(by.transpose(1, 2), torch::bmm(system.normal, by)) /
         (options.sighting_sd * options.sighting_sd);
}

torch::Tensor MotionFit(const torch::Tensor& motion, const Sightings& sightings,
                        const SolverOptions& options) {
  constexpr double kLeast = 1e-6;
  const Residuals residuals = Evaluate(motion, sightings);
  const torch::Tensor left = RobustWeight(residuals, options);
  const torch::Tensor square = residuals.dx.square() + residuals.dy.square();
  const torch::Tensor weight = sightings.weight.mean(1), kept = left.mean(1);
  const torch::Tensor spread =
      (left * square).mean(1) / (kept + kLeast) / (2 * options.sighting_sd * options.sighting_sd);
  return (torch::stack({weight, kept / (weight + kLeast), spread}, 1) + kLeast).log();
}

torch::Tensor SolveMotion(const Sightings& sightings, const SolverOptions& options) {
  const std::int64_t batch = sightings.points.size(0);
  if (!torch::GradMode::is_enabled() && sightings.points.is_cpu() &&
      sightings.points.scalar_type() == torch::kFloat) {
    return SolveEach(sightings, options);
  }
  torch::Tensor motion =
      torch::eye(3, 4, sightings.points.options()).unsqueeze(0).repeat({batch, 1, 1});
  for (int i = 0; i < options.iterations; ++i) {
    const bool last = i + 1 == options.iterations;
    const torch::AutoGradMode gradients(last && torch::GradMode::is_enabled());
    const Residuals residuals = Evaluate(motion, sightings);
    motion = Moved(motion, StepFrom(residuals, RobustWeight(residuals, options), options));
  }
  return motion;
}

}  // namespace recollect::cnn
