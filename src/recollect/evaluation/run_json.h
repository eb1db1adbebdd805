#pragma once

#include <nlohmann/json.hpp>

#include "recollect/cnn/trainer.h"
#include "recollect/evaluation/bootstrap.h"
#include "recollect/evaluation/evaluate.h"
#include "recollect/evaluation/place_accuracy.h"
#include "recollect/map/map.h"

namespace recollect {

// The parts of a run as JSON: what the report's page shows (web/src/data.ts has the shape),
// `recollect compare` reads, and steps keep. Shares in [0, 1]; intervals are {value, low, high}.

struct RunStatistics {
  double segment_m = 25;  // blocks of the bootstrap
  BootstrapOptions bootstrap;
};

// {name, learnt, live, within_labels, within_frames}: shares of right answers, by error allowed.
nlohmann::json AccuracyJson(const std::string& name, const PlaceTask& task, std::size_t learnt,
                            const std::vector<int>& answers, const RunStatistics& statistics);

// {network, laps, curve, ...} of a model, trained by this run or before.
nlohmann::json TrainingJson(const cnn::ModelInfo& model, const std::vector<cnn::CurvePoint>& curve,
                            bool trained_here);

// rows, good_retrieval, paired, segments, states, trust, latency_ms, frames, keys, axes.
nlohmann::json EvaluationJson(const Evaluation& evaluation, const Map& map,
                              const EvaluationOptions& options, const RunStatistics& statistics);

// The names of rows that a reader knows them by.
std::string LabelOf(const std::string& row);

// The two world axes in which positions extend most, in order: the plan of a world with z up, and
// of one whose axes are a camera's as well.
std::pair<int, int> PlanAxes(const Evaluation& evaluation);

}  // namespace recollect
