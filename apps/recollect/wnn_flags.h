#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "recollect/wnn/network.h"
#include "recollect/wnn/sequence.h"

namespace recollect::app {

// The flags of the weightless network's fields, but for the seed (see Common). --wnn names a whole
// configuration; flags for single fields change it, wherever they stand.
inline void AddWnnFlags(CLI::App& command, wnn::NetworkOptions& network) {
  command
      .add_option_function<std::string>(
          "--wnn",
          [&network](const std::string& name) {
            network = name == "vibgl" ? wnn::NetworkOptions{} : wnn::RecollectNetwork();
          },
          "configuration: recollect, or vibgl, the paper's")
      ->check(CLI::IsMember({"recollect", "vibgl"}))
      ->default_str(network.working_width > 0 ? "recollect" : "vibgl")
      ->trigger_on_parse();
  command.add_option("--code", network.code, "what synapses read: colour, gray or opponent")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, wnn::Code>{{"colour", wnn::Code::kColour},
                                           {"gray", wnn::Code::kGray},
                                           {"opponent", wnn::Code::kOpponent}}));
  command.add_option("--cells", network.cells, "what a bit is: compare, gradient or rank")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, wnn::Cells>{{"compare", wnn::Cells::kCompare},
                                            {"gradient", wnn::Cells::kGradient},
                                            {"rank", wnn::Cells::kRank}}));
  command.add_option("--working-width", network.working_width,
                     "scale wider images down to so many pixels first; 0: no");
  command.add_option("--contrast", network.contrast_sigma,
                     "local contrast normalisation over such a surrounding, pixels in a 640 pixels "
                     "wide image; 0: none");
  command.add_option("--gradient-arm", network.gradient_arm,
                     "of gradient cells: pixels (of 640) from the synapse to either end");
  command.add_option("--blur-scales", network.blur_scales, "how many blurred copies");
  command.add_option("--shift-x", network.shift_x,
                     "look at live images displaced by up to so many pixels (of 640) sideways");
  command.add_option("--shift-y", network.shift_y, "and up and down");
  command.add_option("--shift-step", network.shift_step,
                     "pixels from one displacement to the next");
  command.add_option("--closer-step", network.closer_step,
                     "the same of the second, closer look at the best places; 0: none");
  command.add_option("--parts-x", network.parts_x,
                     "columns of parts that may be displaced each in its own way there; 0: none");
  command.add_option("--parts-y", network.parts_y, "and rows");
  command.add_flag("--growth,!--no-growth", network.growth,
                   "tell by them how much larger the scene looks, and so which place is nearest");
  command.add_flag("--blur,!--no-blur", network.blur, "Gaussian synapses read a blurred image");
  command.add_option("--neurons-x", network.neurons_x, "columns of neurons");
  command.add_option("--neurons-y", network.neurons_y, "rows of neurons");
  command.add_option("--gaussian-synapses", network.gaussian_synapses,
                     "of a neuron's 128, how many lie around it");
  command.add_option("--sigma", network.gaussian_sigma,
                     "their spread, pixels in a 640 pixels wide image");
}

// --filter and --sequence.
inline void AddSequenceFlags(CLI::App& command, wnn::SequenceOptions& sequence) {
  command
      .add_option("--filter", sequence.filter,
                  "how images before this one count: none, sabgl or bayes")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, wnn::Filter>{{"none", wnn::Filter::kNone},
                                             {"sabgl", wnn::Filter::kSabgl},
                                             {"bayes", wnn::Filter::kBayes}}))
      ->default_str("none");
  command
      .add_option("--sequence", sequence.history,
                  "images that count, this one among them; 0 (bayes only): all")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
}

}  // namespace recollect::app
