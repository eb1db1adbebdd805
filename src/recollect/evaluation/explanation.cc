#include "recollect/evaluation/explanation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

constexpr int kPanel = 480;   // pixels
constexpr int kCaption = 28;  // height of a line of text
constexpr int kFullVotes = 4;
const cv::Scalar kWinner(80, 220, 80), kRunnerUp(60, 120, 255);

// An image a panel wide with its caption above.
cv::Mat Panel(const cv::Mat& image, const std::string& caption, int height,
              const cv::Scalar& colour = cv::Scalar::all(230)) {
  cv::Mat panel(height + kCaption, kPanel, CV_8UC3, cv::Scalar::all(24));
  if (!image.empty()) {
    cv::resize(image, panel.rowRange(kCaption, height + kCaption), {kPanel, height}, 0, 0,
               image.cols > kPanel ? cv::INTER_AREA : cv::INTER_LINEAR);
  }
  double scale = 0.5;
  int below = 0;
  const int width = cv::getTextSize(caption, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &below).width;
  scale *= std::min(1.0, (kPanel - 12.0) / std::max(1, width));
  cv::putText(panel, caption, {6, kCaption - 9}, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1,
              cv::LINE_AA);
  return panel;
}

// How much each neuron votes, from 0 to 1, as an image of its grid.
cv::Mat VotesOf(const wnn::Explanation& why, const wnn::Voters& voters) {
  cv::Mat votes(why.rows, why.columns, CV_32F, cv::Scalar(0));
  for (std::size_t i = 0; i < voters.halves.size(); ++i) {
    votes.at<float>(static_cast<int>(i) / why.columns, static_cast<int>(i) % why.columns) =
        static_cast<float>(std::min(1.0, voters.halves[i] / double{kFullVotes}));
  }
  return votes;
}

// The live image in dim gray, in its own light where neurons vote, which are framed by a tint.
cv::Mat Lit(const cv::Mat& live, const cv::Mat& votes, double window_aspect,
            const cv::Scalar& tint) {
  cv::Mat gray, lit;
  cv::cvtColor(live, gray, cv::COLOR_BGR2GRAY);
  cv::cvtColor(gray, lit, cv::COLOR_GRAY2BGR);
  lit *= 0.35;
  const int window = std::min(live.rows, static_cast<int>(std::lround(live.cols * window_aspect)));
  cv::Mat share;
  cv::resize(votes, share, {live.cols, window}, 0, 0, cv::INTER_NEAREST);
  for (int y = 0; y < window; ++y) {
    for (int x = 0; x < live.cols; ++x) {
      const double s = share.at<float>(y, x);
      if (s <= 0) continue;
      const cv::Vec3b own = live.at<cv::Vec3b>(y, x);
      cv::Vec3b& to = lit.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) {
        const double bright = 0.7 * own[c] + 0.3 * tint[c];
        to[c] = cv::saturate_cast<std::uint8_t>((1 - s) * to[c] + s * bright);
      }
    }
  }
  return lit;
}

// Both votes by colour, on black.
cv::Mat Both(const cv::Mat& winner, const cv::Mat& runner_up) {
  cv::Mat both(winner.size(), CV_8UC3);
  for (int y = 0; y < both.rows; ++y) {
    for (int x = 0; x < both.cols; ++x) {
      const double a = winner.at<float>(y, x), b = runner_up.at<float>(y, x);
      for (int c = 0; c < 3; ++c) {
        both.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<std::uint8_t>(a * kWinner[c] + b * kRunnerUp[c]);
      }
    }
  }
  cv::Mat large;
  cv::resize(both, large, {kPanel, kPanel * both.rows / both.cols}, 0, 0, cv::INTER_NEAREST);
  return large;
}

nlohmann::json ToJson(const wnn::Explanation& why, const wnn::Voters& voters) {
  if (voters.label < 0) return nullptr;
  std::vector<std::string> rows(static_cast<std::size_t>(why.rows));
  for (std::size_t i = 0; i < voters.halves.size(); ++i) {
    rows[i / static_cast<std::size_t>(why.columns)] += static_cast<char>('0' + voters.halves[i]);
  }
  return {{"key_frame", voters.label}, {"votes", voters.votes}, {"neurons", rows}};
}

}  // namespace

cv::Mat DrawExplanation(const ExplainedImage& live, const ExplainedImage& recollected,
                        const ExplainedImage& runner_up, const wnn::Explanation& why,
                        double window_aspect) {
  Require(live.image.type() == CV_8UC3 && why.columns > 0 && why.rows > 0, "explanation",
          "needs a live image in colour and a grid of neurons");
  const int height = kPanel * live.image.rows / live.image.cols;
  const cv::Mat first = VotesOf(why, why.winner), second = VotesOf(why, why.runner_up);
  cv::Mat above, below, both(height, kPanel, CV_8UC3, cv::Scalar::all(0));
  const cv::Mat votes = Both(first, second);
  const int rows = std::min(height, votes.rows);
  votes.rowRange(0, rows).copyTo(both.rowRange(0, rows));
  cv::hconcat(std::vector<cv::Mat>{Panel(live.image, live.caption, height),
                                   Panel(recollected.image, recollected.caption, height, kWinner),
                                   Panel(runner_up.image, runner_up.caption, height, kRunnerUp)},
              above);
  cv::hconcat(
      std::vector<cv::Mat>{
          Panel(both, "neurons: green for the recollected, orange for the runner-up", height),
          Panel(Lit(live.image, first, window_aspect, kWinner), "what voted for the recollected",
                height, kWinner),
          Panel(Lit(live.image, second, window_aspect, kRunnerUp), "what voted for the runner-up",
                height, kRunnerUp)},
      below);
  cv::Mat picture;
  cv::vconcat(above, below, picture);
  return picture;
}

void WriteExplanation(const std::filesystem::path& file, const cv::Mat& picture) {
  const std::string kind = file.extension() == ".png" ? ".png" : ".jpg";
  std::vector<unsigned char> bytes;
  cv::imencode(kind, picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  AtomicWrite(file, std::string(bytes.begin(), bytes.end()));
}

nlohmann::json ToJson(const wnn::Explanation& why) {
  return {{"columns", why.columns},
          {"rows", why.rows},
          {"winner", ToJson(why, why.winner)},
          {"runner_up", ToJson(why, why.runner_up)}};
}

}  // namespace recollect
