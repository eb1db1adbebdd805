#pragma once

#include <string>

namespace recollect::cnn {

// This process among those that train one network together.
struct RankOptions {
  int rank = 0;                       // in [0, ranks); rank 0 validates and writes the files
  int ranks = 1;                      // 1: nobody else
  std::string address = "127.0.0.1";  // of rank 0's machine
  int port = 29500;                   // where rank 0 listens
  double timeout_s = 1800;  // longest wait for the others; it must hold a validation. A process
                            // that dies is noticed at once.
};

// From RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT, as torchrun and others set them; one rank
// where there is no WORLD_SIZE. Throws Error naming the variable that makes no sense.
RankOptions RankOptionsFromEnvironment();

}  // namespace recollect::cnn
