#pragma once

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
};

// What the committee's votes are worth.
struct Calibration {
  VoteModel votes;
  // The same of images that follow each other: they go wrong together, so each tells less.
  VoteModel sequence;
  double weights[3] = {0, 1, 0};  // log odds of being right: 1, log odds of the belief, log of
                                  // the support's share; see ProbabilityRight
  // Thresholds on ProbabilityRight, rising with `precision`.
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

// Fits the vote model to the likelihood of the (exact) truth of the trials that lie on the route,
// the weights to whether their answers are right (logistic regression), and the thresholds to both
// those trials and those from nowhere: at each, so many of the answers kept are right, and at most
// the rest of the images from nowhere are kept. The model of sequences is fit to what a Bayes
// filter believes of the truth, over trials whose places follow each other and were seen by other
// laps; without any such it is the default. Throws Error without a trial that lies on the route.
Calibration Calibrate(const Route& route, std::span<const Trial> trials);

// Threshold for a wanted precision in [0, 1): the first of the table that promises as much, 1 where
// none does.
double ThresholdFor(const Calibration& calibration, double precision);

}  // namespace recollect::wnn
