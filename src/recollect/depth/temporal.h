#pragma once

#include <cstdint>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/depth/matcher.h"

namespace recollect::stereo {

// How well the depth of one frame, moved into the next by the true poses, agrees with the depth
// there: |moved - there| / there, for pixels that land in the next image. A check that needs no
// true depth; what moves by itself or is newly hidden counts as it comes.
struct TemporalAgreement {
  Method method = Method::kSps;
  double median = 0;        // of all pixels, holes filled from the background
  double median_valid = 0;  // of those that both frames measured
  double density = 0;       // share of pixels that have a disparity
};

// sps, sgm and sgbm on a lap's frames. Throws Error where no two frames in a row have right images.
std::vector<TemporalAgreement> CompareOverTime(const Lap& lap, const MatchOptions& options,
                                               ThreadPool& pool, const ProgressSink& progress = {});

// The relative differences of one pair of depth images (metres, 0 unknown), as above.
std::vector<double> MovedDepthErrors(const cv::Mat& depth, const cv::Mat& next_depth,
                                     const SE3& next_from_this, const PinholeCamera& camera);

}  // namespace recollect::stereo
