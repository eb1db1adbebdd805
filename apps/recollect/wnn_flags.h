#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "recollect/wnn/network.h"

namespace recollect::app {

// The flags of the weightless network's fields, but for the seed (see Common).
inline void AddWnnFlags(CLI::App& command, wnn::NetworkOptions& network) {
  command.add_option("--code", network.code, "what synapses compare: colour or gray")
      ->transform(CLI::CheckedTransformer(std::map<std::string, wnn::Code>{
          {"colour", wnn::Code::kColour}, {"gray", wnn::Code::kGray}}))
      ->default_str("colour");
  command.add_flag("--blur,!--no-blur", network.blur, "Gaussian synapses read a blurred image")
      ->default_str("true");
  command.add_option("--neurons-x", network.neurons_x, "columns of neurons")->capture_default_str();
  command.add_option("--neurons-y", network.neurons_y, "rows of neurons")->capture_default_str();
  command
      .add_option("--gaussian-synapses", network.gaussian_synapses,
                  "of a neuron's 128, how many lie around it")
      ->capture_default_str();
  command
      .add_option("--sigma", network.gaussian_sigma,
                  "their spread, pixels in a 640 pixels wide image")
      ->capture_default_str();
}

}  // namespace recollect::app
