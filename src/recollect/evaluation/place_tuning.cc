#include "recollect/evaluation/place_tuning.h"

#include <optional>

#include "recollect/core/error.h"

namespace recollect {
namespace {

using wnn::NetworkOptions;

TuneAnswer Displaced(const std::string& flags, int x, int y, int step, int closer) {
  return {flags, [=](NetworkOptions& o) {
            o.shift_x = x;
            o.shift_y = y;
            o.shift_step = step;
            o.closer_step = closer;
          }};
}

TuneAnswer Parts(const std::string& flags, int x, int y) {
  return {flags, [=](NetworkOptions& o) {
            o.parts_x = x;
            o.parts_y = y;
          }};
}

}  // namespace

std::vector<TuneQuestion> TuneQuestions() {
  return {
      {"displacements",
       {Displaced("--shift-x 0 --shift-y 0 --closer-step 0", 0, 0, 16, 0),
        Displaced("--closer-step 0", 64, 32, 16, 0),
        Displaced("--shift-x 72 --shift-y 24 --shift-step 24 --closer-step 6", 72, 24, 24, 6),
        Displaced("--shift-x 96 --shift-y 48", 96, 48, 16, 4)}},
      {"parts",
       {Parts("--parts-x 0 --parts-y 0", 0, 0), Parts("--parts-x 4 --parts-y 3", 4, 3),
        Parts("--parts-x 8 --parts-y 6", 8, 6)}},
      {"growth", {{"--no-growth", [](NetworkOptions& o) { o.growth = false; }}}},
      {"what synapses read",
       {{"--code gray", [](NetworkOptions& o) { o.code = wnn::Code::kGray; }}}},
      {"a bit",
       {{"--cells compare --contrast 60",
         [](NetworkOptions& o) {
           o.cells = wnn::Cells::kCompare;
           o.contrast_sigma = 60;
         }},
        {"--gradient-arm 8", [](NetworkOptions& o) { o.gradient_arm = 8; }},
        {"--gradient-arm 18", [](NetworkOptions& o) { o.gradient_arm = 18; }}}},
      {"receptive fields",
       {{"--sigma 20", [](NetworkOptions& o) { o.gaussian_sigma = 20; }},
        {"--sigma 45", [](NetworkOptions& o) { o.gaussian_sigma = 45; }}}},
      {"size of images",
       {{"--working-width 240", [](NetworkOptions& o) { o.working_width = 240; }}}},
      {"neurons",
       {{"--neurons-x 40 --neurons-y 23",
         [](NetworkOptions& o) {
           o.neurons_x = 40;
           o.neurons_y = 23;
         }}}},
  };
}

Tuned Tune(const std::vector<TuneQuestion>& questions,
           const std::function<double(const NetworkOptions& network)>& score, int seeds,
           std::uint64_t first_seed, const std::function<void(const Tried& tried)>& tell,
           double least) {
  Require(seeds >= 1, "tune", "needs a seed");
  const auto shares_of = [&](NetworkOptions network) {
    std::vector<double> shares;
    for (int s = 0; s < seeds; ++s) {
      network.seed = first_seed + static_cast<std::uint64_t>(s);
      shares.push_back(score(network));
    }
    return shares;
  };
  Tuned tuned;
  tuned.network = wnn::RecollectNetwork();
  tuned.network.seed = first_seed;
  tuned.start = tuned.shares = shares_of(tuned.network);
  for (const TuneQuestion& question : questions) {
    std::optional<std::size_t> best;  // of the tried
    NetworkOptions best_network;
    for (const TuneAnswer& answer : question.answers) {
      NetworkOptions network = tuned.network;
      answer.apply(network);
      Tried tried{question.about, answer.flags, shares_of(network), {}, false};
      std::vector<double> gains;
      for (std::size_t s = 0; s < tried.shares.size(); ++s) {
        gains.push_back(tried.shares[s] - tuned.shares[s]);
      }
      tried.gain = MeanOf(gains);
      const bool better = tried.gain.mean >= least && tried.gain.mean > tried.gain.half_width;
      if (tell) tell(tried);
      tuned.tried.push_back(tried);
      if (!better || (best && tried.gain.mean <= tuned.tried[*best].gain.mean)) continue;
      best = tuned.tried.size() - 1;
      best_network = network;
    }
    if (!best) continue;
    Tried& kept = tuned.tried[*best];
    kept.kept = true;
    tuned.network = best_network;
    tuned.shares = kept.shares;
    tuned.flags += (tuned.flags.empty() ? "" : " ") + kept.flags;
  }
  return tuned;
}

}  // namespace recollect
