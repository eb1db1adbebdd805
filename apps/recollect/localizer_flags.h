#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "recollect/localization/localizer.h"

namespace recollect::app {

// The flags that say how poses are found: --map, --model and --relative.
struct LocalizerFlags {
  std::filesystem::path map, model;
  std::string relative = "auto", filter = "bayes";

  void AddTo(CLI::App& command) {
    command.add_option("--map", map, "the map")->required()->type_name("MAP");
    command.add_option("--model", model, "the relative-pose network; not needed for pnp")
        ->type_name("MODEL");
    command
        .add_option("--relative", relative,
                    "who finds the pose at the key frame: cnn, pnp (geometry), fused, or auto:\n"
                    "fused where the map has geometry, else cnn; pnp where there is no model")
        ->check(CLI::IsMember({"auto", "cnn", "pnp", "fused"}))
        ->capture_default_str();
    command
        .add_option(
            "--filter", filter,
            "what geometry makes of the images before in a lap: bayes (a drive, in order),\n"
            "or none (each image by itself, as images without a lap always are)")
        ->check(CLI::IsMember({"none", "bayes"}))
        ->capture_default_str();
  }
  std::optional<cnn::PoseNetwork> Network(int threads) const {
    if (model.empty()) return std::nullopt;
    return cnn::PoseNetwork::Load(model, threads);
  }
  LocalizerOptions Options() const {
    const std::map<std::string, std::optional<Relative>> known = {{"auto", std::nullopt},
                                                                  {"cnn", Relative::kCnn},
                                                                  {"pnp", Relative::kPnp},
                                                                  {"fused", Relative::kFused}};
    LocalizerOptions options;
    options.relative = known.at(relative);
    if (filter == "bayes") options.sequence = wnn::SequenceOptions{.history = 0};
    return options;
  }
};

}  // namespace recollect::app
