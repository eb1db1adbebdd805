#include "recollect/evaluation/drawings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "recollect/core/files.h"
#include "recollect/evaluation/gnuplot.h"

namespace recollect {
namespace {

using nlohmann::json;

constexpr double kLeast = 1e-3;  // metres; a logarithm needs something

// A script for one picture: data first, then what is drawn of them.
class Drawing {
 public:
  void Data(const std::string& name, const std::string& rows) {
    script_ += fmt::format("${} << EOD\n{}EOD\n", name, rows);
  }
  void Say(const std::string& commands) { commands_ += commands + "\n"; }
  void Curve(const std::string& curve) { curves_ += (curves_.empty() ? "" : ", ") + curve; }

  void WriteTo(const std::filesystem::path& svg, int width, int height) const {
    AtomicWrite(svg, [&](const std::filesystem::path& temporary) {
      RunGnuplot(script_ +
                     fmt::format("set terminal svg size {},{} dynamic font 'sans,12' background "
                                 "'#ffffff'\nset output '{}'\nset grid lc rgb '#dddddd'\n"
                                 "set key outside top center horizontal noenhanced\n",
                                 width, height, temporary.string()) +
                     commands_ + "plot " + curves_ + "\n",
                 svg);
    });
  }

 private:
  std::string script_, commands_, curves_;
};

std::string Title(const json& run, const std::string& what) {
  return fmt::format("set title '{} ({} images)' noenhanced", what,
                     run["images"].get<std::string>());
}

void DrawAccuracy(const json& run, const std::filesystem::path& folder) {
  Drawing drawing;
  drawing.Say(Title(run, "Place recognition"));
  drawing.Say("set xlabel 'Maximum Allowed Error'\nset ylabel 'images, %'\nset yrange [0:100]");
  int number = 0;
  for (const json& system : run["places"]["systems"]) {
    for (const auto& [key, reading, dash] : {std::tuple{"within_labels", "mapped places", 1},
                                             std::tuple{"within_frames", "live images", 2}}) {
      std::string rows;
      for (const json& one : system[key]) {
        rows += fmt::format("{} {}\n", one["allowed"].get<int>(), 100 * one["value"].get<double>());
      }
      const std::string name = fmt::format("curve{}", number++);
      drawing.Data(name, rows);
      drawing.Curve(fmt::format("${} with linespoints pt 7 ps 0.6 dt {} title '{}, {}'", name, dash,
                                system["name"].get<std::string>(), reading));
    }
  }
  drawing.WriteTo(folder / "accuracy.svg", 760, 420);
}

void DrawTraining(const json& run, const std::filesystem::path& folder) {
  if (run["training"].is_null() || run["training"]["curve"].empty()) return;
  Drawing drawing;
  std::string train, rows;
  for (const json& p : run["training"]["curve"]) {
    const int step = p["step"].get<int>();
    rows += fmt::format("{} {} {}\n", step, p["loss"].get<double>(),
                        p["valid_position_m"].get<double>());
    if (p["train_position_m"].is_null()) continue;
    train += fmt::format("{} {}\n", step, p["train_position_m"].get<double>());
  }
  drawing.Data("curve", rows);
  drawing.Say(Title(run, "Training"));
  drawing.Say(
      "set xlabel 'iterations'\nset ylabel 'position error, m'\nset y2label 'loss'\n"
      "set ytics nomirror\nset y2tics\nset yrange [0:]\nset y2range [0:]");
  drawing.Curve("$curve using 1:3 with linespoints pt 7 ps 0.5 title 'validation pairs, m'");
  if (!train.empty()) {
    drawing.Data("train", train);
    drawing.Curve("$train with linespoints pt 7 ps 0.5 title 'training pairs, m'");
  }
  drawing.Curve("$curve using 1:2 axes x1y2 with lines dt 2 title 'loss'");
  drawing.WriteTo(folder / "training.svg", 760, 420);
}

void DrawErrors(const json& run, const std::filesystem::path& folder) {
  Drawing drawing;
  std::string rows, names;
  int place = 0;
  for (const json& row : run["rows"]) {
    const json& box = row["box"];
    const auto metres = [&](const char* key) { return std::max(kLeast, box[key].get<double>()); };
    rows +=
        fmt::format("{} {} {} {} {} {} {}\n", place, metres("q1"), metres("low"), metres("high"),
                    metres("q3"), metres("median"), row["mean"]["value"].get<double>());
    names +=
        fmt::format("{}'{}' {}", place == 0 ? "" : ", ", row["label"].get<std::string>(), place);
    ++place;
  }
  drawing.Data("boxes", rows);
  drawing.Say(Title(run, "Position error: median, quartiles, whiskers (1.5 IQR); + mean"));
  drawing.Say(
      fmt::format("set xtics ({}) rotate by -30 noenhanced\nset ylabel 'm'\nset logscale y\n"
                  "set boxwidth 0.5\nset xrange [-0.6:{}]\nunset key",
                  names, place - 0.4));
  drawing.Curve(
      "$boxes using 1:2:3:4:5 with candlesticks whiskerbars lc rgb '#1f77b4', "
      "$boxes using 1:6:6:6:6 with candlesticks lw 2 lc rgb '#1f2933', "
      "$boxes using 1:7 with points pt 1 lc rgb '#d1495b'");
  drawing.WriteTo(folder / "errors.svg", 760, 460);
}

void DrawAlong(const json& run, const std::filesystem::path& folder) {
  Drawing drawing;
  drawing.Say(Title(run, "Position error along the route"));
  drawing.Say("set xlabel 'metres along the route'\nset ylabel 'm'\nset logscale y");
  const json& frames = run["frames"];
  const std::set<std::string> readable = {"gps", "system", "pnp", "fused", "retrieval"};
  for (const json& row : run["rows"]) {
    const std::string name = row["name"].get<std::string>();
    if (!readable.contains(name)) continue;
    std::string rows;
    for (std::size_t i = 0; i < frames["distance_m"].size(); ++i) {
      const json& error = frames["errors"][name][i];
      // An empty line breaks the curve where there is no answer.
      rows += error.is_null() ? "\n"
                              : fmt::format("{} {}\n", frames["distance_m"][i].get<double>(),
                                            std::max(kLeast, error.get<double>()));
    }
    drawing.Data(name, rows);
    drawing.Curve(fmt::format("${} with linespoints pt 7 ps 0.2 title '{}'", name,
                              row["label"].get<std::string>()));
  }
  drawing.WriteTo(folder / "along.svg", 1100, 480);
}

void DrawPlan(const json& run, const std::filesystem::path& folder) {
  Drawing drawing;
  const auto rows = [](const json& points) {
    std::string text;
    for (const json& p : points)
      text += fmt::format("{} {}\n", p[0].get<double>(), p[1].get<double>());
    return text;
  };
  drawing.Data("truth", rows(run["frames"]["truth"]));
  drawing.Data("estimate", rows(run["frames"]["estimate"]));
  drawing.Data("keys", rows(run["keys"]["at"]));
  drawing.Say(Title(run, "The route in plan"));
  drawing.Say(fmt::format("set size ratio -1\nset xlabel '{}, m'\nset ylabel '{}, m'",
                          run["axes"][0].get<std::string>(), run["axes"][1].get<std::string>()));
  drawing.Curve(
      "$keys with points pt 1 ps 0.5 lc rgb '#7d8597' title 'key frames', "
      "$truth with lines lw 1.5 lc rgb '#1f2933' title 'live images', "
      "$estimate with points pt 7 ps 0.3 lc rgb '#d1495b' title 'estimates'");
  drawing.WriteTo(folder / "plan.svg", 900, 800);
}

}  // namespace

void DrawRun(const json& run, const std::filesystem::path& folder) {
  DrawAccuracy(run, folder);
  DrawTraining(run, folder);
  DrawErrors(run, folder);
  DrawAlong(run, folder);
  DrawPlan(run, folder);
}

}  // namespace recollect
