#include "recollect/benchmark/faiss_rival.h"

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"

#ifdef RECOLLECT_FAISS
#include <faiss/IndexBinaryFlat.h>
#include <omp.h>
#endif

namespace recollect {

#ifdef RECOLLECT_FAISS

struct FaissRival::State {
  std::vector<std::unique_ptr<faiss::IndexBinaryFlat>> indices;  // by neuron
};

bool FaissRival::Available() { return true; }

FaissRival::FaissRival(const wnn::Memory& memory) : state_(std::make_unique<State>()) {
  const auto neurons = static_cast<std::size_t>(memory.neurons());
  std::vector<std::uint64_t> codes;
  for (std::size_t n = 0; n < neurons; ++n) {
    codes.clear();
    for (const wnn::BlockView& block : memory.blocks()) {
      const auto stride = static_cast<std::size_t>(block.capacity);
      for (std::size_t i = 0; i < static_cast<std::size_t>(block.frames); ++i) {
        codes.push_back(block.words[n * stride + i]);
        codes.push_back(block.words[(neurons + n) * stride + i]);
      }
    }
    state_->indices.push_back(std::make_unique<faiss::IndexBinaryFlat>(wnn::kSynapses));
    state_->indices.back()->add(memory.entries(),
                                reinterpret_cast<const std::uint8_t*>(codes.data()));
  }
}

std::vector<int> FaissRival::NearestDistances(
    std::span<const std::span<const std::uint64_t>> patterns, ThreadPool& pool) const {
  const std::size_t neurons = state_->indices.size(), count = patterns.size();
  std::vector<int> nearest(count * neurons);
  pool.For(static_cast<std::int64_t>(neurons), 64, [&](std::int64_t begin, std::int64_t end) {
    omp_set_num_threads(1);  // the pool's threads are all there are
    std::vector<std::uint64_t> codes(count * wnn::kWords);
    std::vector<std::int32_t> distances(count);
    std::vector<faiss::IndexBinary::idx_t> labels(count);
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      for (std::size_t q = 0; q < count; ++q) {
        codes[2 * q] = patterns[q][2 * n];
        codes[2 * q + 1] = patterns[q][2 * n + 1];
      }
      state_->indices[n]->search(static_cast<faiss::IndexBinary::idx_t>(count),
                                 reinterpret_cast<const std::uint8_t*>(codes.data()), 1,
                                 distances.data(), labels.data());
      for (std::size_t q = 0; q < count; ++q) nearest[q * neurons + n] = distances[q];
    }
  });
  return nearest;
}

#else

struct FaissRival::State {};

bool FaissRival::Available() { return false; }

FaissRival::FaissRival(const wnn::Memory&) {
  throw Error("faiss", "this program was built without it", "install libfaiss-dev and build again");
}

std::vector<int> FaissRival::NearestDistances(std::span<const std::span<const std::uint64_t>>,
                                              ThreadPool&) const {
  return {};
}

#endif

FaissRival::~FaissRival() = default;

}  // namespace recollect
