#include "recollect/wnn/displaced.h"

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/asking.h"
#include "recollect/wnn/closer_look.h"
#include "recollect/wnn/kernel.h"
#include "recollect/wnn/zoom.h"

namespace recollect::wnn {
namespace {

constexpr int kGrain = 16;          // neurons that a thread takes at a time
constexpr std::size_t kLooks = 12;  // labels that are looked at again,
constexpr int kAround = 2;          // and so many before and after each
constexpr int kGap = 4;             // and those between two of these, at most so many
constexpr int kUsual = 64;          // entries that tell how far entries usually lie

// The best displacement by the votes there and half of those one step off, and these times two.
LabelView Agreed(int label, const std::vector<int>& votes, const Displacements& grid) {
  LabelView best{label, -1, 0, {0}};
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      int sum = votes[static_cast<std::size_t>(y * grid.columns + x)];
      for (int b = std::max(0, y - 1); b <= std::min(grid.rows - 1, y + 1); ++b) {
        for (int a = std::max(0, x - 1); a <= std::min(grid.columns - 1, x + 1); ++a) {
          sum += votes[static_cast<std::size_t>(b * grid.columns + a)];
        }
      }
      if (sum > best.halves) best = {label, -1, sum, {y * grid.columns + x}};
    }
  }
  return best;
}

// Votes by rising label; they decide winner and confidence.
void SetHistogram(std::vector<LabelVotes> histogram, Recollection& recollection) {
  std::stable_sort(histogram.begin(), histogram.end(),
                   [](const LabelVotes& a, const LabelVotes& b) { return a.votes > b.votes; });
  if (!histogram.empty()) {
    const int first = histogram[0].votes, second = histogram.size() > 1 ? histogram[1].votes : 0;
    recollection.winner = histogram[0].label;
    recollection.confidence = static_cast<double>(first - second) / first;
  }
  recollection.histogram = std::move(histogram);
}

// Entries that the search may look at, about so many, evenly spread.
std::vector<int> Spread(const Memory& memory, const EntrySet* allowed, int count) {
  std::vector<int> entries;
  for (int entry = 0; entry < memory.entries(); ++entry) {
    if (!allowed || allowed->Allows(entry)) entries.push_back(entry);
  }
  const std::size_t step =
      (entries.size() + static_cast<std::size_t>(count) - 1) / static_cast<std::size_t>(count);
  std::vector<int> spread;
  for (std::size_t i = 0; i < entries.size(); i += step) spread.push_back(entries[i]);
  return spread;
}

// Entries of the labels with most votes and of those around them, by rising label. A place that
// was not looked at closer has hardly any votes: among places that were it would look refuted.
std::vector<int> Promising(const Memory& memory, const EntrySet* allowed,
                           const std::vector<LabelVotes>& histogram) {
  std::set<int> labels;
  for (std::size_t i = 0; i < std::min(kLooks, histogram.size()); ++i) {
    const int first = std::max(0, histogram[i].label - kAround);
    const int last = std::min(memory.labels() - 1, histogram[i].label + kAround);
    for (int label = first; label <= last; ++label) labels.insert(label);
  }
  const std::vector<int> chosen(labels.begin(), labels.end());
  for (std::size_t i = 1; i < chosen.size(); ++i) {
    if (chosen[i] - chosen[i - 1] > kGap + 1) continue;
    for (int label = chosen[i - 1] + 1; label < chosen[i]; ++label) labels.insert(label);
  }
  std::vector<int> entries;
  for (const int label : labels) {
    for (const int entry : memory.EntriesOf(label)) {
      if (!allowed || allowed->Allows(entry)) entries.push_back(entry);
    }
  }
  return entries;
}

// Adds the votes of a closer look.
void LookAgain(const Memory& memory, const DisplacedImage& live, const DisplacedPatterns& first,
               const Encoder& encoder, ThreadPool& pool, const SearchOptions& search,
               Recollection& recollection) {
  const std::vector<int>& parts = encoder.parts();
  const std::vector<PartCentre> centres = PartCentres(encoder.synapses(), parts);
  const auto entries = Promising(memory, search.allowed, recollection.histogram);
  recollection.near = NearDistances(memory, first, Spread(memory, search.allowed, kUsual), pool);
  const std::vector<Look> looks = LookCloser(memory, live, recollection.near, entries, parts, pool);
  auto& views = recollection.second_look;
  std::vector<Zoom> zooms;  // of these
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const int label = memory.label(entries[i]);
    const LabelView view{label, entries[i], looks[i].halves, looks[i].displacements};
    const bool another = views.empty() || views.back().label != label;
    if (!another && view.halves <= views.back().halves) continue;
    if (another) {
      views.emplace_back();
      zooms.emplace_back();
    }
    views.back() = view;
    if (encoder.tells_growth()) zooms.back() = ZoomOf(looks[i], centres, live.grid());
  }
  std::map<int, LabelVotes> halves;  // by label, in place of votes
  for (const LabelView& view : recollection.first_look) halves[view.label].votes += view.halves;
  for (std::size_t i = 0; i < views.size(); ++i) {
    LabelVotes& one = halves[views[i].label];
    one.votes += views[i].halves;
    one.zoom = zooms[i];
  }
  std::vector<LabelVotes> histogram;
  for (const auto& [label, one] : halves) {
    if (one.votes > 0) histogram.push_back({label, (one.votes + 1) / 2, one.zoom});
  }
  SetHistogram(std::move(histogram), recollection);
}

}  // namespace

