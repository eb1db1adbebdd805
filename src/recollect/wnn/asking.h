#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/kernel.h"
#include "recollect/wnn/search.h"

namespace recollect::wnn {

// The blocks that a search goes through and which of their frames it looks at.
std::vector<ScanBlock> BlocksOf(const Memory& memory, const SearchOptions& options,
                                int first_entry = 0);

// Where one entry's words lie; it is called by its number in the memory plus first_entry.
ScanEntry EntryIn(const Memory& memory, int entry, int first_entry = 0);

// The kernel that a search uses.
const Kernel& KernelOf(const SearchOptions& options);

// Throws Error unless the pattern is of the memory's network.
void CheckPattern(const Memory& memory, std::span<const std::uint64_t> pattern);

// One image's way through a memory: asks neurons, in any order and any portions.
class Asking {
 public:
  Asking(const Memory& memory, std::span<const std::uint64_t> pattern, ThreadPool& pool,
         const SearchOptions& options, int first_entry = 0);

  // Whether there is nothing to look at.
  bool empty() const { return blocks_.empty(); }

  // Asks neurons [begin, end), or those listed, in portions of `grain` to a thread.
  void Ask(int begin, int end, int grain);
  void Ask(std::span<const int> neurons, int grain);

  // Entries that neurons asked from now on try first: a near one lets them skip half of most
  // patterns. Which ones changes no answer. Entries are numbered as in the memory.
  void SetHints(std::span<const int> entries);
  // Gives neurons [begin, end) the nearest of the hinted entries for a provisional answer.
  void Peek(int begin, int end);
  // Makes a neuron one that was not asked.
  void Forget(int neuron) { answers_[static_cast<std::size_t>(neuron)] = kNoAnswer; }

  const ScanQuery& query() const { return query_; }
  Answer answer(int neuron) const { return answers_[static_cast<std::size_t>(neuron)]; }
  // Entry, numbered as in the memory, of a neuron that has answered.
  int entry(int neuron) const { return AnswerEntry(answer(neuron)) - first_entry_; }

  std::vector<Answer> TakeAnswers() { return std::move(answers_); }
  std::int64_t words_read() const { return words_read_; }

 private:
  std::int64_t TryHints(int begin, int end);  // returns the number of words read

  const Memory& memory_;
  ThreadPool& pool_;
  const Kernel& kernel_;
  int first_entry_;
  std::vector<ScanBlock> blocks_;
  std::vector<Answer> answers_;
  ScanQuery query_;
  std::vector<ScanEntry> hints_;
  std::atomic<std::int64_t> words_read_ = 0;
};

}  // namespace recollect::wnn
