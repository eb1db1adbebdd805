#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "recollect/core/random.h"
#include "recollect/simulation/noise.h"
#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

cv::Scalar RandomPaint(Random& random, double low, double high) {
  return {random.Uniform(low, high), random.Uniform(low, high), random.Uniform(low, high)};
}

// A drawn 8-bit BGR sheet as a texture; its top row is the one of the highest v.
Texture FromDrawing(const cv::Mat3b& sheet, std::uint32_t seed) {
  return Texture::Paint(sheet.rows, [&](float u, float v) {
    const int x = static_cast<int>(u * static_cast<float>(sheet.cols));
    const int y = sheet.rows - 1 - static_cast<int>(v * static_cast<float>(sheet.rows));
    const cv::Vec3b c = sheet(y, x);
    const Color drawn(static_cast<float>(c[2]), static_cast<float>(c[1]), static_cast<float>(c[0]));
    const float dirt = 0.8F + 0.3F * Fbm(u * 64, v * 64, 64, 4, seed, 0.7F);
    return Texel{(drawn / 255.0F).square() * 0.85F * dirt, 1};
  });
}

void DrawWindow(cv::Mat3b cell, Random& random) {
  const int n = cell.cols;
  const double dark = random.Uniform(15, 60);
  cell.setTo(cv::Scalar(dark * 1.1, dark, dark * 0.95));
  for (int i = 0; i < 5; ++i) {  // furniture and shelves in the dark of the room
    const cv::Point a(static_cast<int>(random.Index(n)),
                      n / 3 + static_cast<int>(random.Index(n / 2)));
    cv::rectangle(cell, a, a + cv::Point(n / 5, n / 3), RandomPaint(random, 10, 100), cv::FILLED);
  }
  const double kind = random.Uniform();
  const cv::Scalar cloth = RandomPaint(random, 110, 230);
  if (kind < 0.3) {  // curtains
    const int left = static_cast<int>(random.Index(n / 2)),
              right = n - static_cast<int>(random.Index(n / 2));
    for (int x = 0; x < n; ++x) {
      if (x > left && x < right) continue;
      cv::line(cell, {x, 0}, {x, n}, cloth * (0.75 + 0.25 * std::sin(x * 1.1)));
    }
  } else if (kind < 0.6) {  // blinds, drawn some way down
    const int low = static_cast<int>(random.Index(n));
    for (int y = 0; y < low; ++y) cv::line(cell, {0, y}, {n, y}, cloth * (y % 4 == 0 ? 0.45 : 0.9));
  } else if (kind < 0.7) {  // lamps on
    cv::rectangle(cell, {n / 8, n / 8}, {n - n / 8, n / 5}, {200, 240, 250}, cv::FILLED);
  } else if (kind < 0.8) {  // papers stuck to the pane
    for (int i = 0; i < 4; ++i) {
      const cv::Point a(static_cast<int>(random.Index(n - 16)),
                        static_cast<int>(random.Index(n - 20)));
      cv::rectangle(cell, a, a + cv::Point(14, 18), RandomPaint(random, 120, 250), cv::FILLED);
    }
  }
}

void DrawSign(cv::Mat3b cell, Random& random) {
  static const std::array<std::string, 16> kNames = {
      "BIBLIOTECA", "REITORIA", "LABORATORIO", "AUDITORIO",     "CENTRO DE ARTES", "ENGENHARIA",
      "CANTINA",    "GINASIO",  "TEATRO",      "FISICA",        "QUIMICA",         "MUSEU",
      "BANCO",      "LIVRARIA", "SECRETARIA",  "ESTACIONAMENTO"};
  static const std::array<int, 3> kFonts = {cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_TRIPLEX,
                                            cv::FONT_HERSHEY_SIMPLEX};
  const bool light = random.Uniform() < 0.5;
  const cv::Scalar ground = light ? RandomPaint(random, 180, 255) : RandomPaint(random, 0, 140);
  const cv::Scalar ink = light ? RandomPaint(random, 0, 110) : RandomPaint(random, 200, 255);
  cell.setTo(ground);
  cv::rectangle(cell, {3, 3}, {cell.cols - 4, cell.rows - 4}, ink, 2);
  const std::string text = kNames[static_cast<std::size_t>(random.Index(16))] + " " +
                           std::to_string(1 + random.Index(99));
  const int font = kFonts[static_cast<std::size_t>(random.Index(3))];
  const cv::Size size = cv::getTextSize(text, font, 1.0, 2, nullptr);
  const double scale = std::min(1.3, (cell.cols - 24.0) / size.width);
  cv::putText(cell, text, {12, cell.rows / 2 + static_cast<int>(10 * scale)}, font, scale, ink, 2);
}