Grids::Grids(const Encoder& encoder)
    : first(encoder.displacements()), closer(encoder.closer_displacements()) {
  look_closer = closer.count() > 1;
  if (!look_closer) closer = first;
}

DisplacedAnswers AskDisplaced(const Memory& memory, const DisplacedPatterns& live, ThreadPool& pool,
                              const SearchOptions& search) {
  const auto neurons = static_cast<std::size_t>(memory.neurons());
  DisplacedAnswers asked{std::vector<Answer>(neurons, kNoAnswer), std::vector<int>(neurons, 0)};
  const std::vector<std::uint64_t> middle = live.Under(live.grid.count() / 2);
  CheckPattern(memory, middle);
  const DisplacedQuery query{live.words.data(), live.grid.count(),
                             TieBreak(search.tie_seed, middle), asked.answers.data()};
  const Kernel& kernel = KernelOf(search);
  const std::vector<ScanBlock> blocks = BlocksOf(memory, search);
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (const ScanBlock& block : blocks) {
      kernel.scan_displaced(block, query, static_cast<int>(begin), static_cast<int>(end));
    }
    std::vector<std::uint64_t> near(static_cast<std::size_t>(live.grid.count() / 64 + 1));
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const Answer answer = asked.answers[n];
      if (answer == kNoAnswer) continue;
      const ScanEntry entry = EntryIn(memory, AnswerEntry(answer));
      const std::size_t at = n * static_cast<std::size_t>(entry.stride);
      const std::uint64_t words[kWords] = {entry.low[at], entry.high[at]};
      kernel.find_near(ViewsOf(live.Of(n)), words, AnswerDistance(answer), near.data());
      std::size_t word = 0;
      while (near[word] == 0) ++word;
      asked.seen_under[n] = static_cast<int>(64 * word) + std::countr_zero(near[word]);
    }
  });
  return asked;
}

Recollection MergeDisplaced(std::span<const int> labels, DisplacedAnswers asked,
                            const Displacements& grid) {
  Require(asked.answers.size() == asked.seen_under.size(), "displacements",
          "one is needed for each answer");
  Recollection merged;
  merged.answers = std::move(asked.answers);
  merged.seen_under = std::move(asked.seen_under);
  std::vector<std::pair<int, int>> votes;  // label, displacement
  for (std::size_t n = 0; n < merged.answers.size(); ++n) {
    if (merged.answers[n] == kNoAnswer) continue;
    const auto entry = static_cast<std::size_t>(AnswerEntry(merged.answers[n]));
    votes.emplace_back(labels[entry], merged.seen_under[n]);
  }
  merged.neurons_read = static_cast<int>(votes.size());
  std::sort(votes.begin(), votes.end());
  std::vector<LabelVotes> doubled;
  std::vector<int> of_label(static_cast<std::size_t>(grid.count()));
  for (auto vote = votes.begin(); vote != votes.end();) {
    const int label = vote->first;
    std::fill(of_label.begin(), of_label.end(), 0);
    for (; vote != votes.end() && vote->first == label; ++vote) {
      ++of_label[static_cast<std::size_t>(vote->second)];
    }
    merged.first_look.push_back(Agreed(label, of_label, grid));
    doubled.push_back({label, merged.first_look.back().halves});
  }
  SetHistogram(std::move(doubled), merged);
  for (LabelVotes& one : merged.histogram) one.votes = (one.votes + 1) / 2;
  return merged;
}

Recollection RecollectImage(const Memory& memory, Encoder& encoder, const ImageView& image,
                            ThreadPool& pool, const SearchOptions& search) {
  const Grids grids(encoder);
  const Displacements& grid = grids.first;
  if (grid.count() == 1) return Recollect(memory, encoder.Encode(image), pool, search);
  const DisplacedImage live = encoder.LookDisplaced(image, grids.closer);
  const DisplacedPatterns first = live.Every(grids.finer());
  Recollection merged =
      MergeDisplaced(memory.entry_labels(), AskDisplaced(memory, first, pool, search), grid);
  const int looked_at = search.allowed ? search.allowed->size() : memory.entries();
  merged.words_read = std::int64_t{looked_at} * memory.neurons() * kWords;
  if (grids.look_closer) {
    LookAgain(memory, live, first, encoder, pool, search, merged);
  }
  return merged;
}

}  // namespace recollect::wnn
