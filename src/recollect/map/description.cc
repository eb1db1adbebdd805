#include "recollect/map/description.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "recollect/core/error.h"

namespace recollect {
namespace {

using nlohmann::json;

constexpr int kVersion = 2;

constexpr std::array kCodes = {"colour", "gray", "opponent"};   // as wnn::Code counts them
constexpr std::array kCells = {"compare", "gradient", "rank"};  // as wnn::Cells does

template <typename Enum, std::size_t kCount>
Enum FromName(const json& name, const std::array<const char*, kCount>& names) {
  const auto found = std::find(names.begin(), names.end(), name.get<std::string>());
  if (found == names.end()) throw json::other_error::create(501, "unknown name", &name);
  return static_cast<Enum>(found - names.begin());
}

json PoseToJson(const SE3& pose) {
  json rows = json::array();
  const Eigen::Matrix4d m = pose.Matrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) rows.push_back(m(row, column));
  }
  return rows;
}

SE3 PoseFromJson(const json& rows) {
  if (rows.size() != 12) throw json::other_error::create(501, "a pose has 12 numbers", &rows);
  Eigen::Matrix<double, 3, 4> m;
  for (int i = 0; i < 12; ++i) m(i / 4, i % 4) = rows.at(static_cast<std::size_t>(i)).get<double>();
  return {m.leftCols<3>(), m.col(3)};
}

json NetworkToJson(const wnn::NetworkOptions& network) {
  return {{"neurons_x", network.neurons_x},
          {"neurons_y", network.neurons_y},
          {"code", kCodes.at(static_cast<std::size_t>(network.code))},
          {"cells", kCells.at(static_cast<std::size_t>(network.cells))},
          {"working_width", network.working_width},
          {"contrast_sigma", network.contrast_sigma},
          {"gradient_arm", network.gradient_arm},
          {"blur_scales", network.blur_scales},
          {"shift_x", network.shift_x},
          {"shift_y", network.shift_y},
          {"shift_step", network.shift_step},
          {"closer_step", network.closer_step},
          {"parts_x", network.parts_x},
          {"parts_y", network.parts_y},
          {"growth", network.growth},
          {"window_aspect", network.window_aspect},
          {"gaussian_synapses", network.gaussian_synapses},
          {"gaussian_sigma", network.gaussian_sigma},
          {"blur", network.blur},
          {"blur_sigma", network.blur_sigma},
          {"blur_size", network.blur_size},
          {"seed", network.seed}};
}

wnn::NetworkOptions NetworkFromJson(const json& j) {
  wnn::NetworkOptions network;
  j.at("neurons_x").get_to(network.neurons_x);
  j.at("neurons_y").get_to(network.neurons_y);
  network.code = FromName<wnn::Code>(j.at("code"), kCodes);
  network.cells = FromName<wnn::Cells>(j.at("cells"), kCells);
  j.at("working_width").get_to(network.working_width);
  j.at("contrast_sigma").get_to(network.contrast_sigma);
  j.at("gradient_arm").get_to(network.gradient_arm);
  j.at("blur_scales").get_to(network.blur_scales);
  j.at("shift_x").get_to(network.shift_x);
  j.at("shift_y").get_to(network.shift_y);
  j.at("shift_step").get_to(network.shift_step);
  network.closer_step = j.value("closer_step", 0);
  network.parts_x = j.value("parts_x", 0);
  network.parts_y = j.value("parts_y", 0);
  network.growth = j.value("growth", true);
  j.at("window_aspect").get_to(network.window_aspect);
  j.at("gaussian_synapses").get_to(network.gaussian_synapses);
  j.at("gaussian_sigma").get_to(network.gaussian_sigma);
  j.at("blur").get_to(network.blur);
  j.at("blur_sigma").get_to(network.blur_sigma);
  j.at("blur_size").get_to(network.blur_size);
  j.at("seed").get_to(network.seed);
  return network;
}

json VotesToJson(const wnn::VoteModel& votes) {
  return {{"floor", votes.floor}, {"trust", votes.trust}, {"sharpness", votes.sharpness}};
}

