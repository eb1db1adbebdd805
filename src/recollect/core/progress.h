#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace recollect {

// A library function that takes long reports how far it is through one of these; what becomes of
// it (a terminal line, nothing) is the caller's choice. Called from one thread at a time.
struct Progress {
  std::string stage;       // what is being done, e.g. "train"
  std::int64_t done = 0;   // units finished
  std::int64_t total = 0;  // units in all; 0 where unknown
  std::string detail;      // figures worth a look, e.g. "loss 0.31 m"
};
using ProgressSink = std::function<void(const Progress&)>;

inline void Report(const ProgressSink& sink, const std::string& stage, std::int64_t done,
                   std::int64_t total, const std::string& detail = "") {
  if (sink) sink({stage, done, total, detail});
}

}  // namespace recollect
