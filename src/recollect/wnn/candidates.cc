#include "recollect/wnn/candidates.h"

#include <algorithm>

namespace recollect::wnn {

Candidates ChooseCandidates(const Memory& memory, const Tally& tally, const EntrySet* allowed,
                            int max_labels, int max_entries) {
  std::vector<int> voted(tally.voted().begin(), tally.voted().end());
  const auto kept = std::min(static_cast<std::size_t>(max_labels), voted.size());
  std::partial_sort(voted.begin(), voted.begin() + static_cast<std::ptrdiff_t>(kept), voted.end(),
                    [&](int a, int b) {
                      return tally.votes(a) > tally.votes(b) ||
                             (tally.votes(a) == tally.votes(b) && a < b);
                    });
  voted.resize(kept);
  Candidates candidates;
  for (const int label : voted) {
    std::vector<int> entries = memory.EntriesOf(label);
    std::erase_if(entries, [&](int entry) { return allowed && !allowed->Allows(entry); });
    if (candidates.entries.size() + entries.size() > static_cast<std::size_t>(max_entries)) break;
    candidates.labels.push_back(label);
    candidates.entries.insert(candidates.entries.end(), entries.begin(), entries.end());
  }
  return candidates;
}

std::vector<std::vector<int>> Peek(const Memory& memory, Asking& asking, const Tally& tally,
                                   const Candidates& candidates) {
  std::vector<std::vector<int>> neurons(candidates.labels.size());
  if (neurons.empty()) return neurons;
  asking.SetHints(candidates.entries);
  asking.Peek(tally.read(), memory.neurons());
  for (int n = tally.read(); n < memory.neurons(); ++n) {
    const int label = memory.label(asking.entry(n));
    const auto at = std::find(candidates.labels.begin(), candidates.labels.end(), label);
    neurons[static_cast<std::size_t>(at - candidates.labels.begin())].push_back(n);
  }
  return neurons;
}

}  // namespace recollect::wnn
