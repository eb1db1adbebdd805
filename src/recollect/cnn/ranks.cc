#include "recollect/cnn/ranks.h"

#include <chrono>
#include <cstdlib>
#include <exception>
#include <torch/csrc/distributed/c10d/PrefixStore.hpp>
#include <torch/csrc/distributed/c10d/ProcessGroupGloo.hpp>
#include <torch/csrc/distributed/c10d/ProcessGroupNCCL.hpp>  // nothing where libtorch has none
#include <torch/csrc/distributed/c10d/TCPStore.hpp>

#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

// Runs a piece of c10d; its exceptions carry a stack trace, of which one line is enough.
template <typename Body>
auto Together(const RankOptions& options, Body body) {
  try {
    return body();
  } catch (const std::exception& error) {
    const std::string text = error.what();
    throw Error(fmt::format("rank {} of {}", options.rank, options.ranks),
                "lost the others: " + text.substr(0, text.find('\n')),
                "start all ranks again with --resume");
  }
}

int NumberFrom(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  if (text == nullptr) return otherwise;
  char* end = nullptr;
  const long number = std::strtol(text, &end, 10);
  Require(end != text && *end == '\0' && number >= 0 && number < 65536, variable,
          fmt::format("'{}' is no number from 0 to 65535", text));
  return static_cast<int>(number);
}

using Milliseconds = std::chrono::milliseconds;

// What carries tensors of graphics cards from one to the other; null where libtorch cannot.
c10::intrusive_ptr<c10d::ProcessGroup> BetweenCards(
    [[maybe_unused]] const c10::intrusive_ptr<c10d::Store>& store,
    [[maybe_unused]] const RankOptions& options, [[maybe_unused]] Milliseconds timeout) {
#ifdef USE_C10D_NCCL
  if (torch::cuda::is_available()) {
    setenv("NCCL_BLOCKING_WAIT", "1", 0);  // a lost rank is an error, not an endless wait
    auto settings = c10d::ProcessGroupNCCL::Options::create();
    settings->timeout = timeout;
    return c10::make_intrusive<c10d::ProcessGroupNCCL>(
        c10::make_intrusive<c10d::PrefixStore>("nccl", store), options.rank, options.ranks,
        settings);
  }
#endif
  return {};
}

}  // namespace

RankOptions RankOptionsFromEnvironment() {
  RankOptions options;
  options.ranks = NumberFrom("WORLD_SIZE", 1);
  options.rank = NumberFrom("RANK", 0);
  options.port = NumberFrom("MASTER_PORT", options.port);
  if (const char* address = std::getenv("MASTER_ADDR")) options.address = address;
  Require(options.ranks >= 1, "WORLD_SIZE", "must be positive");
  Require(options.rank < options.ranks, "RANK",
          fmt::format("is {} where WORLD_SIZE is {}", options.rank, options.ranks));
  return options;
}

struct Ranks::Group {
  c10::intrusive_ptr<c10d::ProcessGroup> gloo, cards;  // the second where libtorch has NCCL
};

Ranks::Ranks(const RankOptions& options) : options_(options) {
  if (options.ranks == 1) return;
  group_ = std::make_unique<Group>();
  Together(options, [&] {
    const Milliseconds timeout(static_cast<std::int64_t>(options.timeout_s * 1000));
    c10d::TCPStoreOptions meeting;
    meeting.port = static_cast<std::uint16_t>(options.port);
    meeting.isServer = options.rank == 0;
    meeting.numWorkers = static_cast<std::size_t>(options.ranks);
    meeting.timeout = timeout;
    auto store = c10::make_intrusive<c10d::TCPStore>(options.address, meeting);
    auto settings = c10d::ProcessGroupGloo::Options::create(timeout);
    const bool here = options.address == "127.0.0.1" || options.address == "localhost";
    settings->devices.push_back(
        here ? c10d::ProcessGroupGloo::createDeviceForHostname(options.address)
             : c10d::ProcessGroupGloo::createDefaultDevice());
    group_->gloo =
        c10::make_intrusive<c10d::ProcessGroupGloo>(store, options.rank, options.ranks, settings);
    group_->cards = BetweenCards(store, options, timeout);
  });
}

Ranks::~Ranks() = default;

void Ranks::Sum(torch::Tensor values) const {
  if (!group_) return;
  const torch::NoGradGuard no_gradients;
  Require(values.is_non_overlapping_and_dense(), "ranks", "values with gaps between them");
  torch::Tensor flat = values.as_strided({values.numel()}, {1});
  const auto& cards = group_->cards;
  if (values.is_cuda() && cards) {
    std::vector<at::Tensor> sent = {flat};
    Together(options_, [&] { return cards->allreduce(sent)->wait(); });
    return;
  }
  std::vector<at::Tensor> sent = {flat.cpu()};  // itself where it is the processor's
  Together(options_, [&] { return group_->gloo->allreduce(sent)->wait(); });
  if (!values.is_cpu()) flat.copy_(sent[0]);
}

void Ranks::Mean(torch::Tensor values) const {
  if (!group_) return;
  Sum(values);
  const torch::NoGradGuard no_gradients;
  values.div_(options_.ranks);
}

void Ranks::MeanGradients(torch::nn::Module& network) const {
  if (!group_) return;
  for (auto& parameter : network.parameters()) {
    torch::Tensor& gradient = parameter.mutable_grad();
    if (!gradient.defined()) gradient = torch::zeros_like(parameter);
    Mean(gradient);
  }
}

}  // namespace recollect::cnn
