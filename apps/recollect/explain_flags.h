#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <string>

namespace recollect::app {

// --explain: a picture an image of who voted for its place.
struct ExplainFlags {
  std::filesystem::path to;  // empty: none

  void AddTo(CLI::App& command) {
    command
        .add_option("--explain", to,
                    "draw what was recollected, the runner-up and which neurons voted for either: "
                    "a .jpg or .png file for one image, a folder for several")
        ->type_name("FILE|DIR");
  }
  // The picture of image `number` of `count`.
  std::filesystem::path FileOf(const std::filesystem::path& image, std::size_t number,
                               std::size_t count) const {
    const std::string kind = to.extension().string();
    if (count == 1 && (kind == ".jpg" || kind == ".jpeg" || kind == ".png")) return to;
    std::filesystem::create_directories(to);
    return to / fmt::format("{:06}-{}.jpg", number, image.stem().string());
  }
};

// --precision: of the places that are told, how many are to be right.
inline CLI::Option* AddPrecisionFlag(CLI::App& command, double& precision) {
  return command
      .add_option("--precision", precision,
                  "of the places told so many are to be right, say the mapped laps: images whose "
                  "place is less sure are answered with 'unknown'")
      ->check(CLI::Range(0.0, 1.0));
}

}  // namespace recollect::app
