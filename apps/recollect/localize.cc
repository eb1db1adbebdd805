#include <fmt/format.h>

#include <Eigen/Geometry>
#include <memory>

#include "command.h"
#include "commands.h"
#include "explain_flags.h"
#include "laps.h"
#include "localizer_flags.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/trajectory_io.h"
#include "recollect/evaluation/explanation.h"
#include "recollect/localization/localizer.h"

namespace recollect::app {
namespace {

struct Options {
  Common common;
  LocalizerFlags localizer;
  std::filesystem::path out, kitti, csv;
  std::vector<std::filesystem::path> images;
  LapFlags laps;
  ExplainFlags explain;
  double precision = 0;  // 0: no image is refused
};

// An image to localise, and the time that its pose is written with.
struct Live {
  std::filesystem::path image;
  double time;
  bool follows;  // on the one before, in the same drive
};

std::vector<Live> Gather(const Options& options) {
  std::vector<Live> live;
  for (const auto& image : options.images)
    live.push_back({image, static_cast<double>(live.size()), false});
  for (const Lap& lap : options.laps.Read()) {
    for (const Frame& frame : lap.frames) {
      Require(!frame.left.empty(), lap.folder.string(), "has no images");
      live.push_back({frame.left, frame.time, &frame != &lap.frames.front()});
    }
  }
  Require(!live.empty(), "localize", "nothing to localise", "name images, or a lap with --lap");
  return live;
}

// Before any work: all images are there and of the map's size.
void CheckImages(const std::vector<Live>& live, const PinholeCamera& camera) {
  for (const Live& one : live) {
    const ImageInfo info = ReadImageInfo(one.image);
    Require(info.width == camera.width && info.height == camera.height, one.image.string(),
            fmt::format("is {}x{}, the map's images are {}x{}", info.width, info.height,
                        camera.width, camera.height),
            "localise with the camera that made the map");
  }
}

nlohmann::json ToFigures(const Live& one, const Localization& answer) {
  const Eigen::Vector3d p = answer.world_from_camera.translation();
  nlohmann::json covariance = nlohmann::json::array();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      covariance.push_back(answer.covariance(row, column));
    }
  }
  nlohmann::json figures = {{"image", one.image.string()},
                            {"position_m", {p.x(), p.y(), p.z()}},
                            {"key_frame", answer.key_frame},
                            {"place", answer.place},
                            {"confidence", answer.confidence},
                            {"state", Name(answer.state)},
                            {"recognised", answer.recognised},
                            {"carried_by", Name(answer.carried_by)},
                            {"support", answer.support},
                            {"spread", answer.spread},
                            {"covariance", covariance},
                            {"ms",
                             {{"recollect", answer.ms.recollect},
                              {"key_frame", answer.ms.key_frame},
                              {"relate", answer.ms.relate},
                              {"features", answer.ms.features},
                              {"verify", answer.ms.verify},
                              {"total", answer.ms.total}}}};
  if (answer.probability) figures["probability"] = *answer.probability;
  if (answer.explanation) figures["recollection"] = ToJson(*answer.explanation);
  return figures;
}

// The picture of who voted for the key frame recollected.
void Explain(const Options& options, const Map& map, const Live& one, std::size_t number,
             std::size_t count, const cv::Mat& image, const Localization& answer) {
  const wnn::Explanation& why = *answer.explanation;
  const auto shown = [&](const wnn::Voters& voters, const std::string& what) {
    if (voters.label < 0) return ExplainedImage{{}, "no " + what};
    return ExplainedImage{map.Image(voters.label), fmt::format("{}: key frame {}, {} votes", what,
                                                               voters.label, voters.votes)};
  };
  std::string caption = one.image.filename().string();
  if (answer.probability) caption += fmt::format(", probability {:.3f}", *answer.probability);
  WriteExplanation(options.explain.FileOf(one.image, number, count),
                   DrawExplanation({image, caption}, shown(why.winner, "recollected"),
                                   shown(why.runner_up, "runner-up"), why,
                                   map.description().network.window_aspect));
}

constexpr const char* kCsvHead =
    "image,time,x,y,z,qx,qy,qz,qw,key_frame,place,confidence,state,carried_by,support,spread,"
    "sigma_x,sigma_y,sigma_z,recognised,probability\n";

