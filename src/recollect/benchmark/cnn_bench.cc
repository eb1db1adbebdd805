#include "recollect/benchmark/cnn_bench.h"

#include <fmt/format.h>
#include <torch/torch.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "recollect/benchmark/child_process.h"
#include "recollect/cnn/adam.h"
#include "recollect/cnn/convolution_taps.h"
#include "recollect/cnn/packed_layers.h"
#include "recollect/cnn/paper_network.h"
#include "recollect/cnn/pose_network.h"
#include "recollect/cnn/threads.h"
#include "recollect/cnn/training_loss.h"
#include "recollect/core/stopwatch.h"

namespace recollect {
namespace {

using cnn::NetworkKind;
using cnn::PoseNetwork;
using cnn::Precision;

constexpr int kTogether = 8;  // key frames that one live image is related to at once

// The paper's network by libtorch's own layers.
class PlainNetwork : public cnn::PairNetwork {
 public:
  explicit PlainNetwork(std::shared_ptr<cnn::PaperNetwork> network) : network_(network) {
    register_module("network", network_);
  }
  cnn::Prediction forward(const torch::Tensor& live, const torch::Tensor& key) override {
    return network_->ForwardPlain(live, key);
  }

 private:
  std::shared_ptr<cnn::PaperNetwork> network_;
};

// Weights whose answers are of the size of a trained network's: some metres, a tenth of a radian.
std::shared_ptr<cnn::PaperNetwork> NetworkA(std::uint64_t seed) {
  torch::manual_seed(seed);
  auto network = std::make_shared<cnn::PaperNetwork>(NetworkKind::kPaperA);
  const torch::NoGradGuard no_gradients;
  torch::Tensor last;
  for (auto& parameter : network->parameters()) {
    if (parameter.dim() == 4 && parameter.size(0) == 6) last = parameter;
  }
  last.normal_(0, 1e-4);
  network->eval();
  const torch::Tensor motion =
      network->ForwardPlain(torch::rand({1, 3, 240, 320}), torch::rand({1, 3, 240, 320})).motion[0];
  const torch::Tensor turned = motion.slice(1, 0, 3) - torch::eye(3);
  last.slice(0, 0, 3).mul_(0.1 / turned.norm());
  last.slice(0, 3, 6).mul_(2.0 / motion.select(1, 3).norm());
  return network;
}

PoseNetwork Asked(NetworkKind kind, std::shared_ptr<cnn::PairNetwork> network,
                  Precision precision) {
  cnn::ModelInfo info;
  info.network = kind;
  info.crop = cnn::DefaultCrop(kind, 640, 480);
  info.camera = info.crop.Apply(PinholeCamera{640, 480, 489, 489, 320, 240});
  if (!network) network = cnn::MakeNetwork(kind, info.camera);
  return {info, network, precision};
}

cv::Mat MadeUpImage(const cnn::Crop& crop, cv::RNG& random) {
  cv::Mat coarse(crop.height / 16, crop.width / 16, CV_8UC3), image;
  random.fill(coarse, cv::RNG::UNIFORM, 0, 255);
  cv::resize(coarse, image, {crop.width, crop.height}, 0, 0, cv::INTER_CUBIC);
  cv::Mat noise(image.size(), CV_8UC3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 32);
  return image + noise;
}

// Medians of wall and processor time, seconds, after `before` runs that do not count.
std::vector<double> Time(int before, int runs, const std::function<void()>& run) {
  std::vector<double> wall, cpu;
  for (int i = 0; i < before + runs; ++i) {
    const Stopwatch watch;
    const std::clock_t start = std::clock();
    run();
    if (i < before) continue;
    wall.push_back(watch.Seconds());
    cpu.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::sort(wall.begin(), wall.end());
  std::sort(cpu.begin(), cpu.end());
  return {wall[wall.size() / 2], cpu[cpu.size() / 2]};
}

void SetThreadsAsInstalled(int threads) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  at::set_num_threads(threads > 0 ? threads : std::max(1, cores));
}

std::vector<double> TimeQuestions(const PoseNetwork& network, const CnnBenchOptions& options) {
  cv::RNG random(options.seed);
  const cv::Mat live = MadeUpImage(network.crop(), random),
                key = MadeUpImage(network.crop(), random);
  return Time(3, options.questions, [&] { network.KeyframeFromLive(live, key); });
}

std::vector<double> TimeQuestionsTogether(const PoseNetwork& network,
                                          const CnnBenchOptions& options) {
  cv::RNG random(options.seed);
  const cv::Mat live = MadeUpImage(network.crop(), random);
  std::vector<cnn::CropPair> pairs;
  for (int i = 0; i < kTogether; ++i) pairs.push_back({live, MadeUpImage(network.crop(), random)});
  std::vector<double> times =
      Time(2, std::max(1, options.questions / 2), [&] { network.KeyframeFromLive(pairs); });
  for (double& time : times) time /= kTogether;
  return times;
}

std::vector<double> TimeSteps(bool ours, const CnnBenchOptions& options,
                              Precision precision = Precision::kFloat32) {
  const auto network = NetworkA(options.seed);
  network->train();
  const cnn::Crop crop = cnn::DefaultCrop(NetworkKind::kPaperA, 640, 480);
  const PinholeCamera camera = crop.Apply(PinholeCamera{640, 480, 489, 489, 320, 240});
  cnn::Batch batch;
  batch.live = torch::rand({options.batch, 3, crop.height, crop.width});
  batch.key = torch::rand({options.batch, 3, crop.height, crop.width});
  batch.motion = torch::eye(3, 4).repeat({options.batch, 1, 1});
  const PinholeCamera grid = camera.Subsampled(cnn::kDepthStep);
  batch.depth = torch::full({options.batch, grid.height, grid.width}, 10.F);
  const cnn::TrainingLoss loss(camera, {});
  network->TrainIn(precision);
  if (ours) {
    cnn::Adam adam(*network, {});
    return Time(1, options.steps, [&] {
      loss(network->forward(batch.live, batch.key), batch).total.backward();
      adam.Step(1e-4);
    });
  }
  torch::optim::Adam adam(network->parameters(), torch::optim::AdamOptions(1e-4));
  return Time(1, options.steps, [&] {
    adam.zero_grad();
    loss(network->ForwardPlain(batch.live, batch.key), batch).total.backward();
    adam.step();
  });
}

// Multiplications and additions of network A for a pair, those with padding left out: forward, and
// forward and backward.
struct Arithmetic {
  double forward = 0, step = 0;
};

Arithmetic OfNetworkA() {
  struct Layer {
    std::int64_t in, out, rows, columns, stride, padding;
  };
  constexpr std::array<Layer, 10> kLayers = {{{3, 64, 3, 3, 2, 1},
                                              {64, 64, 3, 3, 2, 1},
                                              {64, 128, 3, 3, 2, 1},
                                              {256, 256, 3, 3, 2, 1},
                                              {256, 256, 3, 3, 2, 1},
                                              {256, 512, 3, 3, 2, 1},
                                              {512, 1024, 3, 3, 2, 1},
                                              {1024, 4096, 3, 3, 2, 1},
                                              {4096, 4096, 1, 2, 1, 1},
                                              {4096, 6, 3, 3, 1, 0}}};
  Arithmetic sum;
  std::int64_t rows = 240, columns = 320;
  for (std::size_t i = 0; i < kLayers.size(); ++i) {
    const Layer& l = kLayers[i];
    const auto taps =
        cnn::ConvolutionTaps::Of(rows, columns, l.rows, l.columns, l.stride, l.padding);
    const auto inside = std::count_if(taps.sources.begin(), taps.sources.end(),
                                      [&](std::int64_t s) { return s < rows * columns; });
    const double images = i < 3 ? 2 : 1;  // the branch is run on both
    const double flops = images * 2 * static_cast<double>(inside * l.in * l.out);
    sum.forward += flops;
    sum.step += flops * (i == 0 ? 2 : 3);  // nobody asks for the images' gradients
    rows = taps.rows;
    columns = taps.columns;
  }
  return sum;
}

// Operations a second of one large convolution, 3 x 3 from 256 to 256 channels.
std::vector<double> Peak(Precision precision) {
  constexpr std::int64_t kImages = 4, kChannels = 256, kSide = 56;
  cnn::PackedConvolution layer(torch::rand({kChannels, kChannels, 3, 3}), torch::rand({kChannels}),
                               1, 1, 1, precision);
  const auto first =
      cnn::ToOnednn(torch::rand({kImages, kChannels, kSide, kSide}), cnn::DataType(precision));
  const dnnl::memory source(
      dnnl::memory::desc(first.get_desc().dims(), cnn::DataType(precision),
                         precision == Precision::kBfloat16 ? dnnl::memory::format_tag::nhwc
                                                           : dnnl::memory::format_tag::nChw16c),
      cnn::OnednnEngine());
  cnn::Copy(first, source);
  const double flops = 2.0 * kImages * kSide * kSide * kChannels * kChannels * 9;
  const std::vector<double> times = Time(2, 7, [&] {
    layer.Run(source);
    cnn::OnednnStream().wait();
  });
  return {flops / times[0], flops / times[1]};
}

// Greatest distance and angle between our answers and libtorch's.
std::vector<double> Compare(const CnnBenchOptions& options) {
  const auto network = NetworkA(options.seed);
  const PoseNetwork plain =
      Asked(NetworkKind::kPaperA, std::make_shared<PlainNetwork>(network), Precision::kFloat32);
  cv::RNG random(options.seed);
  std::vector<double> worst(4, 0);
  const PoseNetwork full = Asked(NetworkKind::kPaperA, network, Precision::kFloat32),
                    half = Asked(NetworkKind::kPaperA, network, Precision::kBfloat16);
  for (int i = 0; i < options.checks; ++i) {
    const cv::Mat live = MadeUpImage(plain.crop(), random), key = MadeUpImage(plain.crop(), random);
    const SE3 expected = plain.KeyframeFromLive(live, key);
    std::size_t at = 0;
    for (const PoseNetwork* ours : {&full, &half}) {
      const SE3 between = expected.Inverse() * ours->KeyframeFromLive(live, key);
      worst[at] = std::max(worst[at], between.translation().norm());
      worst[at + 1] = std::max(worst[at + 1], between.RotationVector().norm());
      at += 2;
    }
  }
  return worst;
}

}  // namespace

nlohmann::json RunCnnBench(const CnnBenchOptions& options, const ProgressSink& progress) {
  std::int64_t done = 0;
  constexpr std::int64_t kLegs = 12;
  const auto leg = [&](const std::string& name, bool as_installed, const auto& body) {
    Report(progress, "bench cnn", done++, kLegs, name);
    return RunInChild(name, [&] {
      as_installed ? SetThreadsAsInstalled(options.threads) : cnn::SetThreads(options.threads);
      return body();
    });
  };
  std::map<std::string, std::vector<double>> infer, train;
  const auto ask = [&](const std::string& name, bool as_installed, NetworkKind kind,
                       Precision precision) {
    infer[name] = leg("infer " + name, as_installed, [&] {
      std::shared_ptr<cnn::PairNetwork> network;
      if (kind == NetworkKind::kPaperA) network = NetworkA(options.seed);
      if (as_installed) network = std::make_shared<PlainNetwork>(NetworkA(options.seed));
      return TimeQuestions(Asked(kind, network, precision), options);
    });
  };
  ask("libtorch", true, NetworkKind::kPaperA, Precision::kFloat32);
  ask("ours_fp32", false, NetworkKind::kPaperA, Precision::kFloat32);
  ask("ours_bf16", false, NetworkKind::kPaperA, Precision::kBfloat16);
  ask("compact", false, NetworkKind::kCompact, Precision::kFloat32);
  ask("compact_bf16", false, NetworkKind::kCompact, Precision::kBfloat16);
  const auto together = leg("infer together", false, [&] {
    return TimeQuestionsTogether(
        Asked(NetworkKind::kPaperA, NetworkA(options.seed), Precision::kFloat32), options);
  });
  train["libtorch"] = leg("train libtorch", true, [&] { return TimeSteps(false, options); });
  train["ours"] = leg("train ours", false, [&] { return TimeSteps(true, options); });
  train["ours_bf16"] =
      leg("train ours_bf16", false, [&] { return TimeSteps(true, options, Precision::kBfloat16); });
  const auto peak = leg("peak", false, [&] { return Peak(Precision::kFloat32); });
  const auto peak_half = leg("peak bf16", false, [&] { return Peak(Precision::kBfloat16); });
  const auto answers = leg("answers", false, [&] { return Compare(options); });

  nlohmann::json figures;
  for (const auto& [name, times] : train) {
    figures["train_step_s"][name] = times[0];
    figures["train_step_cpu_s"][name] = times[1];
  }
  for (const auto& [name, times] : infer) {
    figures["infer_ms"][name] = 1e3 * times[0];
    figures["infer_cpu_ms"][name] = 1e3 * times[1];
  }
  figures["infer_batch_ms"] = 1e3 * together[0];
  figures["infer_batch_cpu_ms"] = 1e3 * together[1];
  const auto ratio = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::pair{a[0] / b[0], a[1] / b[1]};
  };
  std::tie(figures["train_ratio"], figures["train_cpu_ratio"]) =
      ratio(train["ours"], train["libtorch"]);
  std::tie(figures["infer_ratio"], figures["infer_cpu_ratio"]) =
      ratio(infer["ours_fp32"], infer["libtorch"]);
  figures["peak_gflops"] = peak[0] / 1e9;
  figures["peak_bf16_gflops"] = peak_half[0] / 1e9;
  const Arithmetic flops = OfNetworkA();
  figures["share_of_peak"] = {{"train", flops.step * options.batch / train["ours"][0] / peak[0]},
                              {"infer", flops.forward / infer["ours_fp32"][0] / peak[0]}};
  figures["answers"] = {{"pairs", options.checks},
                        {"fp32", {{"position_m", answers[0]}, {"rotation_rad", answers[1]}}},
                        {"bf16", {{"position_m", answers[2]}, {"rotation_rad", answers[3]}}}};
  figures["threads"] = options.threads;
  figures["batch"] = options.batch;
  figures["libtorch"] = "as installed: its own layers and Adam, malloc as it comes";
  return figures;
}

