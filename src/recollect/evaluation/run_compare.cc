#include "recollect/evaluation/run_compare.h"

#include <algorithm>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

using nlohmann::json;

constexpr const char* kRunKeys[] = {"images", "stamp", "rows", "frames", "segments", "places"};

bool SameFrames(const json& a, const json& b) {
  return a["stamp"]["data_hash"] == b["stamp"]["data_hash"] &&
         a["frames"]["frame"] == b["frames"]["frame"];
}

// Of the errors of `run` less those of `first` in a row, where both have an answer.
json Paired(const json& run, const json& first, const std::string& row, const std::string& name,
            const BootstrapOptions& bootstrap) {
  const json &ours = run["frames"]["errors"][row], &theirs = first["frames"]["errors"][row];
  const auto distance = run["frames"]["distance_m"].get<std::vector<double>>();
  const std::vector<int> segment = RouteSegments(distance, run["segments"]["metres"].get<double>());
  std::vector<double> differences;
  std::vector<int> block;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i].is_null() || theirs[i].is_null()) continue;
    differences.push_back(ours[i].get<double>() - theirs[i].get<double>());
    block.push_back(segment[i]);
  }
  if (differences.empty()) return nullptr;
  const Interval i = Bootstrap(differences, block, Mean, bootstrap);
  return {{"run", name},
          {"row", row},
          {"frames", differences.size()},
          {"difference", {{"value", i.value}, {"low", i.low}, {"high", i.high}}}};
}

std::string Text(const json& interval) {
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", interval["value"].get<double>(),
                     interval["low"].get<double>(), interval["high"].get<double>());
}

}  // namespace

json ReadRun(const std::filesystem::path& file) {
  const json run = json::parse(ReadFile(file), nullptr, /*allow_exceptions=*/false);
  const bool whole = run.is_object() && std::all_of(std::begin(kRunKeys), std::end(kRunKeys),
                                                    [&](const char* k) { return run.contains(k); });
  Require(whole, file.string(), "is no run", "name the run.json of recollect experiment paper");
  return run;
}

json CompareRuns(const std::vector<json>& runs, const std::vector<std::string>& names,
                 const BootstrapOptions& bootstrap) {
  Require(!runs.empty() && runs.size() == names.size(), "compare", "there are no runs");
  json comparison = {{"runs", json::array()}, {"paired", json::array()}};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const json& run = runs[i];
    json rows = json::array();
    for (const json& row : run["rows"]) {
      const std::string name = row["name"].get<std::string>();
      rows.push_back({{"name", name},
                      {"label", row["label"]},
                      {"mean", row["mean"]},
                      {"median", row["median"]},
                      {"p95", row["p95"]},
                      {"availability", row["availability"]}});
      if (i == 0 || !SameFrames(run, runs[0])) continue;
      if (!runs[0]["frames"]["errors"].contains(name)) continue;
      const json pair = Paired(run, runs[0], name, names[i], bootstrap);
      if (!pair.is_null()) comparison["paired"].push_back(pair);
    }
    comparison["runs"].push_back({{"name", names[i]},
                                  {"images", run["images"]},
                                  {"data_hash", run["stamp"]["data_hash"]},
                                  {"seed", run["stamp"]["seed"]},
                                  {"frames", run["frames"]["frame"].size()},
                                  {"rows", rows},
                                  {"places", run["places"]["systems"]}});
  }
  return comparison;
}

std::string FormatComparison(const json& comparison) {
  std::string text;
  std::vector<std::string> labels;
  for (const json& run : comparison["runs"]) {
    text += fmt::format("{}: {} {} images, data {}, seed {}\n", run["name"].get<std::string>(),
                        run["frames"].get<std::size_t>(), run["images"].get<std::string>(),
                        run["data_hash"].get<std::string>(), run["seed"].get<std::uint64_t>());
    for (const json& row : run["rows"]) {
      const std::string label = row["label"].get<std::string>();
      if (std::find(labels.begin(), labels.end(), label) == labels.end()) labels.push_back(label);
    }
  }
  for (const char* figure : {"mean", "p95"}) {
    text += fmt::format("\nposition error, m, {} with 95 % intervals\n  {:<20}", figure, "");
    for (const json& run : comparison["runs"]) {
      text += fmt::format("{:>28}", run["name"].get<std::string>());
    }
    text += '\n';
    for (const std::string& label : labels) {
      text += fmt::format("  {:<20}", label);
      for (const json& run : comparison["runs"]) {
        const json& rows = run["rows"];
        const auto row = std::find_if(rows.begin(), rows.end(),
                                      [&](const json& one) { return one["label"] == label; });
        text += fmt::format("{:>28}", row == rows.end() ? "-" : Text((*row)[figure]));
      }
      text += '\n';
    }
  }
  if (!comparison["paired"].empty()) {
    text += fmt::format("\nless {}, on the same images, m (negative: better)\n",
                        comparison["runs"][0]["name"].get<std::string>());
  }
  for (const json& pair : comparison["paired"]) {
    text += fmt::format("  {:<28}{:<14}{:>26}   on {} images\n", pair["run"].get<std::string>(),
                        pair["row"].get<std::string>(), Text(pair["difference"]),
                        pair["frames"].get<int>());
  }
  return text;
}

}  // namespace recollect
