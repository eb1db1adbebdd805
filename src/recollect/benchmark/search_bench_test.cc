#include "recollect/benchmark/search_bench.h"

#include <gtest/gtest.h>

#include "recollect/benchmark/faiss_rival.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/search.h"

namespace recollect {
namespace {

SearchBenchOptions Small() {
  SearchBenchOptions options;
  options.corpus.frames = 100;
  options.corpus.live = 10;
  options.corpus.network.neurons_x = 10;
  options.corpus.network.neurons_y = 8;
  options.checks = 10;
  options.rounds = 1;
  return options;
}

TEST(SearchBench, WritesEveryFigure) {
  SearchBenchOptions options = Small();
  options.ranks = 2;
  options.medoids = 20;
  const nlohmann::json figures = RunSearchBench(options);
  for (const char* key :
       {"read_ms", "plain_ms", "exact_ms", "exact_batch8_ms", "certified_ms", "anytime_ms",
        "fatfast_ms", "medoids_ms", "medoids_agreement", "encode_ms", "open_ms", "agreement"}) {
    EXPECT_TRUE(figures.contains(key)) << key;
  }
  EXPECT_EQ(figures.contains("faiss_ms"), FaissRival::Available());
  EXPECT_EQ(figures["disagreement"]["certified"], 0);
  EXPECT_EQ(figures["sharded_identical"], true);
  EXPECT_FALSE(DescribeSearchBench(figures).empty());
}

TEST(FaissRival, FindsTheSameDistances) {
  if (!FaissRival::Available()) GTEST_SKIP() << "built without FAISS";
  const Corpus corpus = RandomCorpus(Small().corpus);
  ThreadPool pool(2);
  const FaissRival faiss(corpus.memory);
  const std::vector<std::span<const std::uint64_t>> live(corpus.live.begin(), corpus.live.end());
  const std::vector<int> nearest = faiss.NearestDistances(live, pool);
  std::size_t at = 0;
  for (const Pattern& pattern : corpus.live) {
    for (const wnn::Answer answer : wnn::Recollect(corpus.memory, pattern, pool).answers) {
      EXPECT_EQ(nearest[at++], wnn::AnswerDistance(answer));
    }
  }
}

}  // namespace
}  // namespace recollect
