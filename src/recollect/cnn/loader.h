#pragma once

#include <torch/torch.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "recollect/cnn/network_kind.h"
#include "recollect/cnn/pair_data.h"
#include "recollect/cnn/pair_view.h"

namespace recollect::cnn {

// Fills `out`, [3, H, W] of R, G, B, with an image as the network wants it: contrast-normalised for
// the compact network, values / 255 for the paper's. image: the crop, 8-bit B, G, R.
void PrepareImage(NetworkKind kind, const cv::Mat& image, float* out);

struct Batch {
  torch::Tensor live, key;  // [B, 3, H, W]
  torch::Tensor motion;     // [B, 3, 4], true keyframe_from_live
  torch::Tensor depth;      // [B, H / kDepthStep, W / kDepthStep] of the live images, 0: unknown

  Batch To(const torch::Device& device) const;
};

// Pairs `chosen` of `data`, images as they are.
Batch MakeBatch(const PairData& data, NetworkKind kind, std::span<const std::size_t> chosen);

struct LoaderOptions {
  NetworkKind kind = NetworkKind::kCompact;
  int batch = 24;
  bool augment = false;  // AugmentLight on each image by itself
  std::uint64_t seed = 1;
  int rank = 0, ranks = 1;  // of several processes each gets its own share of every batch
  ViewOptions view = {};    // AugmentView on each pair
};

// Batches of shuffled pairs, made ahead by a thread of its own. Batch number n is the same
// whenever it is asked for: it follows from seed and n alone, which makes training resumable.
// An epoch is pairs / batch batches; what does not fill a batch is left out, and differs each time.
class Loader {
 public:
  // `data` must outlive the loader. Begins with batch number `first`.
  Loader(const PairData& data, const LoaderOptions& options, std::int64_t first = 0);
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  static std::int64_t BatchesPerEpoch(const PairData& data, int batch);

  // The next batch. Rethrows what went wrong while making it.
  Batch Next();

 private:
  void Work();
  Batch Make(std::int64_t number);

  const PairData& data_;
  const LoaderOptions options_;
  std::int64_t number_;
  std::int64_t shuffled_epoch_ = -1;
  std::vector<std::size_t> order_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Batch> ready_;
  std::exception_ptr failure_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace recollect::cnn
