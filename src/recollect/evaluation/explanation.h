#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <string>

#include "recollect/wnn/explanation.h"

namespace recollect {

// A picture of why the committee answered as it did, and the same as JSON.

struct ExplainedImage {
  cv::Mat image;  // 8-bit B, G, R; empty: there is none
  std::string caption;
};

// Above, side by side: the live image, the recollected one, the runner-up. Below: all neurons'
// votes for either, then the live image lit where neurons voted for the recollected one, and where
// for the runner-up. window_aspect: NetworkOptions's, the part of the image that neurons look at.
cv::Mat DrawExplanation(const ExplainedImage& live, const ExplainedImage& recollected,
                        const ExplainedImage& runner_up, const wnn::Explanation& why,
                        double window_aspect);

// As a JPEG or PNG file, by its ending. Throws Error where it cannot be written.
void WriteExplanation(const std::filesystem::path& file, const cv::Mat& picture);

// {"columns", "rows", "winner": {"key_frame", "votes", "neurons": [...]}, "runner_up": the same or
// null}: a string a row of the neuron grid, a digit a neuron, its half votes (0 to 4).
nlohmann::json ToJson(const wnn::Explanation& why);

}  // namespace recollect
