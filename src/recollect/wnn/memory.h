#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "recollect/wnn/network.h"

namespace recollect::wnn {

// Key frames are kept in blocks of at most this many.
inline constexpr int kBlockFrames = 64;

// A block of key frames, laid out to be streamed and to be searched where it lies (in a memory-
// mapped file, too): first the bits of synapses 0..63 as [neuron][frame], then those of synapses
// 64..127 as [neuron][frame]. Rows are `capacity` words long; those past `frames` are unused.
struct BlockView {
  const std::uint64_t* words =
      nullptr;                  // BlockWords(neurons, capacity) of them; any alignment of 8
  int frames = 0;               // key frames in it
  int capacity = kBlockFrames;  // room in it: a multiple of 8, at most kBlockFrames
};

// 64-bit words that a block takes.
constexpr std::size_t BlockWords(int neurons, int capacity = kBlockFrames) {
  return static_cast<std::size_t>(neurons) * static_cast<std::size_t>(capacity) * kWords;
}

// Writes the pattern of one key frame into place `frame` of a block, or reads it back. Patterns
// are as Encoder gives them, neurons x kWords words.
void StoreFrame(std::span<const std::uint64_t> pattern, int frame, int capacity,
                std::uint64_t* block);
void LoadFrame(const BlockView& block, int frame, std::span<std::uint64_t> pattern);

// What the network has learnt: a list of blocks, its own or someone else's. Entries are numbered
// from 0 in the order they came. Each carries a label, the place it votes for.
class Memory {
 public:
  explicit Memory(int neurons);

  int neurons() const { return neurons_; }
  int entries() const { return static_cast<int>(labels_.size()); }
  int labels() const { return label_count_; }                    // the highest label + 1
  std::span<const int> entry_labels() const { return labels_; }  // by entry
  int label(int entry) const { return labels_[static_cast<std::size_t>(entry)]; }

  // All entries of a label, the last first.
  std::vector<int> EntriesOf(int label) const;

  // Learns one image: its pattern, and a label >= 0 (its entry's number where none is given).
  // Returns the entry. Throws Error on a pattern of another network.
  int Append(std::span<const std::uint64_t> pattern);
  int Append(std::span<const std::uint64_t> pattern, int label);

  // Adds a block without copying it; it must outlive the memory. Labels as in Append, one a frame.
  void AddBlock(const BlockView& block);
  void AddBlock(const BlockView& block, std::span<const int> labels);

  std::span<const BlockView> blocks() const { return blocks_; }
  // Number of the first entry of a block.
  int first_entry(std::size_t block) const { return first_entry_[block]; }
  // The pattern of one entry, neurons x kWords words.
  std::vector<std::uint64_t> Pattern(int entry) const;
  // The block that holds an entry.
  std::size_t BlockOf(int entry) const;

 private:
  struct Free {
    void operator()(std::uint64_t* words) const;
  };
  using Words = std::unique_ptr<std::uint64_t[], Free>;
  static Words Allocate(std::size_t count);
  void AddLabel(int label);

  int neurons_;
  int label_count_ = 0;
  std::vector<BlockView> blocks_;
  std::vector<int> first_entry_;  // by block
  std::vector<int> labels_;       // by entry
  std::vector<int> last_of_;      // by label: its last entry, -1: none
  std::vector<int> before_;       // by entry: the one before it with the same label, -1: none
  std::vector<Words> owned_;
  bool last_is_owned_ = false;
};

}  // namespace recollect::wnn
