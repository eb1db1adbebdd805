#include "recollect/cnn/compact_engine.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "recollect/cnn/layer_list.h"
#include "recollect/cnn/layers.h"
#include "recollect/cnn/processors.h"
#include "recollect/cnn/softmax_rows.h"

namespace recollect::cnn {
namespace {

using dnnl::memory;

constexpr std::int64_t kReach = 2, kSide = 2 * kReach + 1;  // of the window around a peak
constexpr std::int64_t kBlock = 60;       // live cells whose scores are in the cache together
constexpr std::int64_t kPlainInputs = 8;  // of the motion layers, before the context

// [N, rows, columns, channels] of floats.
memory AsMemory(const torch::Tensor& values) {
  return {{{values.size(0), values.size(3), values.size(1), values.size(2)},
           memory::data_type::f32,
           memory::format_tag::nhwc},
          OnednnEngine(),
          values.data_ptr()};
}

// values [cells][channels] less their mean over the cells, by their standard deviation, times
// weight plus bias, and rectified (torch's GroupNorm with a group a channel). sums, scales: room
// for a number a channel.
RECOLLECT_FOR_EACH_PROCESSOR
void NormaliseAndRectify(float* values, std::int64_t cells, std::int64_t channels,
                         const float* weight, const float* bias, float* shifts, float* scales) {
  constexpr float kEpsilon = 1e-5F;
  const float share = 1 / static_cast<float>(cells);
  std::fill_n(shifts, channels, 0.F);
  std::fill_n(scales, channels, 0.F);
  for (std::int64_t i = 0; i < cells; ++i) {
    for (std::int64_t c = 0; c < channels; ++c) shifts[c] += values[i * channels + c];
  }
  for (std::int64_t c = 0; c < channels; ++c) shifts[c] *= share;
  for (std::int64_t i = 0; i < cells; ++i) {
    for (std::int64_t c = 0; c < channels; ++c) {
      const float off = values[i * channels + c] - shifts[c];
      scales[c] += off * off;
    }
  }
  for (std::int64_t c = 0; c < channels; ++c) {
    scales[c] = weight[c] / std::sqrt(scales[c] * share + kEpsilon);
    shifts[c] = bias[c] - shifts[c] * scales[c];
  }
  for (std::int64_t i = 0; i < cells; ++i) {
    for (std::int64_t c = 0; c < channels; ++c) {
      const float value = values[i * channels + c] * scales[c] + shifts[c];
      values[i * channels + c] = value > 0 ? value : 0;
    }
  }
}

// Each cell's features times `length` over their own.
torch::Tensor OfLength(const torch::Tensor& features, float length) {
  const torch::Tensor norms = features.norm(2, -1, true).clamp_min(1e-12);
  return features * (length / norms);
}

// Of one live cell, as ReadPeaks has it.
CompactEngine::Peak PeakOf(const float* scores, const Grid& grid, std::int64_t cell) {
  std::int64_t best = 0;
  const float greatest = Greatest(scores, grid.cells(), &best);
  const float total = LogSumExp(scores, grid.cells(), greatest);
  const std::int64_t column = std::clamp(best % grid.columns, kReach, grid.columns - 1 - kReach);
  const std::int64_t row = std::clamp(best / grid.columns, kReach, grid.rows - 1 - kReach);
  float sum = 0, columns = 0, rows = 0;
  for (std::int64_t y = -kReach; y <= kReach; ++y) {
    const float* at = scores + (row + y) * grid.columns + column;
    for (std::int64_t x = -kReach; x <= kReach; ++x) {
      const float weight = std::exp(at[x] - greatest);
      sum += weight;
      columns += weight * static_cast<float>(x);
      rows += weight * static_cast<float>(y);
    }
  }
  return {columns / sum + static_cast<float>(column - cell % grid.columns),
          rows / sum + static_cast<float>(row - cell / grid.columns),
          sum * std::exp(greatest - total)};
}

// live, key: features [cells, channels] whose products are the scores.
std::vector<CompactEngine::Peak> FindPeaks(const torch::Tensor& live, const torch::Tensor& key,
                                           const Grid& grid) {
  const std::int64_t cells = grid.cells(), channels = live.size(1);
  std::vector<CompactEngine::Peak> peaks(static_cast<std::size_t>(cells));
  const float *own = live.data_ptr<float>(), *theirs = key.data_ptr<float>();
  at::parallel_for(0, (cells + kBlock - 1) / kBlock, 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> scores(static_cast<std::size_t>(kBlock * cells));
    for (std::int64_t block = begin; block < end; ++block) {
      const std::int64_t first = block * kBlock, count = std::min(kBlock, cells - first);
      dnnl::sgemm('N', 'T', count, cells, channels, 1.F, own + first * channels, channels, theirs,
                  channels, 0.F, scores.data(), cells);
      for (std::int64_t i = 0; i < count; ++i) {
        peaks[static_cast<std::size_t>(first + i)] =
            PeakOf(scores.data() + i * cells, grid, first + i);
      }
    }
  });
  return peaks;
}

}  // namespace