std::string DescribeCnnBench(const nlohmann::json& f) {
  const auto at = [&](const char* pointer) {
    return f.at(nlohmann::json::json_pointer(pointer)).get<double>();
  };
  std::string text = fmt::format(
      "                        wall    processor\n"
      "training step, {} pairs\n"
      "  ours             {:8.2f} s  {:8.2f} s\n"
      "  ours_bf16        {:8.2f} s  {:8.2f} s\n"
      "  libtorch         {:8.2f} s  {:8.2f} s   ratio {:.2f}, {:.2f}\n"
      "one pair\n",
      f["batch"].get<int>(), at("/train_step_s/ours"), at("/train_step_cpu_s/ours"),
      at("/train_step_s/ours_bf16"), at("/train_step_cpu_s/ours_bf16"),
      at("/train_step_s/libtorch"), at("/train_step_cpu_s/libtorch"), at("/train_ratio"),
      at("/train_cpu_ratio"));
  for (const char* name : {"ours_fp32", "ours_bf16", "compact", "compact_bf16", "libtorch"}) {
    text += fmt::format("  {:<15}{:9.1f} ms {:9.1f} ms\n", name, f["infer_ms"][name].get<double>(),
                        f["infer_cpu_ms"][name].get<double>());
  }
  text += fmt::format(
      "  eight at once  {:9.1f} ms {:9.1f} ms a pair\n"
      "  ours_fp32 / libtorch: {:.2f}, {:.2f}\n"
      "a plain convolution: {:.0f} GFLOP/s ({:.0f} in bf16); of that, training {:.0f} %, one pair "
      "{:.0f} %\n"
      "answers of {} pairs differ from libtorch's by at most {:.1e} m, {:.1e} rad (bf16: {:.1e} m, "
      "{:.1e} rad)\n",
      at("/infer_batch_ms"), at("/infer_batch_cpu_ms"), at("/infer_ratio"), at("/infer_cpu_ratio"),
      at("/peak_gflops"), at("/peak_bf16_gflops"), 100 * at("/share_of_peak/train"),
      100 * at("/share_of_peak/infer"), f["answers"]["pairs"].get<int>(),
      at("/answers/fp32/position_m"), at("/answers/fp32/rotation_rad"),
      at("/answers/bf16/position_m"), at("/answers/bf16/rotation_rad"));
  return text;
}

}  // namespace recollect
