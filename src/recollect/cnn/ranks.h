#pragma once

#include <torch/torch.h>

#include <memory>

#include "recollect/cnn/rank_options.h"

namespace recollect::cnn {

// The processes that train one network together; c10d's Gloo carries their messages, NCCL what lies
// on graphics cards where libtorch has it (else it goes by way of the processor). All must call
// the same things in the same order. Everything throws Error where a rank is lost, and the object
// is of no more use then.
class Ranks {
 public:
  // Waits for all ranks.
  explicit Ranks(const RankOptions& options);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return options_.rank; }
  int ranks() const { return options_.ranks; }

  // Element by element the sum, or the mean, over all ranks; in place, in any order of memory that
  // is dense and equal on all ranks.
  void Sum(torch::Tensor values) const;
  void Mean(torch::Tensor values) const;

  // Mean of the parameters' gradients; undefined ones count as zero.
  void MeanGradients(torch::nn::Module& network) const;

 private:
  struct Group;
  RankOptions options_;
  std::unique_ptr<Group> group_;  // none where there is one rank
};

}  // namespace recollect::cnn
