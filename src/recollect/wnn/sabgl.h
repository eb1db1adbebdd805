#pragma once

#include <deque>
#include <vector>

#include "recollect/wnn/encoder.h"
#include "recollect/wnn/sequence.h"

namespace recollect::wnn {

// MeanDistances of the image, for every entry under the displacement that makes it least.
std::vector<float> DisplacedDistances(const Memory& memory, Encoder& encoder,
                                      const ImageView& image, ThreadPool& pool);

// SABGL (Forechi et al. 2016), online. Every sequence of the last 1, 2, ... n images is warped onto
// the laps (subsequence dynamic time warping over mean Hamming distances, steps (0,1), (1,0),
// (1,1), free start); each gives a vote to the place where its last image ends up, and the belief
// is the share of these overlapping sequences' votes. Laps are not warped across their ends.
class Sabgl final : public Sequence {
 public:
  Sabgl(int length, const Route& route);
  // Throws Error where the observation has no distances.
  std::vector<double> Update(const Observation& observation) override;
  void Reset() override { distances_.clear(); }

 private:
  int EndOf(std::size_t length) const;

  std::size_t length_;
  Route route_;
  std::vector<int> order_;  // places such that each comes after the one before it on its lap
  std::deque<std::vector<float>> distances_;  // of the last images
};

}  // namespace recollect::wnn
