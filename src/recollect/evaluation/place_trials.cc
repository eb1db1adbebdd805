#include "recollect/evaluation/place_trials.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_folder.h"
#include "recollect/dataset/sampling.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/sabgl.h"

namespace recollect {
namespace {

// Two-sided 95 % points of Student's t for 1, 2, ... degrees of freedom.
constexpr double kStudent[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262};

wnn::ImageView View(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, image.channels(),
          static_cast<std::ptrdiff_t>(image.step)};
}

int NearestFrame(const std::vector<KeyFrame>& frames, const SE3& pose) {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const SE3& own = frames[i].world_from_camera;
    const double distance = (own.translation() - pose.translation()).norm();
    if (distance >= least || own.rotation().col(2).dot(pose.rotation().col(2)) <= 0) continue;
    least = distance;
    best = static_cast<int>(i);
  }
  return best;
}

void CheckSize(const cv::Mat& first, const cv::Mat& image, const std::string& where) {
  Require(image.size() == first.size(), where,
          fmt::format("{} x {} pixels where the first image has {} x {}", image.cols, image.rows,
                      first.cols, first.rows));
}

}  // namespace

PlaceImages ReadPlaces(const std::vector<Lap>& laps, double spacing_m) {
  Require(!laps.empty(), "laps", "none given");
  PlaceImages places;
  places.spacing_m = spacing_m;
  for (std::size_t lap = 0; lap < laps.size(); ++lap) {
    for (const std::size_t i : SampleFrames(laps[lap], spacing_m)) {
      const auto& file = laps[lap].frames[i].left;
      Require(!file.empty(), laps[lap].folder.string(), "has no images");
      places.images.push_back(ReadColour(file));
      CheckSize(places.images.front(), places.images.back(), file.string());
      places.frames.push_back({laps[lap].WorldFromCamera(i), laps[lap].frames[i].time,
                               static_cast<std::uint32_t>(lap), static_cast<std::uint32_t>(i)});
    }
  }
  places.route = RouteOf(places.frames, spacing_m);
  return places;
}

PlaceImages ReadPlaces(const std::filesystem::path& folder) {
  PlaceImages places;
  for (const auto& file : ImagesIn(folder)) {
    places.images.push_back(ReadColour(file));
    CheckSize(places.images.front(), places.images.back(), file.string());
    places.frames.push_back({SE3(), 0, 0, static_cast<std::uint32_t>(places.frames.size())});
  }
  places.route = wnn::ChainRoute(static_cast<int>(places.images.size()));
  return places;
}

LearntPlaces::LearntPlaces(const PlaceImages& p, const wnn::NetworkOptions& network,
                           ThreadPool& pool)
    : places(p),
      encoder(network, p.images.front().cols, p.images.front().rows, pool),
      memory(network.neurons()) {
  for (const cv::Mat& image : places.images) memory.Append(encoder.Encode(View(image)));
}

std::vector<wnn::Trial> LearntPlaces::Trials(ThreadPool& pool, const TrialOptions& options,
                                             const ProgressSink& progress) {
  std::vector<int> laps;
  for (const KeyFrame& frame : places.frames) laps.push_back(static_cast<int>(frame.lap));
  const Mapped mapped{memory, places.route, laps,
                      [&](int entry) { return places.images[static_cast<std::size_t>(entry)]; }};
  return MakeTrials(mapped, encoder, pool, options, progress);
}

std::vector<PlaceAnswer> AnswerLive(LearntPlaces& learnt, const Lap& live, double live_spacing_m,
                                    const wnn::SequenceOptions& sequence,
                                    const wnn::Calibration& calibration, ThreadPool& pool,
                                    const ProgressSink& progress) {
  const PlaceImages& places = learnt.places;
  const auto belief = wnn::MakeSequence(sequence, places.route);
  std::vector<PlaceAnswer> answers;
  const std::vector<std::size_t> sampled = SampleFrames(live, live_spacing_m);
  for (const std::size_t i : sampled) {
    const cv::Mat image = ReadColour(live.frames[i].left);
    CheckSize(places.images.front(), image, live.frames[i].left.string());
    const SE3 truth = live.WorldFromCamera(i);
    const auto error = [&](int place) {
      return place < 0
                 ? std::numeric_limits<double>::infinity()
                 : (places.frames[static_cast<std::size_t>(place)].world_from_camera.translation() -
                    truth.translation())
                       .norm();
    };
    const wnn::Recollection one =
        wnn::RecollectImage(learnt.memory, learnt.encoder, View(image), pool);
    std::vector<float> distances;
    if (sequence.filter == wnn::Filter::kSabgl) {
      distances = wnn::DisplacedDistances(learnt.memory, learnt.encoder, View(image), pool);
    }
    const wnn::PlaceBelief filtered = wnn::MostLikely(
        places.route, belief->Update({one.histogram, one.neurons_read, distances, {}}),
        one.histogram);
    const wnn::Judged judged =
        wnn::Judge(calibration, places.route, one.histogram, one.neurons_read);
    const int nearest = NearestFrame(places.frames, truth);
    answers.push_back({error(one.winner),
                       error(judged.place),
                       error(filtered.place),
                       {judged.probability, places.route.WithinOne(nearest, judged.place)},
                       {filtered.probability, places.route.WithinOne(nearest, filtered.place)}});
    Report(progress, "recollect", static_cast<std::int64_t>(answers.size()),
           static_cast<std::int64_t>(sampled.size()));
  }
  return answers;
}