CompactEngine::CompactEngine(const CompactParts& parts, const Grid& grid, Precision precision)
    : grid_(grid),
      precision_(precision),
      parts_(parts),
      rays_(RayGrid(parts.cells).flatten(1).contiguous()) {
  const auto weights = parts.branch->named_parameters();
  const auto packed = [&](const std::string& name, std::int64_t stride) {
    const torch::Tensor& weight = weights[name + ".weight"];
    return PackedConvolution(weight, weights[name + ".bias"], 1, stride, weight.size(2) / 2,
                             precision, PackedConvolution::Result::kChannelsLast);
  };
  const auto normalised = [&](const std::string& convolution, const std::string& norm,
                              std::int64_t stride) {
    return Normalised{packed(convolution, stride), weights[norm + ".weight"].detach().clone(),
                      weights[norm + ".bias"].detach().clone()};
  };
  branch_.push_back(normalised("0", "1", 4));
  branch_.push_back(normalised("3", "4", 2));
  for (const std::string name : {"6.inner.", "7.inner."}) {
    residuals_.push_back({normalised(name + "0", name + "1", 1), packed(name + "3", 1)});
  }
  const auto append = [&](std::vector<PackedConvolution>& to, const ListedLayer& layer) {
    to.emplace_back(layer.weight, layer.bias, layer.slope, layer.stride, layer.padding, precision,
                    PackedConvolution::Result::kChannelsLast);
  };
  for (const ListedLayer& layer : LayersOf(parts.depth)) append(depth_, layer);
  for (const ListedLayer& layer : LayersOf(parts.motion)) append(motion_, layer);
  append(context_, {parts.context->weight, parts.context->bias});
}

torch::Tensor CompactEngine::Convolve(PackedConvolution& layer, const torch::Tensor& source) const {
  memory from = AsMemory(source);
  if (precision_ == Precision::kBfloat16) {
    memory half({from.get_desc().dims(), memory::data_type::bf16, memory::format_tag::nhwc},
                OnednnEngine());
    Copy(from, half);
    from = half;
  }
  const memory& result = layer.Run(from);
  OnednnStream().wait();
  const memory::dims d = result.get_desc().dims();
  return torch::from_blob(result.get_data_handle(), {d[0], d[2], d[3], d[1]});
}

torch::Tensor CompactEngine::Convolve(Normalised& layer, const torch::Tensor& source) const {
  torch::Tensor result = Convolve(layer.convolution, source);
  const std::int64_t cells = result.size(1) * result.size(2), channels = result.size(3);
  at::parallel_for(0, result.size(0), 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<float> shifts(static_cast<std::size_t>(channels)), scales = shifts;
    for (std::int64_t i = begin; i < end; ++i) {
      NormaliseAndRectify(result.data_ptr<float>() + i * cells * channels, cells, channels,
                          layer.weight.data_ptr<float>(), layer.bias.data_ptr<float>(),
                          shifts.data(), scales.data());
    }
  });
  return result;
}

torch::Tensor CompactEngine::Features(const torch::Tensor& images) {
  torch::Tensor now = images.permute({0, 2, 3, 1}).contiguous();
  for (Normalised& layer : branch_) now = Convolve(layer, now);
  for (Residual& layer : residuals_) {
    now = now + Convolve(layer.second, Convolve(layer.first, now));
  }
  return now;
}