// Standard deviations are those of the position in the camera's axes.
std::string ToCsv(const Live& one, const Localization& a) {
  const Eigen::Vector3d p = a.world_from_camera.translation();
  const Eigen::Quaterniond q(a.world_from_camera.rotation());
  const Eigen::Vector3d sigma = a.covariance.diagonal().tail<3>().cwiseSqrt();
  return fmt::format(
      "{},{:.6f},{:.4f},{:.4f},{:.4f},{:.6f},{:.6f},{:.6f},{:.6f},{},{},{:.4f},{},{},{},{:.3f},"
      "{:.4f},{:.4f},{:.4f},{},{}\n",
      one.image.string(), one.time, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), a.key_frame,
      a.place, a.confidence, Name(a.state), Name(a.carried_by), a.support, a.spread, sigma.x(),
      sigma.y(), sigma.z(), a.recognised ? 1 : 0,
      a.probability ? fmt::format("{:.4f}", *a.probability) : "");
}

void Run(const Options& options) {
  const std::vector<Live> live = Gather(options);
  ThreadPool pool(options.common.threads);
  const Map map = Map::Open(options.localizer.map);
  CheckImages(live, map.description().camera.left);
  LocalizerOptions how = options.localizer.Options();
  how.explain = !options.explain.to.empty() || !options.common.json.empty();
  if (options.precision > 0) how.precision = options.precision;
  Localizer localizer(map, options.localizer.Network(options.common.threads), pool, how);
  const ProgressSink progress = TerminalProgress();

  std::vector<StampedPose> stamped;
  std::vector<SE3> poses;
  nlohmann::json figures = nlohmann::json::array();
  std::string csv = kCsvHead;
  for (const Live& one : live) {
    if (!one.follows) localizer.Reset();
    const cv::Mat image = ReadColour(one.image);
    const Localization answer = localizer.Localize(image, one.image.string());
    const bool unknown = !answer.recognised && answer.state == State::kLost;
    if (!unknown) stamped.push_back({one.time, answer.world_from_camera});
    if (!options.explain.to.empty()) {
      Explain(options, map, one, poses.size(), live.size(), image, answer);
    }
    poses.push_back(answer.world_from_camera);
    const Eigen::Vector3d p = answer.world_from_camera.translation();
    if (options.out.empty() && options.kitti.empty() && unknown) {
      fmt::print("{}: unknown (probability {:.3f})\n", one.image.string(), *answer.probability);
    } else if (options.out.empty() && options.kitti.empty()) {
      fmt::print(
          "{}: x {:.3f} y {:.3f} z {:.3f} m, {} ({}, {} features), key frame {}, confidence "
          "{:.2f}, {:.0f} ms\n",
          one.image.string(), p.x(), p.y(), p.z(), Name(answer.state), Name(answer.carried_by),
          answer.support, answer.place, answer.confidence, answer.ms.total);
    }
    figures.push_back(ToFigures(one, answer));
    csv += ToCsv(one, answer);
    Report(progress, "localise", static_cast<std::int64_t>(poses.size()),
           static_cast<std::int64_t>(live.size()));
  }
  if (!options.out.empty()) WriteTumTrajectory(options.out, stamped);
  if (!options.kitti.empty()) WriteKittiPoses(options.kitti, poses);
  if (!options.csv.empty()) AtomicWrite(options.csv, csv);
  WriteFigures(options.common, {{"frames", figures}});
}

}  // namespace

void AddLocalize(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "localize", "Say where images were taken: the left camera in the map's world",
                 options->common, [options] { Run(*options); });
  command->add_option("images", options->images, "images to localise")->type_name("IMAGE");
  options->laps.AddTo(*command, /*required=*/false);
  options->localizer.AddTo(*command);
  options->explain.AddTo(*command);
  AddPrecisionFlag(*command, options->precision);
  command
      ->add_option("--out", options->out,
                   "write the poses here, as a TUM trajectory; unknown ones are left out")
      ->type_name("FILE");
  command
      ->add_option("--csv", options->csv,
                   "write the poses here with state, support and standard deviations")
      ->type_name("FILE");
  command->add_option("--kitti", options->kitti, "write the poses here, as a KITTI trajectory")
      ->type_name("FILE");
}

}  // namespace recollect::app
