#include "recollect/evaluation/run_json.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "recollect/evaluation/report.h"

namespace recollect {
namespace {

using nlohmann::json;

constexpr int kLargestAllowed = 10;

// Rows as the paper has them, then geometry's, then what all of them must beat.
constexpr const char* kOrder[] = {"gps",   "oracle_cnn", "system",    "pnp_oracle", "pnp",
                                  "fused", "localised",  "retrieval", "oracle"};

// Which rows are set against which, where both are there.
constexpr std::pair<const char*, const char*> kPairs[] = {
    {"system", "retrieval"}, {"oracle_cnn", "oracle"}, {"system", "gps"}, {"pnp", "retrieval"},
    {"fused", "system"},     {"fused", "pnp"},         {"fused", "gps"},
};

json ToJson(const Interval& i) { return {{"value", i.value}, {"low", i.low}, {"high", i.high}}; }

// Millimetres are enough for pictures, and keep files small.
double Rounded(double value) { return std::round(value * 1e4) / 1e4; }

std::vector<double> PositionErrors(const Row& row) {
  std::vector<double> errors;
  for (const PoseError& error : row.errors) errors.push_back(error.position_m);
  return errors;
}

json RowJson(const Row& row, const std::vector<int>& segment, const RunStatistics& statistics) {
  const std::vector<double> errors = PositionErrors(row);
  std::vector<int> block;
  for (const std::size_t frame : row.frames) block.push_back(segment[frame]);
  const auto interval = [&](const Statistic& statistic) {
    return ToJson(Bootstrap(errors, block, statistic, statistics.bootstrap));
  };
  const Box box = BoxOf(errors);
  json j = {{"name", row.name},
            {"label", LabelOf(row.name)},
            {"frames", row.frames.size()},
            {"availability", row.availability},
            {"mean", interval(Mean)},
            {"median", interval([](const auto& v) { return Quantile(v, 0.5); })},
            {"p95", interval([](const auto& v) { return Quantile(v, 0.95); })},
            {"p75", row.position_m.p75},
            {"max", row.position_m.max},
            {"box",
             {{"low", box.low},
              {"q1", box.q1},
              {"median", box.median},
              {"q3", box.q3},
              {"high", box.high}}}};
  if (row.has_heading) {
    j["heading_deg"] = {{"median", row.heading_deg.median}, {"p95", row.heading_deg.p95}};
  }
  return j;
}

json RowsJson(const std::vector<Row>& rows, const std::vector<int>& segment,
              const RunStatistics& statistics) {
  json j = json::array();
  for (const std::string name : kOrder) {
    for (const Row& row : rows) {
      if (row.name == name && !row.frames.empty()) j.push_back(RowJson(row, segment, statistics));
    }
  }
  return j;
}

json PairedJson(const std::vector<Row>& rows, const std::vector<int>& segment,
                const RunStatistics& statistics) {
  const auto find = [&](const char* name) {
    return std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return row.name == name; });
  };
  json pairs = json::array();
  for (const auto& [name_a, name_b] : kPairs) {
    const auto a = find(name_a), b = find(name_b);
    if (a == rows.end() || b == rows.end()) continue;
    std::map<std::size_t, double> errors_b;
    for (std::size_t i = 0; i < b->frames.size(); ++i) {
      errors_b[b->frames[i]] = b->errors[i].position_m;
    }
    std::vector<double> differences;
    std::vector<int> block;
    for (std::size_t i = 0; i < a->frames.size(); ++i) {
      const auto other = errors_b.find(a->frames[i]);
      if (other == errors_b.end()) continue;
      differences.push_back(a->errors[i].position_m - other->second);
      block.push_back(segment[a->frames[i]]);
    }
    if (differences.empty()) continue;
    pairs.push_back(
        {{"a", name_a},
         {"b", name_b},
         {"frames", differences.size()},
         {"difference", ToJson(Bootstrap(differences, block, Mean, statistics.bootstrap))}});
  }
  return pairs;
}

json FramesJson(const Evaluation& e, const std::vector<double>& distance,
                std::pair<int, int> axes) {
  json frames = {{"distance_m", json::array()}};
  const auto add = [&](const char* column, const json& value) { frames[column].push_back(value); };
  const auto plan = [&](const Eigen::Vector3d& p) {
    return json{Rounded(p[axes.first]), Rounded(p[axes.second])};
  };
  for (std::size_t i = 0; i < e.frames.size(); ++i) {
    const LiveFrame& f = e.frames[i];
    json votes = json::array();
    for (const auto& one : f.answer.votes) votes.push_back({one.label, one.votes});
    add("frame", f.frame);
    add("distance_m", Rounded(distance[i]));
    add("key_frame", f.answer.key_frame);
    add("nearest_key_frame", f.nearest_key_frame);
    add("place", f.answer.place);
    add("confidence", Rounded(f.answer.confidence));
    add("state", Name(f.answer.state));
    add("carried_by", Name(f.answer.carried_by));
    add("support", f.answer.support);
    add("votes", votes);
    add("truth", plan(f.true_world_from_camera.translation()));
    add("estimate", plan(f.answer.world_from_camera.translation()));
  }
  for (const Row& row : e.rows) {
    if (row.frames.empty()) continue;
    json errors = json::array();
    for (std::size_t i = 0; i < e.frames.size(); ++i) errors.push_back(nullptr);
    for (std::size_t i = 0; i < row.frames.size(); ++i) {
      errors[row.frames[i]] = Rounded(row.errors[i].position_m);
    }
    frames["errors"][row.name] = errors;
  }
  return frames;
}

}  // namespace

