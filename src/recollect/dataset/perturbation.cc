#include "recollect/dataset/perturbation.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect {
namespace {

// Reads a visit's numbers one by one.
class Draws {
 public:
  explicit Draws(const Visit& visit) : visit_(visit) {}
  double Uniform(double low, double high) { return low + (high - low) * visit_.at[next_++]; }
  double EitherWay(double most) { return Uniform(-most, most); }

 private:
  const Visit& visit_;
  std::size_t next_ = 0;
};

// Roll and zoom about the centre, shear, shift, bend.
cv::Mat Moved(const cv::Mat& image, Draws& draws, const Perturbation& by) {
  const cv::Point2f centre(static_cast<float>(image.cols) / 2, static_cast<float>(image.rows) / 2);
  const double turn = draws.EitherWay(by.turn_deg), zoom = 1 + draws.EitherWay(by.scale);
  cv::Mat motion = cv::getRotationMatrix2D(centre, turn, zoom);
  const double shear = draws.EitherWay(by.shear);
  motion.at<double>(0, 1) += shear;
  motion.at<double>(0, 2) -= shear * image.rows / 2;
  motion.at<double>(0, 2) += image.cols * draws.EitherWay(by.shift_x);
  motion.at<double>(1, 2) += image.cols * draws.EitherWay(by.shift_y);
  cv::invertAffineTransform(motion, motion);
  const double bend = draws.EitherWay(by.bend);
  cv::Mat at(image.size(), CV_32FC2), seen;
  for (int y = 0; y < image.rows; ++y) {
    auto* row = at.ptr<cv::Vec2f>(y);
    for (int x = 0; x < image.cols; ++x) {
      const double u = x - double{centre.x}, bent = centre.x + u / (u < 0 ? 1 + bend : 1 - bend);
      for (int i = 0; i < 2; ++i) {
        row[x][i] = static_cast<float>(motion.at<double>(i, 0) * bent +
                                       motion.at<double>(i, 1) * y + motion.at<double>(i, 2));
      }
    }
  }
  cv::remap(image, seen, at, {}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const double blur = draws.Uniform(0, by.blur) * image.cols;
  if (blur > 0.2) cv::GaussianBlur(seen, seen, {}, blur);
  return seen;
}

// Light: gamma, gain, shading over the image, colour of the lamp, noise.
void Relight(cv::Mat& image, Draws& draws, Random& random, const Perturbation& by) {
  const double gamma = std::exp(draws.EitherWay(by.gamma));
  const double gain = std::exp(draws.EitherWay(by.gain));
  const double shade_x = draws.EitherWay(by.shade), shade_y = draws.EitherWay(by.shade);
  const double blue = 1 + draws.EitherWay(by.tint), red = 1 + draws.EitherWay(by.tint);
  const double tint[3] = {blue, 1, red};
  double curve[256];
  for (int i = 0; i < 256; ++i) curve[i] = std::pow(i / 255.0, gamma) * gain * 255;
  for (int y = 0; y < image.rows; ++y) {
    auto* row = image.ptr<cv::Vec3b>(y);
    const double down = 1 + shade_y * (2.0 * y / image.rows - 1);
    for (int x = 0; x < image.cols; ++x) {
      const double light = down * (1 + shade_x * (2.0 * x / image.cols - 1));
      const double noise = by.noise * random.Normal();
      for (int c = 0; c < 3; ++c) {
        row[x][c] = cv::saturate_cast<std::uint8_t>(curve[row[x][c]] * light * tint[c] + noise);
      }
    }
  }
}

void Cover(cv::Mat& image, Draws& draws, const Perturbation& by) {
  const int width = static_cast<int>(image.cols * draws.Uniform(0, by.cover));
  const int height = static_cast<int>(image.rows * draws.Uniform(0, by.cover));
  cv::Scalar colour;
  for (int c = 0; c < 3; ++c) colour[c] = draws.Uniform(0, 128);
  const cv::Point at(static_cast<int>(draws.Uniform(0, image.cols - width)),
                     static_cast<int>(draws.Uniform(0, image.rows - height)));
  cv::rectangle(image, cv::Rect(at, cv::Size(width, height)), colour, cv::FILLED);
}

}  // namespace

Visit DrawVisit(std::uint64_t seed) {
  Random random(seed);
  Visit visit;
  for (double& one : visit.at) one = random.Uniform();
  return visit;
}

Visit VisitAlong(std::uint64_t seed, int place, int length) {
  Require(place >= 0 && length > 0, "visit", "needs a place and a length");
  const auto knot = static_cast<std::uint64_t>(place / length);
  const double share = static_cast<double>(place % length) / length;
  Visit visit = DrawVisit(SubSeed(seed, knot));
  const Visit after = DrawVisit(SubSeed(seed, knot + 1));
  for (std::size_t i = 0; i < visit.at.size(); ++i) {
    visit.at[i] += share * (after.at[i] - visit.at[i]);
  }
  return visit;
}

cv::Mat Perturbed(const cv::Mat& image, const Visit& visit, std::uint64_t seed,
                  const Perturbation& by) {
  Require(image.type() == CV_8UC3 && !image.empty(), "image", "is not 8-bit colour");
  Draws draws(visit);
  Random random(seed);
  cv::Mat seen = Moved(image, draws, by);
  Relight(seen, draws, random, by);
  Cover(seen, draws, by);
  return seen;
}

cv::Mat Perturbed(const cv::Mat& image, std::uint64_t seed, const Perturbation& by) {
  return Perturbed(image, DrawVisit(seed), SubSeed(seed, 1), by);
}

}  // namespace recollect
