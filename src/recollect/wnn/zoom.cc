#include "recollect/wnn/zoom.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

// Lengths are pixels of a 640 pixels wide image.
constexpr int kRounds = 3;        // of weighing parts anew by how they fit
constexpr double kOutlier = 16;   // a part this far off counts half
constexpr double kRounding = 4;   // variance of a displacement that fits all the others
constexpr double kStanding = 6;   // growth that halves the belief where it is known exactly
constexpr double kTogether = 36;  // times the variance: parts err together, by what they see
constexpr int kNeighbours = 1;    // labels before and after that say the same of the camera
constexpr double kOnTheWay = 16;  // variance of what happens between these

// One axis of the parts' displacements as a sum of kTerms, of which the last is growth.
template <int kTerms>
struct Axis {
  Eigen::Matrix<double, Eigen::Dynamic, kTerms> terms;
  Eigen::VectorXd displaced, votes;

  explicit Axis(std::size_t parts) : terms(parts, kTerms), displaced(parts), votes(parts) {}

  Zoom Fit() const {
    using Square = Eigen::Matrix<double, kTerms, kTerms>;
    const Eigen::VectorXd own = votes.array().square();
    Eigen::VectorXd fits = Eigen::VectorXd::Ones(own.size());
    Zoom zoom;
    for (int round = 0; round <= kRounds; ++round) {
      const Eigen::VectorXd weights = own.cwiseProduct(fits);
      const double all = weights.sum();
      if (all <= 0) return {};
      const double counted = all * all / weights.squaredNorm();  // parts, in effect
      const Square normal = terms.transpose() * weights.asDiagonal() * terms +
                            1e-6 * Square::Identity();  // of parts in one row or column
      const Square inverse = normal.ldlt().solve(Square::Identity());
      const Eigen::Matrix<double, kTerms, 1> found =
          inverse * (terms.transpose() * weights.cwiseProduct(displaced));
      const Eigen::ArrayXd squares = (displaced - terms * found).array().square();
      const double scatter =
          (weights.array() * squares).sum() / all * counted / std::max(1.0, counted - kTerms) +
          kRounding;
      zoom = {found[kTerms - 1], scatter * all / counted * inverse(kTerms - 1, kTerms - 1)};
      fits = 1 / (1 + squares / (kOutlier * kOutlier));
    }
    return zoom;
  }
};

}  // namespace

std::vector<PartCentre> PartCentres(const Synapses& synapses, std::span<const int> parts) {
  if (parts.empty()) return {};
  std::vector<PartCentre> centres(
      static_cast<std::size_t>(*std::max_element(parts.begin(), parts.end()) + 1));
  std::vector<int> neurons(centres.size(), 0);
  const double aspect = static_cast<double>(synapses.window_height()) / synapses.window_width();
  for (std::size_t n = 0; n < parts.size(); ++n) {
    const auto part = static_cast<std::size_t>(parts[n]);
    const Pixel cell = synapses.Cell(static_cast<int>(n));
    centres[part].x += 2 * (cell.x + 0.5) / synapses.neurons_x() - 1;
    centres[part].y += (2 * (cell.y + 0.5) / synapses.neurons_y() - 1) * aspect;
    ++neurons[part];
  }
  for (std::size_t part = 0; part < centres.size(); ++part) {
    centres[part].x /= std::max(1, neurons[part]);
    centres[part].y /= std::max(1, neurons[part]);
  }
  return centres;
}

Zoom ZoomOf(const Look& look, std::span<const PartCentre> centres, const Displacements& grid) {
  Require(look.displacements.size() == centres.size() + 1 &&
              look.votes.size() == look.displacements.size(),
          "zoom", "a look has one displacement of the whole image and one of each part");
  // Nearer to one wall than the map was, one sees that wall displaced the farther the more to its
  // side it lies, and the other wall the same way: this is what |x| is for. Up and down, the two
  // walls tell growth alone.
  Axis<3> across(centres.size());
  Axis<2> down(centres.size());
  for (std::size_t part = 0; part < centres.size(); ++part) {
    const auto row = static_cast<Eigen::Index>(part);
    const auto [x, y] = centres[part];
    across.terms.row(row) << 1, std::abs(x), x;
    down.terms.row(row) << 1, y;
    const int displacement = look.displacements[part + 1];
    across.displaced[row] = grid.step * (displacement % grid.columns - grid.columns / 2);
    down.displaced[row] = grid.step * (displacement / grid.columns - grid.rows / 2);
    across.votes[row] = down.votes[row] = look.votes[part + 1];
  }
  const Zoom a = across.Fit(), b = down.Fit();
  const double known = 1 / a.variance + 1 / b.variance;
  if (known <= 0) return {};
  return {(a.growth / a.variance + b.growth / b.variance) / known, 1 / known};
}

std::vector<double> Steadiness(std::span<const int> labels, std::span<const Zoom> zooms) {
  Require(labels.size() == zooms.size(), "zoom", "one is needed for each label");
  std::vector<double> steady;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    double known = 0, sum = 0;
    for (std::size_t j = i - std::min<std::size_t>(i, kNeighbours);
         j < std::min(labels.size(), i + kNeighbours + 1); ++j) {
      const int apart = std::abs(labels[j] - labels[i]);
      if (apart > kNeighbours) continue;
      const double share = 1 - static_cast<double>(apart) / (kNeighbours + 1);
      const double weight = share / (zooms[j].variance + kOnTheWay);
      known += weight;
      sum += weight * zooms[j].growth;
    }
    if (known <= 0) {
      steady.push_back(1);
      continue;
    }
    const double growth = sum / known;
    steady.push_back(1 / (1 + growth * growth / (kStanding * kStanding + kTogether / known)));
  }
  return steady;
}

}  // namespace recollect::wnn
