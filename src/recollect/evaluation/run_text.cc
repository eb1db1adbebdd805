#include "recollect/evaluation/run_text.h"

#include <nlohmann/json.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

using nlohmann::json;

std::string Interval(const json& j) {
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", j["value"].get<double>(), j["low"].get<double>(),
                     j["high"].get<double>());
}

std::string Share(const json& j) {
  return fmt::format("{:.1f} [{:.1f}, {:.1f}]", 100 * j["value"].get<double>(),
                     100 * j["low"].get<double>(), 100 * j["high"].get<double>());
}

std::string FormatRow(const json& row) {
  const std::string heading =
      row.contains("heading_deg")
          ? fmt::format("{:.2f}", row["heading_deg"]["median"].get<double>())
          : "-";
  return fmt::format("  {:<18}{:>24}{:>24}{:>27}{:>9.3f}{:>9}{:>8.1f}\n",
                     row["label"].get<std::string>(), Interval(row["mean"]),
                     Interval(row["median"]), Interval(row["p95"]), row["max"].get<double>(),
                     heading, 100 * row["availability"].get<double>());
}

std::string FormatLaps(const json& run) {
  std::string text = fmt::format("Laps ({} images)\n  {:<18}{:<20}{:>8}{:>8}{:>8}{:>11}\n",
                                 run["images"].get<std::string>(), "", "", "images", "at 1 m",
                                 "at 5 m", "length, m");
  for (const json& lap : run["dataset"]["laps"]) {
    text += fmt::format("  {:<18}{:<20}{:>8}{:>8}{:>8}{:>11.0f}\n", lap["name"].get<std::string>(),
                        lap["role"].get<std::string>(), lap["frames"].get<int>(),
                        lap["at_1m"].get<int>(), lap["at_5m"].get<int>(),
                        lap["length_m"].get<double>());
  }
  return text;
}

std::string FormatPlaces(const json& run) {
  std::string text = fmt::format(
      "\nPlace right within a Maximum Allowed Error, % of the {} images, 95 % intervals\n"
      "  {:<32}{:>20}{:>20}{:>20}{:>21}\n",
      run["images"].get<std::string>(), "", 0, 1, 3, 10);
  for (const json& system : run["places"]["systems"]) {
    for (const auto& [key, reading] :
         {std::pair{"within_labels", "places"}, std::pair{"within_frames", "live images"}}) {
      text += fmt::format("  {:<32}", system["name"].get<std::string>() + ", " + reading);
      for (const std::size_t allowed : {0u, 1u, 3u, 10u}) {
        text += fmt::format("{:>{}}", Share(system[key].at(allowed)), allowed == 10 ? 21 : 20);
      }
      text += '\n';
    }
  }
  return text;
}

std::string Csv(const json& interval) {
  return fmt::format("{},{},{}", interval["value"].get<double>(), interval["low"].get<double>(),
                     interval["high"].get<double>());
}

}  // namespace

std::string FormatRun(const json& run) {
  const std::string images = run["images"].get<std::string>();
  std::string text = FormatLaps(run) + FormatPlaces(run);
  const std::string head = fmt::format("  {:<18}{:>24}{:>24}{:>27}{:>9}{:>9}{:>8}\n", "", "mean",
                                       "median", "p95", "max", "heading", "images");
  text += fmt::format(
              "\nPosition error, m, {} images, 95 % intervals (heading: median, degrees; "
              "images: % with an answer)\n",
              images) +
          head;
  for (const json& row : run["rows"]) text += FormatRow(row);
  text +=
      fmt::format("where the recollected key frame lies within {} m of the truth ({} images):\n",
                  run["good_retrieval"]["within_m"].get<double>(), images);
  for (const json& row : run["good_retrieval"]["rows"]) text += FormatRow(row);
  text += fmt::format(
      "\nPaired differences of position errors, m, {} images (negative: the first "
      "is better)\n",
      images);
  for (const json& pair : run["paired"]) {
    text += fmt::format("  {:<12}- {:<12}{:>26}   on {} images\n", pair["a"].get<std::string>(),
                        pair["b"].get<std::string>(), Interval(pair["difference"]),
                        pair["frames"].get<int>());
  }
  const json& segments = run["segments"];
  return text + fmt::format("Intervals: bootstrap over {} route segments of {} m, {} resamples.\n",
                            segments["count"].get<int>(), segments["metres"].get<double>(),
                            segments["resamples"].get<int>());
}

void WriteRunCsv(const json& run, const std::filesystem::path& folder) {
  const std::string images = run["images"].get<std::string>();
  std::string csv = "images,lap,part,frames,at_1m,at_5m,length_m\n";
  for (const json& lap : run["dataset"]["laps"]) {
    csv += fmt::format("{},{},\"{}\",{},{},{},{:.1f}\n", images, lap["name"].get<std::string>(),
                       lap["role"].get<std::string>(), lap["frames"].get<int>(),
                       lap["at_1m"].get<int>(), lap["at_5m"].get<int>(),
                       lap["length_m"].get<double>());
  }
  AtomicWrite(folder / "laps.csv", csv);

  csv = "images,learnt,reading,allowed,share,low,high\n";
  for (const json& system : run["places"]["systems"]) {
    for (const char* reading : {"within_labels", "within_frames"}) {
      for (const json& one : system[reading]) {
        csv += fmt::format("{},{},{},{},{}\n", images, system["name"].get<std::string>(), reading,
                           one["allowed"].get<int>(), Csv(one));
      }
    }
  }
  AtomicWrite(folder / "accuracy.csv", csv);

  csv =
      "images,row,frames,availability,mean,mean_low,mean_high,median,median_low,median_high,"
      "p95,p95_low,p95_high,p75,max,whisker_low,q1,q3,whisker_high\n";
  for (const json& row : run["rows"]) {
    const json& box = row["box"];
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", images,
                       row["name"].get<std::string>(), row["frames"].get<int>(),
                       row["availability"].get<double>(), Csv(row["mean"]), Csv(row["median"]),
                       Csv(row["p95"]), row["p75"].get<double>(), row["max"].get<double>(),
                       box["low"].get<double>(), box["q1"].get<double>(), box["q3"].get<double>(),
                       box["high"].get<double>());
  }
  AtomicWrite(folder / "errors.csv", csv);

  csv = "images,first,second,frames,difference,low,high\n";
  for (const json& pair : run["paired"]) {
    csv += fmt::format("{},{},{},{},{}\n", images, pair["a"].get<std::string>(),
                       pair["b"].get<std::string>(), pair["frames"].get<int>(),
                       Csv(pair["difference"]));
  }
  AtomicWrite(folder / "paired.csv", csv);

  if (run["training"].is_null()) return;
  csv = "images,step,loss,train_position_m,valid_position_m\n";
  for (const json& p : run["training"]["curve"]) {
    csv += fmt::format("{},{},{},{},{}\n", images, p["step"].get<int>(), p["loss"].get<double>(),
                       p["train_position_m"].dump(), p["valid_position_m"].get<double>());
  }
  AtomicWrite(folder / "training.csv", csv);
}

}  // namespace recollect
