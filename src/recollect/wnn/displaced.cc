#include "recollect/wnn/displaced.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/wnn/closer_look.h"

namespace recollect::wnn {
namespace {

constexpr std::size_t kBatch = 8;   // images that share what a search reads from memory
constexpr std::size_t kLooks = 12;  // labels that are looked at again,
constexpr int kAround = 2;          // and so many before and after each
constexpr int kUsual = 64;          // entries that tell how far entries usually lie

// The best, over displacements, of the votes there and half of those one step off, times two.
int AgreedVotes(const std::vector<int>& votes, const Displacements& grid) {
  int best = 0;
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      int sum = votes[static_cast<std::size_t>(y * grid.columns + x)];
      for (int b = std::max(0, y - 1); b <= std::min(grid.rows - 1, y + 1); ++b) {
        for (int a = std::max(0, x - 1); a <= std::min(grid.columns - 1, x + 1); ++a) {
          sum += votes[static_cast<std::size_t>(b * grid.columns + a)];
        }
      }
      best = std::max(best, sum);
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

// Entries of the labels with most votes and of those around them.
std::vector<int> Promising(const Memory& memory, const EntrySet* allowed,
                           std::span<const LabelVotes> histogram) {
  std::set<int> labels;
  for (const LabelVotes& one : histogram.first(std::min(kLooks, histogram.size()))) {
    for (int label = one.label - kAround; label <= one.label + kAround; ++label) {
      if (label >= 0 && label < memory.labels()) labels.insert(label);
    }
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
void LookAgain(const Memory& memory, const DisplacedPatterns& live, std::size_t stride,
               ThreadPool& pool, const SearchOptions& search, Recollection& recollection) {
  const std::vector<int> entries = Promising(memory, search.allowed, recollection.histogram);
  const std::vector<int> near =
      NearDistances(memory, live, stride, Spread(memory, search.allowed, kUsual), pool);
  const std::vector<Look> looks = LookCloser(memory, live, near, entries, pool);
  std::map<int, int> votes;  // by label: those of its best entry
  for (std::size_t i = 0; i < entries.size(); ++i) {
    int& most = votes[memory.label(entries[i])];
    most = std::max(most, looks[i].votes);
  }
  for (const LabelVotes& one : recollection.histogram) votes[one.label] += one.votes;
  std::vector<LabelVotes> histogram;
  for (const auto& [label, count] : votes) {
    if (count > 0) histogram.push_back({label, count});
  }
  SetHistogram(std::move(histogram), recollection);
}

}  // namespace

Recollection MergeDisplaced(std::span<const int> labels,
                            std::span<const std::vector<Answer>> answers,
                            const Displacements& grid) {
  Require(static_cast<int>(answers.size()) == grid.count(), "displacements",
          "as many sets of answers are needed as there are displacements");
  Recollection merged;
  merged.answers = answers.front();
  std::vector<int> seen_under(merged.answers.size(), 0);
  for (std::size_t d = 1; d < answers.size(); ++d) {
    for (std::size_t n = 0; n < merged.answers.size(); ++n) {
      if (answers[d][n] >= merged.answers[n]) continue;
      merged.answers[n] = answers[d][n];
      seen_under[n] = static_cast<int>(d);
    }
  }
  std::vector<std::pair<int, int>> votes;  // label, displacement
  for (std::size_t n = 0; n < merged.answers.size(); ++n) {
    if (merged.answers[n] == kNoAnswer) continue;
    const auto entry = static_cast<std::size_t>(AnswerEntry(merged.answers[n]));
    votes.emplace_back(labels[entry], seen_under[n]);
  }
  merged.neurons_read = static_cast<int>(votes.size());
  std::sort(votes.begin(), votes.end());
  std::vector<LabelVotes> doubled;
  std::vector<int> of_label(answers.size());
  for (auto vote = votes.begin(); vote != votes.end();) {
    const int label = vote->first;
    std::fill(of_label.begin(), of_label.end(), 0);
    for (; vote != votes.end() && vote->first == label; ++vote) {
      ++of_label[static_cast<std::size_t>(vote->second)];
    }
    doubled.push_back({label, AgreedVotes(of_label, grid)});
  }
  SetHistogram(std::move(doubled), merged);
  for (LabelVotes& one : merged.histogram) one.votes = (one.votes + 1) / 2;
  return merged;
}

Recollection RecollectImage(const Memory& memory, Encoder& encoder, const ImageView& image,
                            ThreadPool& pool, const SearchOptions& search) {
  const Displacements grid = encoder.displacements(), closer = encoder.closer_displacements();
  if (grid.count() == 1) return Recollect(memory, encoder.Encode(image), pool, search);
  const bool look_closer = closer.count() > 1;
  const auto patterns = encoder.EncodeDisplaced(image, look_closer ? closer : grid);
  const int finer = look_closer ? grid.step / closer.step : 1;
  const int columns = (grid.columns - 1) * finer + 1;
  std::vector<std::span<const std::uint64_t>> coarse;
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      coarse.emplace_back(patterns[static_cast<std::size_t>((y * columns + x) * finer)]);
    }
  }
  std::vector<std::vector<Answer>> answers;
  std::int64_t words = 0;
  for (std::size_t begin = 0; begin < coarse.size(); begin += kBatch) {
    const std::span<const std::span<const std::uint64_t>> all = coarse;
    const auto batch = all.subspan(begin, std::min(kBatch, coarse.size() - begin));
    for (Recollection& one : RecollectBatch(memory, batch, pool, search)) {
      words += one.words_read;
      answers.push_back(std::move(one.answers));
    }
  }
  Recollection merged = MergeDisplaced(memory.entry_labels(), answers, grid);
  merged.words_read = words;
  if (look_closer)
    LookAgain(memory, {patterns, closer}, static_cast<std::size_t>(finer), pool, search, merged);
  return merged;
}

}  // namespace recollect::wnn
