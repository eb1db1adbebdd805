#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recollect/benchmark/corpus.h"

namespace recollect {

struct SearchBenchOptions {
  CorpusOptions corpus;        // corpus.live images are looked up with every kind of search
  std::vector<Lap> laps;       // of the map; none: random patterns
  std::vector<Lap> live_laps;  // of the live images; none: frames between the key frames
  int checks = 2000;           // live images on which stopping early is compared with not
  double error_bound = 1e-4;   // of the anytime search
  int rounds = 15;             // measurements of each kind, in turns; medians are reported
  int ranks = 0;               // processes of a sharded search; 0: none
  bool fat_fast = true;        // these two take memory and time to build
  bool faiss = true;
  bool plain = true;  // takes long with many key frames
  int row_limit = 0;  // of Fat-Fast
  int medoids = 0;    // that a neuron keeps in a compressed memory; 0: none is measured
  int threads = 0;
};

// Measures every kind of search side by side on one map. Times in ms, medians:
//   read_ms          streaming the patterns' bytes from memory: the wall
//   exact_ms, exact_batch8_ms (a query of a batch of 8), certified_ms, anytime_ms, encode_ms,
//   restricted_ms (a twentieth of the map), open_ms
//   plain_ms (the plain kernel), fatfast_ms, medoids_ms, faiss_ms, sharded_ms where asked for
// and, by kind, shares of neurons read, of memory read, and of disagreement with the full search.
nlohmann::json RunSearchBench(const SearchBenchOptions& options, const ProgressSink& progress = {});

// The figures as a table for people.
std::string DescribeSearchBench(const nlohmann::json& figures);

}  // namespace recollect