json CalibrationToJson(const wnn::Calibration& c) {
  json thresholds = json::array();
  for (const auto& one : c.thresholds) thresholds.push_back({one.precision, one.probability});
  return {{"right", c.right},
          {"here", c.here},
          {"sequence", VotesToJson(c.sequence)},
          {"thresholds", thresholds},
          {"trials", c.trials}};
}

wnn::VoteModel VotesFromJson(const json& j) {
  return {j.at("floor").get<double>(), j.at("trust").get<double>(),
          j.at("sharpness").get<double>()};
}

wnn::Calibration CalibrationFromJson(const json& j) {
  wnn::Calibration c;
  j.at("right").get_to(c.right);
  j.at("here").get_to(c.here);
  c.sequence = VotesFromJson(j.at("sequence"));
  j.at("trials").get_to(c.trials);
  for (const json& one : j.at("thresholds")) {
    c.thresholds.push_back({one.at(0).get<double>(), one.at(1).get<double>()});
  }
  return c;
}

}  // namespace

int MapDescription::KeyFrames() const {
  int sum = 0;
  for (const MapLap& lap : laps) sum += lap.key_frames;
  return sum;
}

std::string ToJson(const MapDescription& d) {
  json laps = json::array();
  for (const MapLap& lap : d.laps) {
    laps.push_back({{"name", lap.name}, {"key_frames", lap.key_frames}});
  }
  const PinholeCamera& c = d.camera.left;
  json description = {{"format", "recollect map"},
                      {"version", kVersion},
                      {"camera",
                       {{"width", c.width},
                        {"height", c.height},
                        {"fx", c.fx},
                        {"fy", c.fy},
                        {"cx", c.cx},
                        {"cy", c.cy},
                        {"baseline_m", d.camera.baseline}}},
                      {"body_from_camera", PoseToJson(d.body_from_camera)},
                      {"world_up", {d.world_up.x(), d.world_up.y(), d.world_up.z()}},
                      {"spacing_m", d.spacing_m},
                      {"wnn", NetworkToJson(d.network)},
                      {"laps", laps}};
  if (d.geometry_inflation > 0) description["geometry_inflation"] = d.geometry_inflation;
  if (d.recognition) description["recognition"] = CalibrationToJson(*d.recognition);
  return description.dump();
}

MapDescription ParseMapDescription(const std::string& text, const std::string& where) {
  try {
    const json j = json::parse(text);
    const int version = j.at("version").get<int>();
    Require(version == kVersion, where,
            fmt::format("is a map of format version {}, this program reads {}", version, kVersion),
            "create the map again");
    MapDescription d;
    const json& camera = j.at("camera");
    PinholeCamera& c = d.camera.left;
    camera.at("width").get_to(c.width);
    camera.at("height").get_to(c.height);
    camera.at("fx").get_to(c.fx);
    camera.at("fy").get_to(c.fy);
    camera.at("cx").get_to(c.cx);
    camera.at("cy").get_to(c.cy);
    camera.at("baseline_m").get_to(d.camera.baseline);
    d.body_from_camera = PoseFromJson(j.at("body_from_camera"));
    const json& up = j.at("world_up");
    for (int i = 0; i < 3; ++i) d.world_up[i] = up.at(static_cast<std::size_t>(i)).get<double>();
    j.at("spacing_m").get_to(d.spacing_m);
    d.network = NetworkFromJson(j.at("wnn"));
    d.geometry_inflation = j.value("geometry_inflation", 0.0);
    // Probabilities were another function of the votes once ("weights"): such a map is one that was
    // never calibrated.
    if (j.contains("recognition") && !j.at("recognition").contains("weights")) {
      d.recognition = CalibrationFromJson(j.at("recognition"));
    }
    for (const json& lap : j.at("laps")) {
      d.laps.push_back({lap.at("name").get<std::string>(), lap.at("key_frames").get<int>()});
    }
    return d;
  } catch (const json::exception& error) {
    throw Error(where, fmt::format("its description cannot be read ({})", error.what()),
                "create the map again");
  }
}

}  // namespace recollect
