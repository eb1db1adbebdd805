#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "recollect/evaluation/evaluate.h"

namespace recollect {

// The table a person reads: places, errors of every row with units and availability, latency.
std::string FormatTable(const Evaluation& evaluation);

// The same figures, and which of them: keys places.within_frames.N, places.within_labels.N,
// position_m.ROW.{mean,median,p75,p95,max}, heading_deg.ROW (not for gps), availability.ROW,
// states.STATE, trust.* (where geometry took part), faults.NAME.* (where images were spoilt),
// recollected_within_5m.{share,position_m.ROW}, latency_ms.STEP.{p50,p99}, frames, lap.
nlohmann::json ToFigures(const Evaluation& evaluation);

// One line a frame: true and estimated position, key frames, errors of every row, confidence.
void WriteFramesCsv(const Evaluation& evaluation, const std::filesystem::path& file);

// Two pictures in one PNG: the route in plan with truth, key frames and estimates, and the errors
// along the way. Drawn by gnuplot; throws Error, with what to install, where that is missing.
void PlotEvaluation(const Evaluation& evaluation, const Map& map, const std::filesystem::path& png);

// Poses of the left camera, estimated and true, as estimate.tum, estimate.kitti, truth.tum and
// truth.kitti of a folder.
void WriteTrajectories(const Evaluation& evaluation, const std::filesystem::path& folder);

// All of it into a folder: evaluation.png, table.txt, figures.json, frames.csv, the trajectories
// and, where geometry took part and some answers are not to be relied on, failures.jpg.
void WriteReport(const Evaluation& evaluation, const Map& map, const std::filesystem::path& folder);

}  // namespace recollect