std::string LabelOf(const std::string& row) {
  static const std::map<std::string, std::string> labels = {{"gps", "GPS"},
                                                            {"oracle_cnn", "GT + CNN (oracle)"},
                                                            {"system", "WNN + CNN"},
                                                            {"pnp_oracle", "GT + PnP (oracle)"},
                                                            {"pnp", "WNN + PnP"},
                                                            {"fused", "fused"},
                                                            {"localised", "marked localised"},
                                                            {"retrieval", "retrieval only"},
                                                            {"oracle", "oracle only"}};
  const auto found = labels.find(row);
  return found == labels.end() ? row : found->second;
}

std::pair<int, int> PlanAxes(const Evaluation& e) {
  Eigen::Vector3d low = e.frames.front().true_world_from_camera.translation(), high = low;
  for (const LiveFrame& f : e.frames) {
    low = low.cwiseMin(f.true_world_from_camera.translation());
    high = high.cwiseMax(f.true_world_from_camera.translation());
  }
  int flat = 0;
  (high - low).minCoeff(&flat);
  return {flat == 0 ? 1 : 0, flat == 2 ? 1 : 2};
}

json AccuracyJson(const std::string& name, const PlaceTask& task, std::size_t learnt,
                  const std::vector<int>& answers, const RunStatistics& statistics) {
  const std::vector<int> segment = RouteSegments(DistanceAlong(task.live_at), statistics.segment_m);
  const auto shares = [&](const std::vector<int>& off) {
    json within = json::array();
    for (int allowed = 0; allowed <= kLargestAllowed; ++allowed) {
      std::vector<double> right;
      for (const int error : off) right.push_back(error <= allowed ? 1 : 0);
      json share = ToJson(Bootstrap(right, segment, Mean, statistics.bootstrap));
      share["allowed"] = allowed;
      within.push_back(share);
    }
    return within;
  };
  return {{"name", name},
          {"learnt", learnt},
          {"live", answers.size()},
          {"within_labels", shares(PlacesOff(answers, task.live.labels))},
          {"within_frames", shares(ImagesOff(answers, task.live.labels))}};
}

json TrainingJson(const cnn::ModelInfo& model, const std::vector<cnn::CurvePoint>& curve,
                  bool trained_here) {
  json points = json::array();
  const auto known = [](double value) { return std::isnan(value) ? json() : json(value); };
  for (const cnn::CurvePoint& p : curve) {
    points.push_back({{"step", p.step},
                      {"loss", p.loss},
                      {"train_position_m", known(p.train_position_m)},
                      {"valid_position_m", p.valid_position_m}});
  }
  return {{"network", cnn::Name(model.network)},
          {"parameters", model.parameters},
          {"laps", model.laps},
          {"steps", model.steps},
          {"seconds", model.seconds},
          {"trained_here", trained_here},
          {"validated_on", model.validated_on},
          {"validation_mean_m", model.validation.position_mean_m},
          {"no_motion_mean_m", model.validation.no_motion_mean_m},
          {"curve", points}};
}

json EvaluationJson(const Evaluation& e, const Map& map, const EvaluationOptions& options,
                    const RunStatistics& statistics) {
  std::vector<Eigen::Vector3d> positions;
  for (const LiveFrame& f : e.frames) positions.push_back(f.true_world_from_camera.translation());
  const std::vector<double> distance = DistanceAlong(positions);
  const std::vector<int> segment = RouteSegments(distance, statistics.segment_m);
  const std::pair<int, int> axes = PlanAxes(e);
  constexpr const char* kAxes[] = {"x", "y", "z"};

  json j = {{"rows", RowsJson(e.rows, segment, statistics)},
            {"good_retrieval",
             {{"within_m", options.good_retrieval_m},
              {"share", e.rows_good_retrieval.front().availability},
              {"rows", RowsJson(e.rows_good_retrieval, segment, statistics)}}},
            {"paired", PairedJson(e.rows, segment, statistics)},
            {"segments",
             {{"metres", statistics.segment_m},
              {"count", segment.back() + 1},
              {"resamples", statistics.bootstrap.resamples}}},
            {"frames", FramesJson(e, distance, axes)},
            {"axes", {kAxes[axes.first], kAxes[axes.second]}}};
  const json figures = ToFigures(e);
  for (const char* key : {"states", "trust", "latency_ms"}) {
    if (figures.contains(key)) j[key] = figures[key];
  }
  for (int key = 0; key < map.size(); ++key) {
    const KeyFrame frame = map.At(key);
    const Eigen::Vector3d at = frame.world_from_camera.translation();
    j["keys"]["at"].push_back({Rounded(at[axes.first]), Rounded(at[axes.second])});
    j["keys"]["lap"].push_back(map.description().laps[frame.lap].name);
    j["keys"]["frame"].push_back(frame.frame);
  }
  return j;
}

}  // namespace recollect
