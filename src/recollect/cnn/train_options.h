#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "recollect/cnn/network_kind.h"
#include "recollect/cnn/pair_data.h"
#include "recollect/cnn/pair_view.h"
#include "recollect/cnn/precision.h"
#include "recollect/cnn/rank_options.h"

namespace recollect::cnn {

// What a pose is judged by (loss.h).
enum class LossKind {
  kProjection,     // the paper's: distances of the live image's points, metres
  kReprojection,   // distances of their projections in the key frame, pixels
  kL2,             // |t| + beta |rotation|
  kHomoscedastic,  // the same with weights that are learnt along
  kUncertainty,    // the paper's, and the likelihood of a covariance that is predicted, too
};

// "projection", "reprojection", "l2", "homoscedastic", "uncertainty", and back; throws Error on any
// other name.
std::string Name(LossKind kind);
LossKind LossKindFromName(const std::string& name);

struct LossOptions {
  double far_metres = 0;  // points further away are drawn to this depth (ProjectionLoss); 0: none
  // Of the auxiliary losses of networks that correlate (the paper has neither); 0 switches off.
  double correspondence_weight = 0;  // CorrespondenceLoss
  double depth_weight = 0;           // mean |log predicted depth / true depth|
  LossKind kind = LossKind::kProjection;
  double beta = 10;  // of kL2: metres that a radian counts as
};

enum class Schedule {
  kHalving,  // halved after each epoch, as in the paper
  kCosine,   // falls to zero along half a cosine over the whole training
};

// The defaults are the paper's regime.
struct TrainOptions {
  NetworkKind network = NetworkKind::kPaperA;
  int epochs = 7;
  double minutes = 0;  // wall time for all of it, data reading included; 0: no bound
  int batch = 24;
  double learning_rate = 1e-4;
  Schedule schedule = Schedule::kHalving;
  int warm_up_steps = 0;      // over which the rate rises from zero
  double weight_decay = 0;    // decoupled
  double gradient_limit = 0;  // length of the gradient beyond which it is scaled down; 0: none
  bool augment = false;       // AugmentLight
  Precision precision = Precision::kFloat32;  // PairNetwork::TrainIn
  ViewOptions view;                           // AugmentView; off
  // In (0, 1): what is validated and kept are the weights' moving averages, of which each step
  // leaves this share as it was (less over the first steps). 0: the weights themselves.
  double average = 0;
  LossOptions loss;
  PairOptions pairs;

  int validate_steps = 0;      // steps between validations; 0: an epoch
  int validation_pairs = 600;  // at most so many, evenly chosen
  int patience = 0;            // validations without a better one before training ends; 0: never
  // Without validation laps: the share of the road, in blocks of 40 m, that is not trained on but
  // validated.
  double validation_share = 0.1;

  std::uint64_t seed = 1;
  int threads = 0;     // 0: one for each core
  std::string device;  // where to train (DeviceNamed); empty: a graphics card where there is one

  std::filesystem::path
      start;                   // a model file whose weights training begins with; empty: fresh ones
  std::filesystem::path out;   // the model file; the best by validation so far is always there
  std::filesystem::path csv;   // curves, a row a validation; empty: none
  std::filesystem::path live;  // the same as a page that a browser keeps up to date; empty: none
  // Where training can be taken up again; written at each validation, removed at the end.
  std::filesystem::path checkpoint;  // empty: `out` with ".checkpoint" added
  bool resume = false;               // take up from the checkpoint if there is one
  std::function<bool()> stop;        // asked after each step: true writes a checkpoint and ends

  RankOptions ranks;  // one of several processes that train one network together

  // The paper's regime for its network A or B.
  static TrainOptions Paper(NetworkKind kind);
  // What suits the compact network: augmentation, auxiliary losses, AdamW with warm-up and cosine.
  static TrainOptions Compact();
};

}  // namespace recollect::cnn
