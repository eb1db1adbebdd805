#include "recollect/wnn/zoom.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

// Lengths are pixels of a 640 pixels wide image.
constexpr int kRounds = 3;       // of weighing parts anew by how they fit
constexpr double kOutlier = 16;  // a part this far off counts half
constexpr double kRounding = 4;  // variance of a displacement that fits all the others

// What halves the belief, the squares of both added: the growth of so many places, and so many
// standard deviations of the line's.
constexpr double kPlaces = 2;
constexpr double kDoubt = 4;

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

double Steady(std::span<const ZoomAlong> along, const Zoom& before, const Zoom& here,
              const Zoom& next) {
  if (std::isinf(before.variance + here.variance + next.variance)) return 1;
  const double a_place = (before.growth - next.growth) / 2;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const auto& [places, zoom] : along) {
    const double bent = a_place * places;  // the further from here, the less it is a line
    const double weight = 1 / (zoom.variance + bent * bent);
    const Eigen::Vector2d term(1, -places);
    normal += weight * term * term.transpose();
    right += weight * zoom.growth * term;
  }
  if (!(normal.determinant() > 0)) return 1;  // of places at one spot
  const Eigen::Matrix2d doubt = normal.inverse();
  const Eigen::Vector2d found = doubt * right;  // growth here, and from a place to the next
  const double half = kPlaces * kPlaces * found[1] * found[1] + kDoubt * kDoubt * doubt.trace();
  return 1 / (1 + found[0] * found[0] / half);
}

}  // namespace recollect::wnn
