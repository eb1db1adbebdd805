#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace recollect::simulation {

// What may go wrong with a camera. A dropped frame leaves no picture; a frozen one shows the last
// good picture again.
enum class Fault { kNone, kDropped, kFrozen, kBlack, kOverexposed, kHalfOccluded, kBlurred };

// How likely faults are and of which kinds.
struct FaultPlan {
  struct Entry {
    Fault fault;
    double share;  // of all frames
  };
  std::vector<Entry> entries;
};

// "none", "all", or a list such as "black,frozen=0.05": kinds with their share of the frames
// (0.02 where not given). Faults: dropped, frozen, black, overexposed, occluded, blurred. Throws
// Error for anything else and for shares that sum to more than 0.9.
FaultPlan ParseFaults(std::string_view text);
std::string Name(Fault fault);

// The fault of a frame of a lap, the same whenever it is asked for. Frozen, black and occluded
// frames come in runs of a few.
Fault FaultOf(const FaultPlan& plan, std::int64_t frame, std::uint64_t seed);

// Spoils a picture (8-bit B, G, R) in place; over-exposure and freezing are the renderer's matter.
void Spoil(Fault fault, std::uint64_t seed, cv::Mat& image);

// A camera with faults, for live images that are there already. Dropped frames are left as they
// are: there would be nothing to judge.
class FaultyCamera {
 public:
  FaultyCamera(FaultPlan plan, std::uint64_t seed) : plan_(std::move(plan)), seed_(seed) {}
  // Spoils the next image (8-bit B, G, R) as the plan says, and names the fault.
  std::string Take(cv::Mat& image);

 private:
  FaultPlan plan_;
  std::uint64_t seed_;
  std::int64_t frame_ = 0;
  cv::Mat good_;  // the last picture that was not frozen
};

}  // namespace recollect::simulation
