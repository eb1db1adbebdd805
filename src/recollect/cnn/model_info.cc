#include "recollect/cnn/model_info.h"

#include <nlohmann/json.hpp>

#include "recollect/core/error.h"

namespace recollect {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PinholeCamera, width, height, fx, fy, cx, cy)

namespace cnn {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Crop, image_width, image_height, left, top, width, height)

namespace {

std::optional<double> OptionalNumber(const nlohmann::json& from, const char* key) {
  return from.contains(key) ? std::optional(from.at(key).get<double>()) : std::nullopt;
}

std::vector<double> Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d VectorFrom(const nlohmann::json& from) {
  return {from.at(0).get<double>(), from.at(1).get<double>(), from.at(2).get<double>()};
}

// Files of earlier versions have the scale alone.
CovarianceCalibration CalibrationFrom(const nlohmann::json& from) {
  CovarianceCalibration calibration{.scale = from.at("covariance_scale").get<double>()};
  if (from.contains("covariance_agreement")) {
    calibration.usual = VectorFrom(from["covariance_agreement"].at("usual"));
    calibration.weights = VectorFrom(from["covariance_agreement"].at("weights"));
  }
  return calibration;
}

}  // namespace

void to_json(nlohmann::json& to, const PairFigures& f) {
  to = {{"pairs", f.pairs},
        {"position_mean_m", f.position_mean_m},
        {"position_median_m", f.position_median_m},
        {"position_p95_m", f.position_p95_m},
        {"heading_mean_deg", f.heading_mean_deg},
        {"heading_median_deg", f.heading_median_deg},
        {"heading_p95_deg", f.heading_p95_deg},
        {"no_motion_mean_m", f.no_motion_mean_m},
        {"no_motion_median_m", f.no_motion_median_m},
        {"no_motion_heading_mean_deg", f.no_motion_heading_mean_deg}};
  if (f.inside_95) to["inside_95"] = *f.inside_95;
  if (f.position_inside_95) to["position_inside_95"] = *f.position_inside_95;
}

void from_json(const nlohmann::json& from, PairFigures& f) {
  from.at("pairs").get_to(f.pairs);
  from.at("position_mean_m").get_to(f.position_mean_m);
  from.at("position_median_m").get_to(f.position_median_m);
  from.at("heading_mean_deg").get_to(f.heading_mean_deg);
  from.at("heading_median_deg").get_to(f.heading_median_deg);
  from.at("no_motion_mean_m").get_to(f.no_motion_mean_m);
  from.at("no_motion_median_m").get_to(f.no_motion_median_m);
  from.at("no_motion_heading_mean_deg").get_to(f.no_motion_heading_mean_deg);
  // Files of earlier versions have none of these.
  f.position_p95_m = from.value("position_p95_m", 0.0);
  f.heading_p95_deg = from.value("heading_p95_deg", 0.0);
  f.inside_95 = OptionalNumber(from, "inside_95");
  f.position_inside_95 = OptionalNumber(from, "position_inside_95");
}

std::string ToJson(const PairFigures& figures) { return nlohmann::json(figures).dump(); }

std::string ToJson(const ModelInfo& info) {
  const auto options =
      info.options.empty() ? nlohmann::json::object() : nlohmann::json::parse(info.options);
  nlohmann::json json{{"network", Name(info.network)},
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
                      {"options", options}};
  if (info.covariance) {
    json["covariance_scale"] = info.covariance->scale;
    json["covariance_agreement"] = {{"usual", Numbers(info.covariance->usual)},
                                    {"weights", Numbers(info.covariance->weights)}};
  }
  return json.dump();
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
    if (from.contains("covariance_scale")) info.covariance = CalibrationFrom(from);
    Require(!info.covariance || info.covariance->scale > 0, where,
            "has a covariance scale that is not positive");
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