std::vector<Variant> AblationVariants() {
  const wnn::NetworkOptions vibgl, best = wnn::RecollectNetwork();
  std::vector<Variant> variants;
  const auto add = [&](const std::string& name, wnn::NetworkOptions network, auto change) {
    change(network);
    variants.push_back({name, network});
  };
  using Options = wnn::NetworkOptions;
  const auto none = [](Options&) {};
  const auto displaced = [&best](Options& o) {
    o.shift_x = best.shift_x;
    o.shift_y = best.shift_y;
    o.shift_step = best.shift_step;
  };
  add("vibgl", vibgl, none);
  add("vibgl, gray", vibgl, [](Options& o) { o.code = wnn::Code::kGray; });
  add("vibgl, opponent colours", vibgl, [](Options& o) { o.code = wnn::Code::kOpponent; });
  add("vibgl, working width 160", vibgl, [](Options& o) { o.working_width = 160; });
  add("vibgl, contrast 60", vibgl, [](Options& o) {
    o.code = wnn::Code::kGray;
    o.contrast_sigma = 60;
  });
  add("vibgl, all synapses near, sharp", vibgl, [](Options& o) {
    o.gaussian_synapses = wnn::kSynapses;
    o.blur = false;
  });
  add("vibgl, 3 blur scales", vibgl, [](Options& o) {
    o.code = wnn::Code::kGray;
    o.blur_sigma = 4;
    o.blur_scales = 3;
  });
  add("vibgl, gradient cells", vibgl, [](Options& o) { o.cells = wnn::Cells::kGradient; });
  add("vibgl, rank cells", vibgl, [](Options& o) { o.cells = wnn::Cells::kRank; });
  add("vibgl, 32 x 18 neurons", vibgl, [](Options& o) {
    o.neurons_x = 32;
    o.neurons_y = 18;
  });
  add("vibgl, 32 x 18 neurons, displacements", vibgl, [&](Options& o) {
    o.neurons_x = 32;
    o.neurons_y = 18;
    o.working_width = 160;
    displaced(o);
  });
  add("recollect", best, none);
  add("recollect, no closer look", best, [](Options& o) { o.closer_step = 0; });
  add("recollect, no parts", best, [](Options& o) { o.parts_x = o.parts_y = 0; });
  add("recollect, growth not looked at", best, [](Options& o) { o.growth = false; });
  add("recollect, 4 x 3 parts", best, [](Options& o) {
    o.parts_x = 4;
    o.parts_y = 3;
  });
  add("recollect, no displacements", best, [](Options& o) { o.shift_x = o.shift_y = 0; });
  add("recollect, sideways only", best, [](Options& o) { o.shift_y = 0; });
  add("recollect, compare cells", best, [](Options& o) { o.cells = wnn::Cells::kCompare; });
  add("recollect, compare cells, contrast 60", best, [](Options& o) {
    o.cells = wnn::Cells::kCompare;
    o.contrast_sigma = 60;
  });
  add("recollect, rank cells", best, [](Options& o) { o.cells = wnn::Cells::kRank; });
  add("recollect, gray", best, [](Options& o) { o.code = wnn::Code::kGray; });
  add("recollect, contrast 60", best, [](Options& o) { o.contrast_sigma = 60; });
  add("recollect, half the synapses anywhere", best, [](Options& o) { o.gaussian_synapses = 64; });
  add("recollect, sigma 60", best, [](Options& o) { o.gaussian_sigma = 60; });
  add("recollect, 48 x 27 neurons", best, [](Options& o) {
    o.neurons_x = 48;
    o.neurons_y = 27;
  });
  return variants;
}

Estimate MeanOf(const std::vector<double>& values) {
  Estimate estimate;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) estimate.mean += value / n;
  if (values.size() < 2) return estimate;
  double squares = 0;
  for (const double value : values) squares += std::pow(value - estimate.mean, 2);
  const std::size_t freedom = std::min(values.size() - 1, std::size(kStudent));
  estimate.half_width = kStudent[freedom - 1] * std::sqrt(squares / (n - 1) / n);
  return estimate;
}

double TrialScore(const PlaceImages& places, const wnn::NetworkOptions& network, int stride,
                  ThreadPool& pool) {
  LearntPlaces learnt(places, network, pool);
  const auto trials = learnt.Trials(
      pool, {.stride = stride, .nowhere = false, .leave_out = true, .seed = network.seed});
  Require(!trials.empty(), "trials", "no place is seen by two laps");
  int right = 0;
  for (const wnn::Trial& trial : trials) {
    const int place = wnn::Supported(places.route, trial.histogram);
    right += std::find(trial.right.begin(), trial.right.end(), place) != trial.right.end();
  }
  return static_cast<double>(right) / static_cast<double>(trials.size());
}

}  // namespace recollect
