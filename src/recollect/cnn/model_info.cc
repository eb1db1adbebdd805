#include "recollect/cnn/model_info.h"

#include <nlohmann/json.hpp>

#include "recollect/core/error.h"

namespace recollect {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PinholeCamera, width, height, fx, fy, cx, cy)

namespace cnn {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Crop, image_width, image_height, left, top, width, height)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PairFigures, pairs, position_mean_m, position_median_m,
                                   heading_mean_deg, heading_median_deg, no_motion_mean_m,
                                   no_motion_median_m, no_motion_heading_mean_deg)

std::string ToJson(const PairFigures& figures) { return nlohmann::json(figures).dump(); }

std::string ToJson(const ModelInfo& info) {
  const auto options =
      info.options.empty() ? nlohmann::json::object() : nlohmann::json::parse(info.options);
  return nlohmann::json{{"network", Name(info.network)},
                        {"crop", info.crop},
                        {"camera", info.camera},
                        {"seed", info.seed},
                        {"laps", info.laps},
                        {"training_pairs", info.training_pairs},
                        {"steps", info.steps},
                        {"seconds", info.seconds},
                        {"parameters", info.parameters},
                        {"validated_on", info.validated_on},
                        {"validation", info.validation},
                        {"options", options}}
      .dump();
}

ModelInfo ModelInfoFromJson(const std::string& json, const std::string& where) {
  try {
    const auto from = nlohmann::json::parse(json);
    ModelInfo info;
    info.network = NetworkKindFromName(from.at("network").get<std::string>());
    from.at("crop").get_to(info.crop);
    from.at("camera").get_to(info.camera);
    from.at("seed").get_to(info.seed);
    from.at("laps").get_to(info.laps);
    from.at("training_pairs").get_to(info.training_pairs);
    from.at("steps").get_to(info.steps);
    from.at("seconds").get_to(info.seconds);
    from.at("parameters").get_to(info.parameters);
    from.at("validated_on").get_to(info.validated_on);
    from.at("validation").get_to(info.validation);
    info.options = from.at("options").dump();
    const Crop& crop = info.crop;
    Require(crop.image_width > 0 && crop.image_height > 0 && crop.width > 0 && crop.height > 0 &&
                crop.left >= 0 && crop.top >= 0 && crop.left <= crop.image_width - crop.width &&
                crop.top <= crop.image_height - crop.height,
            where, "describes a crop that is not inside its image");
    return info;
  } catch (const nlohmann::json::exception& error) {
    throw Error(where, fmt::format("has a broken description ({})", error.what()));
  }
}

}  // namespace cnn
}  // namespace recollect
