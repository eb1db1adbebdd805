#include "recollect/matching/guided.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/matching/build_landmarks.h"
#include "recollect/matching/match.h"

namespace recollect::matching {

PixelGrid::PixelGrid(const PinholeCamera& camera, const Features& features)
    : features_(features),
      columns_(camera.width / kCell + 1),
      rows_(camera.height / kCell + 1),
      order_(static_cast<std::size_t>(features.size())),
      first_(static_cast<std::size_t>(columns_ * rows_) + 1) {
  std::vector<int> cells;
  for (const Eigen::Vector2d& p : features.pixels) {
    cells.push_back(Cell(p.y(), rows_) * columns_ + Cell(p.x(), columns_));
    ++first_[static_cast<std::size_t>(cells.back()) + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  std::vector<int> next = first_;
  for (int i = 0; i < features.size(); ++i) {
    const int cell = cells[static_cast<std::size_t>(i)];
    order_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell)]++)] = i;
  }
}

void PixelGrid::Around(const Eigen::Vector2d& pixel, double radius, std::vector<int>& found) const {
  const int left = Cell(pixel.x() - radius, columns_), right = Cell(pixel.x() + radius, columns_);
  const int top = Cell(pixel.y() - radius, rows_), bottom = Cell(pixel.y() + radius, rows_);
  for (int y = top; y <= bottom; ++y) {
    const auto from = static_cast<std::size_t>(y * columns_ + left);
    const auto to = static_cast<std::size_t>(y * columns_ + right + 1);
    for (int i = first_[from]; i < first_[to]; ++i) {
      const int feature = order_[static_cast<std::size_t>(i)];
      const Eigen::Vector2d& at = features_.pixels[static_cast<std::size_t>(feature)];
      if ((at - pixel).squaredNorm() <= radius * radius) found.push_back(feature);
    }
  }
}

void MatchGuided(const PinholeCamera& camera, int key_frame, const SE3& world_from_keyframe,
                 const Landmarks& landmarks, const Features& live, const PixelGrid& grid,
                 const SE3& pose, double radius, double likeness,
                 std::vector<Observation>& matches) {
  const SE3 live_from_key = pose.Inverse() * world_from_keyframe;
  // By feature: the most alike landmark so far.
  std::vector<std::pair<int, int>> best(static_cast<std::size_t>(live.size()), {-1, -1});
  std::vector<int> near, likenesses;
  for (int i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3d p =
        live_from_key * landmarks.points[static_cast<std::size_t>(i)].p_keyframe;
    if (p.z() < 0.5) continue;
    const Eigen::Vector2d predicted = camera.Project(p);
    if (!camera.Contains(predicted)) continue;
    near.clear();
    grid.Around(predicted, radius, near);
    if (near.empty()) continue;
    const std::int8_t* descriptor = landmarks.descriptors.data() + i * kDescriptorBytes;
    likenesses.resize(near.size());
    Likenesses(descriptor, live.descriptors.data(), near, likenesses.data());
    const auto best_of_all = std::max_element(likenesses.begin(), likenesses.end());
    const int most = *best_of_all;
    const int feature = near[static_cast<std::size_t>(best_of_all - likenesses.begin())];
    const int own_norm = Likeness(descriptor, descriptor);
    const int its_norm = Likeness(live.Descriptor(feature), live.Descriptor(feature));
    if (most < likeness * std::sqrt(static_cast<double>(own_norm) * its_norm)) continue;
    auto& [landmark, so_far] = best[static_cast<std::size_t>(feature)];
    if (most > so_far) {
      so_far = most;
      landmark = i;
    }
  }
  const Eigen::Matrix3d& r = world_from_keyframe.rotation();
  for (int j = 0; j < live.size(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    if (best[at].first < 0) continue;
    const Landmark& l = landmarks.points[static_cast<std::size_t>(best[at].first)];
    matches.push_back({world_from_keyframe * l.p_keyframe, r * l.Covariance(camera) * r.transpose(),
                       live.pixels[at], PixelSigma(static_cast<double>(live.sizes[at])), j,
                       key_frame});
  }
}

void ShareFeatures(const Features& live, std::vector<Observation>& matches) {
  std::vector<int> sharers(static_cast<std::size_t>(live.size()), 0);
  for (const Observation& one : matches) ++sharers[static_cast<std::size_t>(one.feature)];
  for (Observation& one : matches) {
    one.pixel_sigma *= std::sqrt(sharers[static_cast<std::size_t>(one.feature)]);
  }
}

void CountSupport(const PinholeCamera& camera, const Features& live,
                  const std::vector<Observation>& matches, const std::vector<double>& deviations,
                  int& support, double& spread) {
  constexpr int kColumns = 8, kRows = 6;
  std::vector<char> seen(static_cast<std::size_t>(live.size()), 0), cells(kColumns * kRows, 0);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (deviations[i] > 3) continue;
    const auto feature = static_cast<std::size_t>(matches[i].feature);
    seen[feature] = 1;
    const Eigen::Vector2d& p = live.pixels[feature];
    const int x = std::clamp(static_cast<int>(p.x() * kColumns / camera.width), 0, kColumns - 1);
    const int y = std::clamp(static_cast<int>(p.y() * kRows / camera.height), 0, kRows - 1);
    cells[static_cast<std::size_t>(y * kColumns + x)] = 1;
  }
  support = static_cast<int>(std::count(seen.begin(), seen.end(), 1));
  spread = static_cast<double>(std::count(cells.begin(), cells.end(), 1)) / (kColumns * kRows);
}

}  // namespace recollect::matching