void DrawPoster(cv::Mat3b cell, Random& random) {
  const int n = cell.cols;
  cell.setTo(RandomPaint(random, 60, 255));
  for (int i = 0; i < 26; ++i) {
    const cv::Point p(static_cast<int>(random.Index(n)), static_cast<int>(random.Index(n)));
    const cv::Point q(static_cast<int>(random.Index(n)), static_cast<int>(random.Index(n)));
    const cv::Scalar paint = RandomPaint(random, 0, 255);
    const int size = 6 + static_cast<int>(random.Index(n / 5));
    switch (random.Index(5)) {
      case 0:
        cv::circle(cell, p, size, paint, cv::FILLED);
        break;
      case 1:
        cv::rectangle(cell, p, p + cv::Point(size, 2 * size), paint, cv::FILLED);
        break;
      case 2:
        cv::ellipse(cell, p, {size, size / 2}, random.Uniform(0, 180), 0, 270, paint, 7);
        break;
      case 3:
        cv::line(cell, p, q, paint, 3 + size / 8);
        break;
      default:
        cv::putText(cell, std::string(1, static_cast<char>('A' + random.Index(26))), p,
                    cv::FONT_HERSHEY_TRIPLEX, 0.05 * size, paint, 1 + size / 8);
    }
  }
}

void DrawTrafficSign(cv::Mat3b cell, int index) {
  const int n = cell.cols, m = n / 2;
  const cv::Scalar red(30, 20, 190), white(240, 240, 240), black(20, 20, 20), yellow(20, 190, 240);
  const std::string number = std::to_string(20 + 10 * (index % 5));
  if (index < 5) {  // speed limits
    cell.setTo(red);
    cv::circle(cell, {m, m}, n * 38 / 100, white, cv::FILLED);
    cv::putText(cell, number, {n / 5, n * 64 / 100}, cv::FONT_HERSHEY_DUPLEX, n / 55.0, black, 4);
  } else if (index == 5) {
    cell.setTo(red);
    cv::putText(cell, "PARE", {n / 12, n * 60 / 100}, cv::FONT_HERSHEY_DUPLEX, n / 90.0, white, 4);
  } else if (index < 11) {  // warnings: arrows, crossings, bumps
    cell.setTo(yellow);
    cv::rectangle(cell, {4, 4}, {n - 5, n - 5}, black, 4);
    const int lean = (index - 8) * n / 10;
    cv::arrowedLine(cell, {m - lean, n * 3 / 4}, {m + lean, n / 4}, black, 9, 8, 0, 0.4);
  } else if (index < 14) {  // no parking and the like
    cell.setTo(red);
    cv::circle(cell, {m, m}, n * 37 / 100, white, cv::FILLED);
    cv::putText(cell, index == 12 ? "E" : "P", {n / 3, n * 66 / 100}, cv::FONT_HERSHEY_DUPLEX,
                n / 45.0, black, 6);
    cv::line(cell, {n / 5, n / 5}, {n * 4 / 5, n * 4 / 5}, red, 9);
  } else {  // blue boards
    cell.setTo(cv::Scalar(170, 80, 20));
    cv::putText(cell, index == 14 ? "P" : "H", {n / 4, n * 75 / 100}, cv::FONT_HERSHEY_DUPLEX,
                n / 32.0, white, 8);
  }
}

// Draws every cell of a square sheet with its own random stream.
template <typename Draw>
Texture DrawSheet(int size, int columns, int rows, std::uint32_t seed, const Draw& draw) {
  cv::Mat3b sheet(size, size);
  const int width = size / columns, height = size / rows;
  for (int i = 0; i < columns * rows; ++i) {
    Random random(SubSeed(seed, static_cast<std::uint64_t>(i)));
    draw(sheet(cv::Rect(i % columns * width, i / columns * height, width, height)), random, i);
  }
  return FromDrawing(sheet, seed);
}

}  // namespace

Texture PaintSheet(Picture picture) {
  switch (picture) {
    case Picture::kWindows:
      return DrawSheet(512, kWindowCells, kWindowCells, 301,
                       [](cv::Mat3b cell, Random& random, int) { DrawWindow(cell, random); });
    case Picture::kSigns:
      return DrawSheet(1024, kSignColumns, kSignRows, 302,
                       [](cv::Mat3b cell, Random& random, int) { DrawSign(cell, random); });
    case Picture::kPosters:
      return DrawSheet(1024, kPosterCells, kPosterCells, 303,
                       [](cv::Mat3b cell, Random& random, int) { DrawPoster(cell, random); });
    default:
      return DrawSheet(512, kTrafficCells, kTrafficCells, 304,
                       [](cv::Mat3b cell, Random&, int i) { DrawTrafficSign(cell, i); });
  }
}

}  // namespace recollect::simulation
