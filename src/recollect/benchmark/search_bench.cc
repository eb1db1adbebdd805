#include "recollect/benchmark/search_bench.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>

#include "recollect/benchmark/faiss_rival.h"
#include "recollect/benchmark/shard_bench.h"
#include "recollect/core/parallel.h"
#include "recollect/core/stopwatch.h"
#include "recollect/map/store.h"
#include "recollect/wnn/compressed.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/fat_fast.h"
#include "recollect/wnn/kernel.h"
#include "recollect/wnn/search.h"

namespace recollect {
namespace {

using nlohmann::json;
using wnn::Stop;

// Streams all words of the memory, the least that a search of all neurons could do.
std::uint64_t StreamAll(const wnn::Memory& memory, ThreadPool& pool) {
  std::atomic<std::uint64_t> result = 0;
  const auto blocks = static_cast<std::int64_t>(memory.blocks().size());
  pool.For(blocks, 1, [&](std::int64_t begin, std::int64_t) {
    const wnn::BlockView& block = memory.blocks()[static_cast<std::size_t>(begin)];
    const std::size_t count = wnn::BlockWords(memory.neurons(), block.capacity);
    std::uint64_t sums[8] = {};
    for (std::size_t i = 0; i < count; i += 8) {
      for (std::size_t j = 0; j < 8; ++j) sums[j] += block.words[i + j];
    }
    for (const std::uint64_t sum : sums) result += sum;
  });
  return result;
}

// Kinds of search that are timed in turns, so that a busy machine slows all of them alike.
class Race {
 public:
  // `run` does one measurement of `items` queries; round counts from 0.
  void Add(const std::string& name, int items, std::function<void(int round)> run) {
    runners_.push_back({name, items, std::move(run), {}});
  }

  json Run(int rounds, const ProgressSink& progress) {
    for (int round = -1; round < rounds; ++round) {  // the first turn warms up
      for (Runner& runner : runners_) {
        const Stopwatch watch;
        runner.run(round < 0 ? 0 : round);
        if (round >= 0) runner.times.push_back(watch.Milliseconds() / runner.items);
      }
      Report(progress, "race", round + 1, rounds);
    }
    json medians;
    for (Runner& runner : runners_) {
      std::sort(runner.times.begin(), runner.times.end());
      medians[runner.name] = runner.times[runner.times.size() / 2];
    }
    return medians;
  }

 private:
  struct Runner {
    std::string name;
    int items;
    std::function<void(int)> run;
    std::vector<double> times;
  };
  std::vector<Runner> runners_;
};

// Upper end of the 95 % interval (Wilson's) of a rate of which `events` were seen in `trials`.
double UpperRate(int events, int trials) {
  const double z = 1.96, n = trials, p = events / n;
  const double centre = p + z * z / (2 * n);
  return (centre + z * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n))) / (1 + z * z / n);
}

// Opens a store that holds the map's patterns, as a map does. Returns milliseconds.
double OpenMilliseconds(const wnn::Memory& memory) {
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("recollect-bench-{}.map", static_cast<int>(getpid()));
  CreateStore(file, [&](StoreWriter& writer) {
    std::uint32_t number = 0;
    for (const wnn::BlockView& block : memory.blocks()) {
      const std::size_t words = wnn::BlockWords(memory.neurons(), block.capacity);
      writer.Put(Table::kPatterns, number++, std::as_bytes(std::span(block.words, words)));
    }
  });
  std::vector<double> times;
  for (int i = 0; i < 5; ++i) {
    const Stopwatch watch;
    const StoreReader store(file);
    wnn::Memory opened(memory.neurons());
    for (std::uint32_t b = 0; b < memory.blocks().size(); ++b) {
      const auto bytes = store.Get(Table::kPatterns, b);
      opened.AddBlock({reinterpret_cast<const std::uint64_t*>(bytes->data()),
                       memory.blocks()[b].frames, memory.blocks()[b].capacity});
    }
    times.push_back(watch.Milliseconds());
  }
  std::filesystem::remove(file);
  std::filesystem::remove(file.string() + "-lock");
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

// How much the searches that stop early read, and how often they choose otherwise than all.
void CompareStops(const Corpus& corpus, const SearchBenchOptions& options, ThreadPool& pool,
                  json& figures, const ProgressSink& progress) {
  const double words = 2.0 * corpus.memory.neurons() * corpus.memory.entries();
  const int count = std::min(options.checks, static_cast<int>(corpus.live.size()));
  std::map<std::string, double> neurons, memory;
  std::map<std::string, int> wrong;
  for (int i = 0; i < count; ++i) {
    const Pattern& live = corpus.live[static_cast<std::size_t>(i)];
    int winner = -1;
    for (const auto& [name, stop] : {std::pair{"exact", Stop::kNever},
                                     {"certified", Stop::kCertain},
                                     {"anytime", Stop::kConfident}}) {
      const auto r = wnn::Recollect(
          corpus.memory, live, pool,
          {.stop = stop, .error_bound = options.error_bound, .tie_seed = options.corpus.seed});
      if (stop == Stop::kNever) winner = r.winner;
      neurons[name] += static_cast<double>(r.neurons_read) / corpus.memory.neurons() / count;
      memory[name] += static_cast<double>(r.words_read) / words / count;
      wrong[name] += r.winner != winner;
    }
    Report(progress, "compare", i + 1, count);
  }
  for (const std::string name : {"certified", "anytime"}) {
    figures["neurons_read"][name] = neurons[name];
    figures["disagreement"][name] = static_cast<double>(wrong[name]) / count;
  }
  figures["disagreement"]["anytime_upper95"] = UpperRate(wrong["anytime"], count);
  figures["memory_read"] = memory;
  figures["checks"] = count;
}

}  // namespace