// Fills pair number `at` of the sightings and `inputs` [rows, columns, channels] of the motion
// layers from where the live cells are seen and how they look, [rows, columns, 2] and context.
void CompactEngine::Sight(const std::vector<Peak>& peaks, const torch::Tensor& looks,
                          const torch::Tensor& context, Sightings& sightings, std::int64_t at,
                          const torch::Tensor& inputs) const {
  const std::int64_t cells = grid_.cells(), contexts = context.size(2);
  const float *look = looks.data_ptr<float>(), *its_context = context.data_ptr<float>();
  const float* rays = rays_.data_ptr<float>();
  float* points = sightings.points.data_ptr<float>() + at * 3 * cells;
  float* seen = sightings.seen.data_ptr<float>() + at * 2 * cells;
  float* weight = sightings.weight.data_ptr<float>() + at * cells;
  float* input = inputs.data_ptr<float>();
  const auto fx = static_cast<float>(parts_.cells.fx), fy = static_cast<float>(parts_.cells.fy);
  const float to_x = 2 / static_cast<float>(grid_.columns - 1);
  const float to_y = 2 / static_cast<float>(grid_.rows - 1);
  for (std::int64_t i = 0; i < cells; ++i, look += 2, its_context += contexts) {
    const Peak& peak = peaks[static_cast<std::size_t>(i)];
    const float log_depth = std::clamp(look[0] + kLogFirstDepth, 0.F, kMostLogDepth);
    const float depth = std::exp(log_depth), trust = 1 / (1 + std::exp(-look[1]));
    for (std::int64_t axis = 0; axis < 3; ++axis) {
      points[axis * cells + i] = depth * rays[axis * cells + i];
    }
    seen[i] = rays[i] + peak.column / fx;
    seen[cells + i] = rays[cells + i] + peak.row / fy;
    weight[i] = peak.share * trust;
    const float values[kPlainInputs] = {peak.column / 4 * peak.share,
                                        peak.row / 4 * peak.share,
                                        peak.share,
                                        trust,
                                        10 / depth,
                                        log_depth / 4,
                                        static_cast<float>(i % grid_.columns) * to_x - 1,
                                        static_cast<float>(i / grid_.columns) * to_y - 1};
    input = std::copy_n(values, kPlainInputs, input);
    input = std::copy_n(its_context, contexts, input);
  }
}

PairAnswers CompactEngine::Answer(const torch::Tensor& images, std::span<const ImagePair> pairs) {
  const std::lock_guard lock(mutex_);
  const torch::Tensor features = Features(images);
  const torch::Tensor unit = OfLength(features.flatten(1, 2), 1);

  // Of each live image once, however many key frames it meets.
  std::map<std::int64_t, std::int64_t> lives;
  for (const ImagePair& pair : pairs) lives.try_emplace(pair.live, 0);
  std::vector<std::int64_t> numbers;
  for (auto& [image, at] : lives) {
    at = static_cast<std::int64_t>(numbers.size());
    numbers.push_back(image);
  }
  const torch::Tensor live = features.index_select(0, torch::tensor(numbers));
  const torch::Tensor context = Convolve(context_.front(), live);
  const torch::Tensor coarse = Convolve(depth_[1], Convolve(depth_[0], live));
  const torch::Tensor looks =
      Convolve(depth_[2], coarse.repeat_interleave(2, 1).repeat_interleave(2, 2)).contiguous();

  const auto batch = static_cast<std::int64_t>(pairs.size());
  Sightings sightings{torch::empty({batch, 3, grid_.cells()}),
                      torch::empty({batch, 2, grid_.cells()}),
                      torch::empty({batch, grid_.cells()})};
  torch::Tensor now = torch::empty(
      {batch, grid_.rows, grid_.columns, kPlainInputs + context.size(3)});  // of the motion layers
  for (std::int64_t i = 0; i < batch; ++i) {
    const ImagePair& pair = pairs[static_cast<std::size_t>(i)];
    const std::int64_t number = lives.at(pair.live);
    Sight(FindPeaks(unit[pair.live] * parts_.sharpness, unit[pair.key], grid_), looks[number],
          context[number], sightings, i, now[i]);
  }
  const torch::Tensor solved = SolveMotion(sightings);
  for (PackedConvolution& layer : motion_) now = Convolve(layer, now);
  const torch::Tensor pooled = parts_.motion->ptr(parts_.motion->size() - 1)
                                   ->as<torch::nn::AdaptiveAvgPool2d>()
                                   ->forward(now.permute({0, 3, 1, 2}).contiguous())
                                   .flatten(1);
  PairAnswers answers;
  answers.motion = Corrected(solved, parts_.output->forward(pooled));
  if (parts_.covariance) {
    answers.agreement = MotionFit(solved, sightings);
    answers.whitening = parts_.covariance->forward(pooled, solved, sightings, answers.agreement);
  }
  return answers;
}

}  // namespace recollect::cnn
