#include "recollect/wnn/encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/blur.h"
#include "recollect/wnn/invariant.h"
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
namespace {

constexpr int kStrip = 16;   // rows that a thread takes at a time
constexpr int kGrain = 256;  // neurons

// The blurring kernel of a window `width` pixels wide.
double BlurScale(int width) { return width / 640.0; }
int BlurSize(const NetworkOptions& options, int width) {
  return 2 * static_cast<int>(std::lround((options.blur_size - 1) / 2.0 * BlurScale(width))) + 1;
}

// One number a pixel, by the network's code.
void CodeRow(const std::uint8_t* pixels, int width, bool colour, std::int32_t* values) {
  if (!colour) {
    for (int x = 0; x < width; ++x) values[x] = pixels[x];
    return;
  }
  for (int x = 0; x < width; ++x) {
    values[x] = pixels[3 * x + 2] | pixels[3 * x + 1] << 8 | pixels[3 * x] << 16;
  }
}

}  // namespace

struct Encoder::State {
  NetworkOptions options;
  Synapses synapses;
  int image_height;
  ThreadPool& pool;
  std::vector<std::int32_t> offsets;  // neurons x kSynapses, into values
  std::vector<std::int32_t> values;   // the sharp window, then the blurred one
  cv::Mat kept, window, blurred;
  std::optional<Blur> blur;
  std::optional<InvariantEncoder> invariant;  // takes the place of all that, where wanted
  std::vector<int> parts;

  State(const NetworkOptions& o, int width, int height, ThreadPool& p)
      : options(o), synapses(o, width, height), image_height(height), pool(p) {
    for (int n = 0; n < (options.parts_x > 0 ? synapses.neurons() : 0); ++n) {
      const Pixel cell = synapses.Cell(n);
      parts.push_back(cell.y * options.parts_y / options.neurons_y * options.parts_x +
                      cell.x * options.parts_x / options.neurons_x);
    }
    if (InvariantEncoder::Wanted(options)) {
      invariant.emplace(options, width, height, pool);
      return;
    }
    const int uniform = kSynapses - options.gaussian_synapses;
    const int area = synapses.window_width() * synapses.window_height();
    values.resize(static_cast<std::size_t>(options.blur ? 2 * area : area));
    if (options.blur) {
      const int w = synapses.window_width(), h = synapses.window_height();
      blur.emplace(w, h, BlurSize(options, w), options.blur_sigma * BlurScale(w),
                   (h + kStrip - 1) / kStrip);
    }
    for (int n = 0; n < synapses.neurons(); ++n) {
      for (int i = 0; i < kSynapses; ++i) {
        const Pixel pixel = synapses.Of(n)[i];
        const int base = options.blur && i >= uniform ? area : 0;
        offsets.push_back(base + pixel.y * synapses.window_width() + pixel.x);
      }
    }
  }

  // Messages are written in case of need only: writing them allocates.
  void Check(const ImageView& image) const {
    const int width = synapses.window_width();
    if (!image.data || image.width != width || image.height != image_height) {
      throw Error("image",
                  fmt::format("{} x {} pixels where the network looks at {} x {}", image.width,
                              image.height, width, image_height),
                  "scale it, or make an encoder for its size");
    }
    if ((image.channels != 1 && image.channels != 3) ||
        image.stride < std::ptrdiff_t{image.width} * image.channels) {
      throw Error("image",
                  fmt::format("{} channels with a stride of {}", image.channels, image.stride),
                  "give 1 or 3 channels of 8 bits");
    }
  }

  static cv::Mat Whole(const ImageView& image) {
    return {image.height, image.width, image.channels == 3 ? CV_8UC3 : CV_8UC1,
            const_cast<std::uint8_t*>(image.data), static_cast<std::size_t>(image.stride)};
  }

  // Fills `window` with the part of the image that is looked at, in the channels of the code.
  void Look(const ImageView& image, Pixel shift) {
    const cv::Mat whole = Whole(image);
    const int width = synapses.window_width(), height = synapses.window_height();
    cv::Mat seen = whole.rowRange(0, height);
    if (shift.x != 0 || shift.y != 0) {
      cv::Mat bordered;
      const int dx = std::abs(shift.x), dy = std::abs(shift.y);
      cv::copyMakeBorder(whole, bordered, dy, dy, dx, dx, cv::BORDER_REPLICATE);
      seen = bordered(cv::Rect(dx + shift.x, dy + shift.y, width, height)).clone();
    }
    if (image.channels == 3 && options.code == Code::kGray) {
      cv::cvtColor(seen, window, cv::COLOR_BGR2GRAY);
    } else {
      // A header of its own: the blur shall not look past the window into the image.
      kept = seen;
      window = cv::Mat(height, width, kept.type(), kept.data, kept.step);
    }
  }