json RunSearchBench(const SearchBenchOptions& options, const ProgressSink& progress) {
  CorpusOptions corpus_options = options.corpus;
  corpus_options.live = std::max({options.corpus.live, options.checks, 8});
  Corpus corpus;
  {
    ThreadPool pool(options.threads);
    corpus = options.laps.empty()
                 ? RandomCorpus(corpus_options)
                 : LapCorpus(options.laps, options.live_laps, corpus_options, pool, progress);
  }
  const wnn::Memory& memory = corpus.memory;
  json figures = {{"frames", memory.entries()},
                  {"neurons", memory.neurons()},
                  {"patterns", options.laps.empty() ? "random" : "laps"},
                  {"kernel", std::string(wnn::Kernels().front()->name)}};
  const auto live = [&](int i) -> const Pattern& {
    return corpus.live[static_cast<std::size_t>(i) % corpus.live.size()];
  };
  const std::uint64_t seed = options.corpus.seed;
  if (options.ranks > 0) {  // first: processes are forked before there are threads
    Corpus few{memory.labels() > 0 ? wnn::Memory(memory.neurons()) : wnn::Memory(1), {}};
    for (const wnn::BlockView& block : memory.blocks()) few.memory.AddBlock(block);
    for (int i = 0; i < 20; ++i) few.live.push_back(live(i));
    const ShardFigures shard = RunShardBench(few, options.ranks, 1, seed);
    ThreadPool pool(options.threads);
    std::uint64_t digest = 0;
    for (const Pattern& pattern : few.live) {
      digest = Digest(wnn::Recollect(memory, pattern, pool, {.tie_seed = seed}).answers, digest);
    }
    figures["ranks"] = options.ranks;
    figures["sharded_ms"] = shard.search_ms;
    figures["sharded_identical"] = digest == shard.digest;
  }

  ThreadPool pool(options.threads);
  CompareStops(corpus, options, pool, figures, progress);

  Race race;
  const auto search = [&](const std::string& name, const wnn::SearchOptions& how) {
    race.Add(name, 1, [&, how](int i) { wnn::Recollect(memory, live(i), pool, how); });
  };
  const auto batch = [&](int i) {
    std::vector<std::span<const std::uint64_t>> patterns;
    for (int q = 0; q < 8; ++q) patterns.push_back(live(8 * i + q));
    return patterns;
  };
  wnn::EntrySet window(memory);
  window.AllowRange(0, std::max(1, memory.entries() / 20));
  std::uint64_t sum = 0;
  race.Add("read_ms", 1, [&](int) { sum += StreamAll(memory, pool); });
  search("exact_ms", {.tie_seed = seed});
  race.Add("exact_batch8_ms", 8,
           [&](int i) { wnn::RecollectBatch(memory, batch(i), pool, {.tie_seed = seed}); });
  if (options.plain) search("plain_ms", {.tie_seed = seed, .kernel = &wnn::kPlainKernel});
  search("certified_ms", {.stop = Stop::kCertain, .tie_seed = seed});
  search("anytime_ms",
         {.stop = Stop::kConfident, .error_bound = options.error_bound, .tie_seed = seed});
  search("restricted_ms", {.tie_seed = seed, .allowed = &window});

  Pattern pattern(memory.neurons() * static_cast<std::size_t>(wnn::kWords));
  wnn::Encoder encoder(options.corpus.network, 640, 480, pool);
  std::vector<std::uint8_t> pixels(640 * 480 * 3);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(SubSeed(1, i / 12));
  }
  race.Add("encode_ms", 1, [&](int) {
    encoder.Encode({pixels.data(), 640, 480, 3, 640 * 3}, pattern);
  });

  std::unique_ptr<FaissRival> faiss;
  if (options.faiss && FaissRival::Available()) {
    faiss = std::make_unique<FaissRival>(memory);
    race.Add("faiss_ms", 1, [&](int i) {
      const std::span<const std::uint64_t> one = live(i);
      faiss->NearestDistances({&one, 1}, pool);
    });
  }
  // How often a search that need not be exact names the exact one's winner, and its neurons theirs.
  struct Agreement {
    double winners = 0, neurons = 0;
  };
  const auto agreement_of = [&](const auto& ask) {
    Agreement agreement;
    const int count = std::min(200, static_cast<int>(corpus.live.size()));
    for (int i = 0; i < count; ++i) {
      const wnn::Recollection a = ask(i);
      const auto b = wnn::Recollect(memory, live(i), pool, {.tie_seed = seed});
      agreement.winners += a.winner == b.winner ? 1.0 / count : 0;
      int same = 0;
      for (std::size_t n = 0; n < a.answers.size(); ++n) {
        same += wnn::AnswerEntry(a.answers[n]) == wnn::AnswerEntry(b.answers[n]);
      }
      agreement.neurons += static_cast<double>(same) / memory.neurons() / count;
    }
    return agreement;
  };
  std::unique_ptr<wnn::FatFast> fat_fast;
  if (options.fat_fast) {
    fat_fast = std::make_unique<wnn::FatFast>(memory, pool,
                                              wnn::FatFastOptions{.row_limit = options.row_limit});
    figures["fatfast_bytes"] = fat_fast->bytes();
    race.Add("fatfast_ms", 1, [&](int i) { fat_fast->Recollect(live(i), pool, seed); });
    const Agreement agreement =
        agreement_of([&](int i) { return fat_fast->Recollect(live(i), pool, seed); });
    figures["agreement"] = agreement.winners;
    figures["neuron_agreement"] = agreement.neurons;
  }
  std::unique_ptr<wnn::CompressedMemory> medoids;
  if (options.medoids > 0) {
    medoids = std::make_unique<wnn::CompressedMemory>(
        memory, pool, wnn::CompressionOptions{.medoids = options.medoids, .seed = seed}, progress);
    const auto ask = [&](int i) { return medoids->Recollect(live(i), pool, {.tie_seed = seed}); };
    race.Add("medoids_ms", 1, ask);
    const Agreement agreement = agreement_of(ask);
    figures["medoids_agreement"] = agreement.winners;
    figures["medoids_neuron_agreement"] = agreement.neurons;
  }
  figures.update(race.Run(options.rounds, progress));
  figures["open_ms"] = OpenMilliseconds(memory);
  figures["bytes"] =
      wnn::BlockWords(memory.neurons(), 1) * 8 * static_cast<std::size_t>(memory.entries());
  figures["checksum"] = sum;  // keeps the reading from being optimised away
  return figures;
}

