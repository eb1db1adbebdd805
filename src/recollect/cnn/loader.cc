#include "recollect/cnn/loader.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "recollect/cnn/augment.h"
#include "recollect/cnn/contrast.h"
#include "recollect/core/random.h"

namespace recollect::cnn {
namespace {

constexpr std::size_t kAhead = 3;  // batches made before they are asked for

void PutMotion(const SE3& motion, float* out) {
  Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>> values(out);
  values = motion.Matrix().topRows<3>().cast<float>();
}

}  // namespace

void PrepareImage(NetworkKind kind, const cv::Mat& image, float* out) {
  std::vector<cv::Mat> planes;
  cv::split(image, planes);
  std::reverse(planes.begin(), planes.end());  // to R, G, B
  for (cv::Mat& plane : planes) {
    cv::Mat values(image.size(), CV_32F, out);
    plane.convertTo(values, CV_32F, kind == NetworkKind::kCompact ? 1 : 1 / 255.0);
    plane = values;
    out += plane.total();
  }
  if (kind == NetworkKind::kCompact) NormaliseContrast(planes);
}

Batch Batch::To(const torch::Device& device) const {
  return {live.to(device), key.to(device), motion.to(device), depth.to(device)};
}

namespace {

// See MakeBatch; `change` is applied to each pair, and told which of `chosen` it is.
template <typename Change>
Batch Assemble(const PairData& data, NetworkKind kind, std::span<const std::size_t> chosen,
               const Change& change) {
  const auto count = static_cast<std::int64_t>(chosen.size());
  const std::int64_t rows = data.crop.height, columns = data.crop.width;
  Batch batch;
  batch.live = torch::empty({count, 3, rows, columns});
  batch.key = torch::empty({count, 3, rows, columns});
  batch.motion = torch::empty({count, 3, 4});
  const PinholeCamera grid = data.camera.Subsampled(kDepthStep);
  batch.depth = torch::zeros({count, grid.height, grid.width});
  const auto pixels = static_cast<std::size_t>(grid.height) * static_cast<std::size_t>(grid.width);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    PairView pair = ViewOf(data, data.pairs[chosen[i]]);
    change(i, pair);
    const std::size_t at = i * static_cast<std::size_t>(3 * rows * columns);
    PrepareImage(kind, pair.live, batch.live.data_ptr<float>() + at);
    PrepareImage(kind, pair.key, batch.key.data_ptr<float>() + at);
    PutMotion(pair.keyframe_from_live, batch.motion.data_ptr<float>() + i * 12);
    if (!pair.live_depth.empty()) {
      std::memcpy(batch.depth.data_ptr<float>() + i * pixels, pair.live_depth.data,
                  pixels * sizeof(float));
    }
  }
  return batch;
}

}  // namespace

Batch MakeBatch(const PairData& data, NetworkKind kind, std::span<const std::size_t> chosen) {
  return Assemble(data, kind, chosen, [](std::size_t, const PairView&) {});
}

Loader::Loader(const PairData& data, const LoaderOptions& options, std::int64_t first)
    : data_(data), options_(options), number_(first), thread_([this] { Work(); }) {}

Loader::~Loader() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::int64_t Loader::BatchesPerEpoch(const PairData& data, int batch) {
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(data.pairs.size()) / batch);
}

Batch Loader::Next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !ready_.empty() || failure_; });
  if (ready_.empty()) std::rethrow_exception(failure_);
  Batch batch = std::move(ready_.front());
  ready_.pop_front();
  changed_.notify_all();
  return batch;
}

void Loader::Work() {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || ready_.size() < kAhead; });
      if (stopping_) return;
    }
    Batch batch;
    std::exception_ptr failure;
    try {
      batch = Make(number_++);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    if (failure) {
      failure_ = failure;
    } else {
      ready_.push_back(std::move(batch));
    }
    changed_.notify_all();
    if (failure) return;
  }
}

Batch Loader::Make(std::int64_t number) {
  const std::int64_t per_epoch = BatchesPerEpoch(data_, options_.batch);
  const std::int64_t epoch = number / per_epoch;
  if (epoch != shuffled_epoch_) {
    order_.resize(data_.pairs.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    Random random(SubSeed(SubSeed(options_.seed, 1), static_cast<std::uint64_t>(epoch)));
    for (std::size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1],
                order_[static_cast<std::size_t>(random.Index(static_cast<std::int64_t>(i)))]);
    }
    shuffled_epoch_ = epoch;
  }
  const auto size = static_cast<std::size_t>(options_.batch);
  const std::size_t from = static_cast<std::size_t>(number % per_epoch) * size;
  const auto whole = std::span(order_).subspan(from, std::min(size, order_.size() - from));
  const auto rank = static_cast<std::size_t>(options_.rank);
  const auto ranks = static_cast<std::size_t>(options_.ranks);
  const std::size_t begin = whole.size() * rank / ranks;
  const auto chosen = whole.subspan(begin, whole.size() * (rank + 1) / ranks - begin);
  // What is drawn for a pair follows from its place in the whole batch, whoever makes it.
  const auto stream = [&](std::uint64_t key, std::size_t i) {
    const auto seed = SubSeed(SubSeed(options_.seed, key), static_cast<std::uint64_t>(number));
    return Random(SubSeed(seed, begin + i));
  };
  return Assemble(data_, options_.kind, chosen, [&](std::size_t i, PairView& pair) {
    if (options_.view.Any()) {
      Random random = stream(5, i);
      AugmentView(pair, data_.camera, options_.view, random);
    }
    if (options_.augment) {
      Random random = stream(2, i);
      pair.live = AugmentLight(pair.live, random);
      pair.key = AugmentLight(pair.key, random);
    }
  });
}

}  // namespace recollect::cnn
