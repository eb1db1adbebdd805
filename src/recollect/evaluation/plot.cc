#include <fmt/format.h>

#include "recollect/core/files.h"
#include "recollect/evaluation/gnuplot.h"
#include "recollect/evaluation/report.h"
#include "recollect/evaluation/run_json.h"

namespace recollect {

void PlotEvaluation(const Evaluation& e, const Map& map, const std::filesystem::path& png) {
  const auto [x, y] = PlanAxes(e);
  const auto point = [x = x, y = y](const SE3& pose) {
    return fmt::format("{:.4f} {:.4f}", pose.translation()[x], pose.translation()[y]);
  };
  std::string truth, keys, estimates, links;
  for (const LiveFrame& f : e.frames) {
    const double error =
        (f.answer.world_from_camera.translation() - f.true_world_from_camera.translation()).norm();
    truth += point(f.true_world_from_camera) + "\n";
    estimates += fmt::format("{} {:.4f}\n", point(f.answer.world_from_camera), error);
    links += fmt::format("{}\n{}\n\n", point(f.true_world_from_camera),
                         point(f.answer.world_from_camera));
  }
  for (int key = 0; key < map.size(); ++key) keys += point(map.At(key).world_from_camera) + "\n";

  std::string script;
  const auto data = [&](const std::string& name, const std::string& rows) {
    script += fmt::format("${} << EOD\n{}EOD\n", name, rows);
  };
  data("truth", truth);
  data("keys", keys);
  data("estimates", estimates);
  data("links", links);
  std::string curves;
  for (const Row& row : e.rows) {
    std::string rows;
    for (std::size_t i = 0; i < row.frames.size(); ++i) {
      rows += fmt::format("{} {:.4f}\n", row.frames[i], std::max(1e-3, row.errors[i].position_m));
    }
    if (rows.empty()) continue;
    data(row.name, rows);
    curves +=
        fmt::format("{}${} with linespoints pt 7 ps 0.25 title '{} ({:.2f} m mean)' noenhanced",
                    curves.empty() ? "" : ", ", row.name, row.name, row.position_m.mean);
  }
  const char* axis[] = {"x", "y", "z"};
  AtomicWrite(png, [&](const std::filesystem::path& temporary) {
    script += fmt::format(R"(
set terminal pngcairo size 1400,1300 font 'sans,11'
set output '{}'
set multiplot layout 2,1
set grid lc rgb '#dddddd'
set key outside top center horizontal
set title '{}: where the images were taken, and where they are said to be' noenhanced
set size ratio -1
set xlabel '{} [m]'
set ylabel '{} [m]'
set logscale cb
set cbrange [0.1:30]
set cblabel 'error [m]'
set palette defined (0 '#1a9850', 1 '#fee08b', 2 '#d73027')
plot $links with lines lc rgb '#cccccc' title '', $truth with lines lw 2 lc rgb '#333333' title 'truth', $keys with points pt 1 ps 0.8 lc rgb '#4575b4' title 'key frames', $estimates using 1:2:3 with points pt 7 ps 0.6 palette title 'system'
unset colorbox
set size noratio
set title 'position error along the way'
set xlabel 'live image'
set ylabel 'error [m]'
set logscale y
plot {}
unset multiplot
)",
                          temporary.string(), e.lap, axis[x], axis[y], curves);
    RunGnuplot(script, png);
  });
}

}  // namespace recollect