  // Codes the window, and its blurred copy behind it. Bodies of loops carry one or two pointers
  // only: larger ones would make the pool allocate.
  void CodeWindow() {
    if (options.blur) blurred.create(window.size(), window.type());
    pool.For(window.rows, kStrip, [this](std::int64_t begin, std::int64_t end) {
      CodeStrip({static_cast<int>(begin), static_cast<int>(end)});
    });
  }

  void CodeStrip(cv::Range strip) {
    CodeRows(window, strip, values.data());
    if (!options.blur) return;
    for (int y = strip.start; y < strip.end; ++y) {
      blur->Row(*Kernels().front(), window, y, strip.start / kStrip, blurred.ptr(y));
    }
    CodeRows(blurred, strip, values.data() + values.size() / 2);
  }

  void CodeRows(const cv::Mat& from, cv::Range rows, std::int32_t* to) const {
    for (int y = rows.start; y < rows.end; ++y) {
      CodeRow(from.ptr(y), from.cols, from.channels() == 3, to + std::ptrdiff_t{y} * from.cols);
    }
  }
};

Encoder::Encoder(const NetworkOptions& options, int image_width, int image_height, ThreadPool& pool)
    : state_(std::make_unique<State>(options, image_width, image_height, pool)) {}
Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

const Synapses& Encoder::synapses() const { return state_->synapses; }

Displacements Encoder::displacements() const { return DisplacementsOf(state_->options); }
Displacements Encoder::closer_displacements() const {
  return CloserDisplacementsOf(state_->options);
}

const std::vector<int>& Encoder::parts() const { return state_->parts; }
bool Encoder::tells_growth() const { return state_->options.growth && !state_->parts.empty(); }

std::size_t Encoder::pattern_words() const {
  return static_cast<std::size_t>(state_->synapses.neurons()) * kWords;
}

void Encoder::Encode(const ImageView& image, std::span<std::uint64_t> pattern, Pixel shift) {
  State& state = *state_;
  state.Check(image);
  if (pattern.size() != pattern_words()) {
    throw Error("pattern", fmt::format("room for {} words where {} are written", pattern.size(),
                                       pattern_words()));
  }
  if (state.invariant) {
    state.invariant->Look(State::Whole(image), shift);
    return state.invariant->Encode(shift, pattern);
  }
  state.Look(image, shift);
  state.CodeWindow();
  state.pool.For(state.synapses.neurons(), kGrain,
                 [&state, words = pattern.data()](std::int64_t begin, std::int64_t end) {
                   Kernels().front()->cells(state.values.data(), state.offsets.data(),
                                            static_cast<int>(begin), static_cast<int>(end), words);
                 });
}

std::vector<std::uint64_t> Encoder::Encode(const ImageView& image, Pixel shift) {
  std::vector<std::uint64_t> pattern(pattern_words());
  Encode(image, pattern, shift);
  return pattern;
}

DisplacedImage Encoder::LookDisplaced(const ImageView& image, const Displacements& grid) {
  State& state = *state_;
  state.Check(image);
  const double unit = grid.step * image.width / 640.0;
  const auto pixels = [&](int steps) { return static_cast<int>(std::lround(steps * unit)); };
  std::vector<Pixel> shifts;
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      shifts.push_back({pixels(x - grid.columns / 2), pixels(y - grid.rows / 2)});
    }
  }
  std::optional<InvariantEncoder>& invariant = state.invariant;
  if (invariant) {
    invariant->Look(State::Whole(image), {pixels(grid.columns / 2), pixels(grid.rows / 2)});
    if (invariant->reads_bits()) return {*invariant, grid, invariant->RunsUnder(shifts)};
  }
  DisplacedPatterns displaced{grid, std::vector<std::uint64_t>(pattern_words() * shifts.size())};
  std::vector<std::uint64_t> pattern(pattern_words());
  for (std::size_t d = 0; d < shifts.size(); ++d) {
    if (invariant) {
      invariant->Encode(shifts[d], pattern);
    } else {
      Encode(image, pattern, shifts[d]);
    }
    for (std::size_t i = 0; i < pattern.size(); ++i) {
      displaced.words[i * shifts.size() + d] = pattern[i];
    }
  }
  return DisplacedImage(std::move(displaced));
}

DisplacedPatterns Encoder::EncodeDisplaced(const ImageView& image, const Displacements& grid) {
  return LookDisplaced(image, grid).Every(1);
}

}  // namespace recollect::wnn
