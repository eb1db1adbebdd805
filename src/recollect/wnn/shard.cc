#include "recollect/wnn/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <torch/csrc/distributed/c10d/FileStore.hpp>
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#include <utility>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

// Runs a piece of c10d; its exceptions carry a stack trace, of which one line is enough.
template <typename Body>
auto Together(const ShardOptions& options, Body body) {
  try {
    return body();
  } catch (const std::exception& error) {
    const std::string text = error.what();
    throw Error(fmt::format("rank {} of {}", options.rank, options.ranks),
                "lost the others: " + text.substr(0, text.find('\n')),
                "start all ranks again, with a new rendezvous file");
  }
}

}  // namespace

struct Shard::Group {
  ShardOptions options;
  c10::intrusive_ptr<c10d::ProcessGroupGloo> gloo;

  explicit Group(const ShardOptions& o) : options(o) {
    gloo = Together(options, [&] {
      const std::chrono::milliseconds timeout(static_cast<std::int64_t>(options.timeout_s * 1000));
      auto store = c10::make_intrusive<c10d::FileStore>(options.rendezvous.string(), options.ranks);
      store->setTimeout(timeout);
      auto settings = c10d::ProcessGroupGloo::Options::create(timeout);
      settings->devices.push_back(c10d::ProcessGroupGloo::createDeviceForHostname(options.host));
      return c10::make_intrusive<c10d::ProcessGroupGloo>(store, options.rank, options.ranks,
                                                         settings);
    });
  }

  // Element by element the least, or the sum, over all ranks; in place.
  void Reduce(std::span<std::int64_t> values, c10d::ReduceOp how) {
    Together(options, [&] {
      std::vector<at::Tensor> tensors = {
          at::from_blob(values.data(), {static_cast<std::int64_t>(values.size())}, at::kLong)};
      c10d::AllreduceOptions reduce;
      reduce.reduceOp = how;
      return gloo->allreduce(tensors, reduce)->wait();
    });
  }
};

Shard::Shard(const Memory& slice, ThreadPool& pool, const ShardOptions& options)
    : slice_(slice), pool_(pool) {
  Require(options.ranks > 0 && options.rank >= 0 && options.rank < options.ranks, "shard",
          fmt::format("rank {} of {}", options.rank, options.ranks));
  group_ = std::make_unique<Group>(options);

  // How many entries and neurons each rank has; a sum over vectors that are zero elsewhere.
  const auto ranks = static_cast<std::size_t>(options.ranks);
  const auto rank = static_cast<std::size_t>(options.rank);
  std::vector<std::int64_t> sizes(2 * ranks, 0);
  sizes[rank] = slice.entries();
  sizes[ranks + rank] = slice.neurons();
  group_->Reduce(sizes, c10d::ReduceOp::SUM);
  std::int64_t all = 0;
  for (std::size_t r = 0; r < ranks; ++r) {
    Require(sizes[ranks + r] == slice.neurons(), fmt::format("rank {}", r),
            fmt::format("{} neurons where rank {} has {}", sizes[ranks + r], options.rank,
                        slice.neurons()));
    if (r == rank) first_entry_ = static_cast<int>(all);
    all += sizes[r];
  }
  std::vector<std::int64_t> labels(static_cast<std::size_t>(all), 0);
  for (int i = 0; i < slice.entries(); ++i) {
    const bool own = slice.label(i) == i;
    labels[static_cast<std::size_t>(first_entry_ + i)] = slice.label(i) + (own ? first_entry_ : 0);
  }
  group_->Reduce(labels, c10d::ReduceOp::SUM);
  labels_.assign(labels.begin(), labels.end());
}

Shard::~Shard() = default;

Recollection Shard::Recollect(std::span<const std::uint64_t> pattern,
                              const SearchOptions& options) {
  const std::vector<Answer> own = AskAll(slice_, pattern, pool_, options, first_entry_);
  std::vector<std::int64_t> answers(own.begin(), own.end());  // the top bit of an answer is 0
  group_->Reduce(answers, c10d::ReduceOp::MIN);
  return CountVotes(labels_, std::vector<Answer>(answers.begin(), answers.end()));
}

}  // namespace recollect::wnn