std::string DescribeSearchBench(const json& figures) {
  const double wall = figures.at("read_ms");
  std::string text = fmt::format(
      "{} key frames, {} neurons, {:.0f} MB, {} patterns, {}\n", figures.at("frames").get<int>(),
      figures.at("neurons").get<int>(), figures.at("bytes").get<double>() / 1e6,
      figures.at("patterns").get<std::string>(), figures.at("kernel").get<std::string>());
  text += fmt::format("{:<14}{:>10}{:>10}\n", "", "ms", "x read");
  for (const char* name :
       {"read", "plain", "exact", "exact_batch8", "certified", "anytime", "restricted", "fatfast",
        "medoids", "faiss", "sharded", "encode", "open"}) {
    const std::string key = std::string(name) + "_ms";
    if (!figures.contains(key)) continue;
    const double ms = figures.at(key);
    text += fmt::format("{:<14}{:>10.3f}{:>10.3f}\n", name, ms, ms / wall);
  }
  for (const char* name : {"certified", "anytime"}) {
    text += fmt::format("{}: {:.1f} % of neurons, {:.1f} % of memory read, {:.3f} % disagree\n",
                        name, 100 * figures.at("neurons_read").at(name).get<double>(),
                        100 * figures.at("memory_read").at(name).get<double>(),
                        100 * figures.at("disagreement").at(name).get<double>());
  }
  if (figures.contains("agreement")) {
    text += fmt::format("fatfast: agrees with exact on {:.1f} % of images\n",
                        100 * figures.at("agreement").get<double>());
  }
  if (figures.contains("medoids_agreement")) {
    text += fmt::format("medoids: agree with exact on {:.1f} % of images\n",
                        100 * figures.at("medoids_agreement").get<double>());
  }
  if (figures.contains("sharded_identical")) {
    text +=
        fmt::format("sharded: answers {} those of one process\n",
                    figures.at("sharded_identical").get<bool>() ? "identical to" : "DIFFER from");
  }
  return text;
}

}  // namespace recollect
