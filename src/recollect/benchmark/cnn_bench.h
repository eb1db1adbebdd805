#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "recollect/core/progress.h"

namespace recollect {

struct CnnBenchOptions {
  int threads = 0;  // 0: one a core
  int batch = 24;
  int steps = 3;       // training steps timed, after one that is not
  int questions = 20;  // pairs asked, one after the other, after three that do not count
  int checks = 100;    // random pairs whose answers are compared with libtorch's
  std::uint64_t seed = 1;
};

// The networks on made-up images, ours beside libtorch as installed: its own layers and Adam, and
// malloc as it comes. Each leg has a process of its own. Medians of the wall's clock, and of the
// processor time of all threads in the fields named cpu; network A but for those named
// compact:
//  train_step_s.{ours,ours_bf16,libtorch}      forward, backward and Adam
//  infer_ms.{ours_fp32,ours_bf16,compact,compact_bf16,libtorch}
//                                              one pair, from 8-bit crops to its SE3
//  infer_batch_ms                              ours_fp32, a pair where one live image meets eight
//  train_ratio, infer_ratio                    ours / libtorch
//  peak_gflops                                 of a plain large convolution
//  share_of_peak.{train,infer}                 of that, that our arithmetic comes to
//  answers.{fp32,bf16}.{position_m,rotation_rad}     greatest difference from libtorch's
// Throws Error when a process fails.
nlohmann::json RunCnnBench(const CnnBenchOptions& options, const ProgressSink& progress = {});
std::string DescribeCnnBench(const nlohmann::json& figures);

}  // namespace recollect
