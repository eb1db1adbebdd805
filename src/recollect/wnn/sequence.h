#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "recollect/wnn/memory.h"
#include "recollect/wnn/route.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

// What one image says of where it was taken.
struct Observation {
  std::span<const LabelVotes> histogram;  // the committee's
  int neurons = 0;                        // that voted
  // Mean Hamming distance over neurons, by place (MeanDistances); only kSabgl looks at it.
  std::span<const float> distances;
  std::optional<double> moved;  // places passed since the image before, where odometry tells
};

// How a live image's place follows from it and from those before it.
enum class Filter {
  kNone,   // from the image alone
  kSabgl,  // Forechi et al. 2016: subsequence dynamic time warping of mean Hamming distances
  kBayes,  // discrete Bayes filter over places and speeds
};

// Likelihood of a place: (its support / neurons + floor) ^ trust (its votes / neurons + floor) ^
// sharpness, times how steady it is (Steadiness). Fit on laps by Calibrate.
struct VoteModel {
  double floor = 0.02, trust = 0.75, sharpness = 1;
};

struct SequenceOptions {
  Filter filter = Filter::kBayes;
  // Images that count, the present one among them; 0 (kBayes only): all. Of what was before them
  // kBayes remembers how fast one usually moves, and no place.
  int history = 10;
  VoteModel votes = {};
  double jump = 1e-3;       // chance to be anywhere at all at the next image
  double change_lap = 0.1;  // chance to follow, from here on, another lap through this place
  bool backwards = false;   // whether one may go against the direction of the laps
};

// Histogram in, belief out, one image at a time; time and memory an image are bounded.
class Sequence {
 public:
  virtual ~Sequence() = default;
  // Probability by place, given this image and its predecessors; sums to 1.
  virtual std::vector<double> Update(const Observation& observation) = 0;
  // Forgets all images.
  virtual void Reset() = 0;
};

// `route` is copied. Throws Error on options out of range.
std::unique_ptr<Sequence> MakeSequence(const SequenceOptions& options, const Route& route);

// The place that a belief stands for: of those within one of each other (see Route) that hold most
// of it, the one that stands out most in the present image (Outstanding); the likeliest where none
// has votes.
struct PlaceBelief {
  int place = -1;
  double probability = 0;  // of these, says the belief
};
PlaceBelief MostLikely(const Route& route, std::span<const double> belief,
                       std::span<const LabelVotes> histogram = {});

// The likelihood of every place given one image, up to a factor.
std::vector<double> Likelihood(const VoteModel& model, const Route& route,
                               const Observation& observation);

// Mean Hamming distance over neurons of a pattern to every entry.
std::vector<float> MeanDistances(const Memory& memory, std::span<const std::uint64_t> pattern,
                                 ThreadPool& pool);

}  // namespace recollect::wnn
