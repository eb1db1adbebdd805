#pragma once

#include <memory>
#include <span>

#include "recollect/wnn/memory.h"

namespace recollect {

class ThreadPool;

// The same search by FAISS: one flat index of 128-bit codes (IndexBinaryFlat) for each neuron.
class FaissRival {
 public:
  // Whether FAISS was there when this was built.
  static bool Available();

  // Throws Error where it was not.
  explicit FaissRival(const wnn::Memory& memory);
  ~FaissRival();

  // Distance of each neuron's nearest entry for each pattern, patterns x neurons. Neurons are
  // shared out over the pool.
  std::vector<int> NearestDistances(std::span<const std::span<const std::uint64_t>> patterns,
                                    ThreadPool& pool) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recollect
