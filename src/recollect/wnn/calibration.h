#pragma once

#include <array>
#include <span>
#include <vector>

#include "recollect/wnn/sequence.h"

namespace recollect::wnn {

// One live image whose place is known, for fitting.
struct Trial {
  std::vector<LabelVotes> histogram;
  int neurons = 0;
  std::vector<int> right;  // places within one of the truth; empty: it lies nowhere on the route
  std::vector<int> exact;  // of these the nearest ones of other laps, where these saw the place
  int place = -1;          // of the mapped image that it is; -1: of none, or it lies nowhere
  bool copy = false;       // a changed copy of a mapped image, for want of another visit
};

// What the committee's votes are worth.
struct Calibration {
  // Log odds: weights times 1, the log of the most votes of a place within one of the answer over
  // the most of any other, and the log of the share of neurons that supports it, per lap.
  using Weights = std::array<double, 3>;
  // As trials among laps of other roads taught, before those of the map at hand have their say.
  Weights right{3, 12.5, 1.5};  // of being right, given that the image is of the route
  Weights here{11, 3, 5.5};     // of being of the route
  // What votes tell of images that follow each other, which go wrong together.
  VoteModel sequence;
  // Thresholds on the probability that Judge gives, rising with `precision`.
  struct Threshold {
    double precision = 0, probability = 0;
  };
  std::vector<Threshold> thresholds;
  int trials = 0;  // that it rests on
};

// The votes' best answer and how likely it is right within one place.
struct Judged {
  int place = -1;
  double probability = 0;
};
Judged Judge(const Calibration& calibration, const Route& route,
             std::span<const LabelVotes> histogram, int neurons);

// Fits the chance that answers are right to trials that lie on the route, and the chance to be on
// it to these and those from nowhere (two logistic regressions), both drawn to the default: trials
// of one lap's changed copies hardly move it. Thresholds: at each, so many of the answers kept are
// right and at most the rest of the images from nowhere are kept; but an image that is itself given
// the wanted probability always is, with changed copies alone no other, and one with more than four
// times the wanted doubt never is. The model of sequences
// is fit to what a Bayes filter believes of the truth, over trials whose places follow each other
// and were seen by other laps; without any such it is the default. Throws Error without a trial
// that lies on the route.
Calibration Calibrate(const Route& route, std::span<const Trial> trials);

// Threshold for a wanted precision in [0, 1): the first of the table that promises as much, 1 where
// none does.
double ThresholdFor(const Calibration& calibration, double precision);

}  // namespace recollect::wnn
