#include "recollect/cnn/live_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "recollect/core/files.h"

namespace recollect::cnn {
namespace {

constexpr int kWidth = 720, kHeight = 320, kLeft = 50, kBottom = 30;  // pixels
constexpr std::size_t kRows = 12;                                     // of the table

struct Axes {
  double steps = 1, metres = 0.1;  // at the ends
  double X(double step) const { return kLeft + (kWidth - kLeft - 10) * step / steps; }
  double Y(double m) const { return kHeight - kBottom - (kHeight - kBottom - 10) * m / metres; }
};

std::string Line(const std::vector<CurvePoint>& curve, const Axes& axes, const std::string& colour,
                 double CurvePoint::*field) {
  std::string points;
  for (const CurvePoint& p : curve) {
    if (!std::isfinite(p.*field)) continue;
    points += fmt::format("{:.1f},{:.1f} ", axes.X(static_cast<double>(p.step)), axes.Y(p.*field));
  }
  return fmt::format("<polyline fill='none' stroke='{}' stroke-width='2' points='{}'/>\n", colour,
                     points);
}

std::string Picture(const std::vector<CurvePoint>& curve) {
  Axes axes;
  for (const CurvePoint& p : curve) {
    axes.steps = std::max(axes.steps, static_cast<double>(p.step));
    for (const double m : {p.valid_position_m, p.train_position_m}) {
      if (std::isfinite(m)) axes.metres = std::max(axes.metres, 1.05 * m);
    }
  }
  std::string svg =
      fmt::format("<svg viewBox='0 0 {} {}' width='{}' xmlns='http://www.w3.org/2000/svg'>\n",
                  kWidth, kHeight, kWidth);
  for (int i = 0; i <= 4; ++i) {
    const double m = axes.metres * i / 4, step = axes.steps * i / 4;
    svg += fmt::format(
        "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/>"
        "<text x='{3}' y='{2:.1f}' text-anchor='end'>{4:.2f}</text>"
        "<text x='{5:.1f}' y='{6}' text-anchor='middle'>{7:.0f}</text>\n",
        kLeft, kWidth - 10, axes.Y(m), kLeft - 6, m, axes.X(step), kHeight - 10, step);
  }
  svg += Line(curve, axes, "#999", &CurvePoint::train_position_m);
  svg += Line(curve, axes, "#06c", &CurvePoint::valid_position_m);
  return svg + "</svg>\n";
}

}  // namespace

void WriteLiveCurve(const std::filesystem::path& path, const std::vector<CurvePoint>& curve,
                    const std::string& status, bool running) {
  if (path.empty()) return;
  std::string html = "<!doctype html><meta charset='utf-8'><title>recollect train</title>\n";
  if (running) html += "<meta http-equiv='refresh' content='5'>\n";
  html +=
      "<style>body{font:14px sans-serif;margin:2em}td,th{padding:2px 12px;text-align:right}"
      "text{font-size:11px}</style>\n";
  html += fmt::format("<p>{}</p>\n", status);
  html += Picture(curve);
  html +=
      "<p>Position error in metres over steps: <b style='color:#06c'>validation</b>, "
      "<b style='color:#999'>pairs trained on</b></p>\n<table><tr><th>step<th>seconds<th>rate"
      "<th>loss<th>training, m<th>validation, m<th>heading, deg</tr>\n";
  for (std::size_t i = curve.size() - std::min(kRows, curve.size()); i < curve.size(); ++i) {
    const CurvePoint& p = curve[i];
    html +=
        fmt::format("<tr><td>{}<td>{:.0f}<td>{:.2e}<td>{:.3f}<td>{:.3f}<td>{:.3f}<td>{:.2f}</tr>\n",
                    p.step, p.seconds, p.learning_rate, p.loss, p.train_position_m,
                    p.valid_position_m, p.valid_heading_deg);
  }
  AtomicWrite(path, html + "</table>\n");
}

}  // namespace recollect::cnn
