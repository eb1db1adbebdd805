#include "recollect/evaluation/report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "recollect/core/files.h"
#include "recollect/dataset/trajectory_io.h"
#include "recollect/evaluation/failures.h"

namespace recollect {
namespace {

using nlohmann::json;

json ToJson(const Summary& s) {
  return {{"mean", s.mean}, {"median", s.median}, {"p75", s.p75}, {"p95", s.p95}, {"max", s.max}};
}

json ToJson(const std::map<int, double>& shares) {
  json j = json::object();
  for (const auto& [allowed, share] : shares) j[std::to_string(allowed)] = share;
  return j;
}

std::string FormatRow(const std::string& name, const Row& row) {
  const Summary& p = row.position_m;
  std::string line = fmt::format("  {:<22}{:8.3f}{:8.3f}{:8.3f}{:8.3f}{:9.3f}", name, p.mean,
                                 p.median, p.p75, p.p95, p.max);
  line += row.has_heading
              ? fmt::format("{:9.2f}{:8.2f}", row.heading_deg.median, row.heading_deg.p95)
              : fmt::format("{:>9}{:>8}", "-", "-");
  return line + fmt::format("{:8.1f}\n", 100 * row.availability);
}

std::string FormatTrust(const Trust& t) {
  std::string text = "\n  answers in state";
  for (const auto& [name, share] : t.state_shares) {
    text += fmt::format("   {} {:.1f} %", name, 100 * share);
  }
  return text +
         fmt::format(
             "\n  within 0.5 m: {:.1f} % of all images, {:.1f} % of the localised; the worst "
             "localised {:.3f} m\n"
             "  localised within their 95 % ellipsoid: {:.1f} % (pose), {:.1f} % (position)\n"
             "  key frame within 5 m: recollected {:.1f} %, verified {:.1f} %\n",
             100 * t.all_within_half_m, 100 * t.localised_within_half_m, t.localised_max_m,
             100 * t.ellipsoid_pose, 100 * t.ellipsoid_position, 100 * t.place_before,
             100 * t.place_after);
}

std::string FormatFaults(const std::map<std::string, FaultFigures>& faults) {
  std::string text = "\n  fault of the camera     images  localised  the worst of these, m\n";
  for (const auto& [name, f] : faults) {
    text += fmt::format("    {:<20}{:8}{:11}", name, f.frames, f.localised);
    text += f.localised > 0 ? fmt::format("{:24.3f}\n", f.localised_max_m)
                            : "                       -\n";
  }
  return text;
}

}  // namespace

std::string FormatTable(const Evaluation& e) {
  std::string text = fmt::format("{} frames of {}\n", e.frames.size(), e.lap);
  text += "\n  place right within           ";
  for (const auto& [allowed, share] : e.within_frames) text += fmt::format("{:>7}", allowed);
  text += "\n    live frames, % of images   ";
  for (const auto& [allowed, share] : e.within_frames) text += fmt::format("{:7.1f}", 100 * share);
  text += "\n    mapped places, % of images ";
  for (const auto& [allowed, share] : e.within_labels) text += fmt::format("{:7.1f}", 100 * share);
  text += fmt::format("\n\n  {:<22}{:^41}{:^17}{:>8}\n", "", "position error, m", "heading, deg",
                      "frames");
  text += fmt::format("  {:<22}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>8}{:>8}\n", "", "mean", "median",
                      "p75", "p95", "max", "median", "p95", "%");
  for (const Row& row : e.rows) text += FormatRow(row.name, row);
  text += "  where the recollected key frame lies within 5 m of the truth:\n";
  for (const Row& row : e.rows_good_retrieval) text += FormatRow("  " + row.name, row);
  if (e.trust) text += FormatTrust(*e.trust);
  if (!e.faults.empty()) text += FormatFaults(e.faults);
  text += "\n  time an image, ms         p50     p99\n";
  for (const auto& [step, times] : e.latency_ms) {
    text += fmt::format("    {:<18}{:8.1f}{:8.1f}\n", step, times.first, times.second);
  }
  return text;
}

nlohmann::json ToFigures(const Evaluation& e) {
  json figures = {
      {"lap", e.lap},
      {"frames", e.frames.size()},
      {"places",
       {{"within_frames", ToJson(e.within_frames)}, {"within_labels", ToJson(e.within_labels)}}}};
  for (const Row& row : e.rows) {
    figures["position_m"][row.name] = ToJson(row.position_m);
    figures["availability"][row.name] = row.availability;
    if (row.has_heading) figures["heading_deg"][row.name] = ToJson(row.heading_deg);
  }
  for (const Row& row : e.rows_good_retrieval) {
    figures["recollected_within_5m"]["share"] = row.availability;
    figures["recollected_within_5m"]["position_m"][row.name] = ToJson(row.position_m);
  }
  if (e.trust) {
    const Trust& t = *e.trust;
    figures["states"] = t.state_shares;
    figures["trust"] = {{"all_within_half_m", t.all_within_half_m},
                        {"localised_within_half_m", t.localised_within_half_m},
                        {"localised_max_m", t.localised_max_m},
                        {"ellipsoid_pose", t.ellipsoid_pose},
                        {"ellipsoid_position", t.ellipsoid_position},
                        {"place_before", t.place_before},
                        {"place_after", t.place_after}};
  }
  for (const auto& [name, f] : e.faults) {
    figures["faults"][name] = {
        {"frames", f.frames}, {"localised", f.localised}, {"localised_max_m", f.localised_max_m}};
  }
  for (const auto& [step, times] : e.latency_ms) {
    figures["latency_ms"][step] = {{"p50", times.first}, {"p99", times.second}};
  }
  return figures;
}

void WriteFramesCsv(const Evaluation& e, const std::filesystem::path& file) {
  std::string csv =
      "frame,time,true_x,true_y,true_z,x,y,z,key_frame,nearest_key_frame,confidence,"
      "place,state,carried_by,support,spread,position_sigma_m,fault";
  for (const Row& row : e.rows) {
    csv += fmt::format(",{0}_position_m", row.name);
    if (row.has_heading) csv += fmt::format(",{0}_heading_deg", row.name);
  }
  csv += '\n';
  std::vector<std::size_t> next(e.rows.size(), 0);
  for (std::size_t i = 0; i < e.frames.size(); ++i) {
    const LiveFrame& f = e.frames[i];
    const Eigen::Vector3d truth = f.true_world_from_camera.translation();
    const Eigen::Vector3d p = f.answer.world_from_camera.translation();
    csv += fmt::format("{},{:.6f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{:.4f}", f.frame,
                       f.time, truth.x(), truth.y(), truth.z(), p.x(), p.y(), p.z(),
                       f.answer.key_frame, f.nearest_key_frame, f.answer.confidence);
    const Localization& a = f.answer;
    csv += fmt::format(",{},{},{},{},{:.3f},{:.4f},{}", a.place, Name(a.state), Name(a.carried_by),
                       a.support, a.spread,
                       std::sqrt(a.covariance.bottomRightCorner<3, 3>().trace()), f.fault);
    for (std::size_t r = 0; r < e.rows.size(); ++r) {
      const Row& row = e.rows[r];
      const bool answered = next[r] < row.frames.size() && row.frames[next[r]] == i;
      csv += answered ? fmt::format(",{:.4f}", row.errors[next[r]].position_m) : ",";
      if (row.has_heading) {
        csv += answered ? fmt::format(",{:.4f}", row.errors[next[r]].heading_deg) : ",";
      }
      if (answered) ++next[r];
    }
    csv += '\n';
  }
  AtomicWrite(file, csv);
}

void WriteTrajectories(const Evaluation& e, const std::filesystem::path& folder) {
  std::vector<StampedPose> estimates, truths;
  std::vector<SE3> estimated_poses, true_poses;
  for (const LiveFrame& f : e.frames) {
    estimates.push_back({f.time, f.answer.world_from_camera});
    truths.push_back({f.time, f.true_world_from_camera});
    estimated_poses.push_back(f.answer.world_from_camera);
    true_poses.push_back(f.true_world_from_camera);
  }
  WriteTumTrajectory(folder / "estimate.tum", estimates);
  WriteTumTrajectory(folder / "truth.tum", truths);
  WriteKittiPoses(folder / "estimate.kitti", estimated_poses);
  WriteKittiPoses(folder / "truth.kitti", true_poses);
}

void WriteReport(const Evaluation& e, const Map& map, const std::filesystem::path& folder) {
  AtomicWrite(folder / "table.txt", FormatTable(e));
  AtomicWrite(folder / "figures.json", ToFigures(e).dump(2) + "\n");
  WriteFramesCsv(e, folder / "frames.csv");
  WriteTrajectories(e, folder);
  PlotEvaluation(e, map, folder / "evaluation.png");
  WriteFailures(e, map, folder / "failures.jpg");
}

}  // namespace recollect
