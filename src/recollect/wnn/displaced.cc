#include "recollect/wnn/displaced.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

constexpr std::size_t kBatch = 8;  // images that share what a search reads from memory

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
  std::stable_sort(doubled.begin(), doubled.end(),
                   [](const LabelVotes& a, const LabelVotes& b) { return a.votes > b.votes; });
  if (!doubled.empty()) {
    const int first = doubled[0].votes, second = doubled.size() > 1 ? doubled[1].votes : 0;
    merged.winner = doubled[0].label;
    merged.confidence = static_cast<double>(first - second) / first;
  }
  for (const LabelVotes& one : doubled) {
    merged.histogram.push_back({one.label, (one.votes + 1) / 2});
  }
  return merged;
}

Recollection RecollectImage(const Memory& memory, Encoder& encoder, const ImageView& image,
                            ThreadPool& pool, const SearchOptions& search) {
  const Displacements grid = encoder.displacements();
  if (grid.count() == 1) return Recollect(memory, encoder.Encode(image), pool, search);
  const auto patterns = encoder.EncodeDisplaced(image);
  std::vector<std::vector<Answer>> answers;
  std::int64_t words = 0;
  for (std::size_t begin = 0; begin < patterns.size(); begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, patterns.size());
    const std::vector<std::span<const std::uint64_t>> batch(
        patterns.begin() + static_cast<std::ptrdiff_t>(begin),
        patterns.begin() + static_cast<std::ptrdiff_t>(end));
    for (Recollection& one : RecollectBatch(memory, batch, pool, search)) {
      words += one.words_read;
      answers.push_back(std::move(one.answers));
    }
  }
  Recollection merged = MergeDisplaced(memory.entry_labels(), answers, grid);
  merged.words_read = words;
  return merged;
}

}  // namespace recollect::wnn
