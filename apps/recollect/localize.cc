#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "laps.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/trajectory_io.h"
#include "recollect/localization/localizer.h"

namespace recollect::app {
namespace {

struct Options {
  Common common;
  std::filesystem::path map, model, out, kitti;
  std::vector<std::filesystem::path> images;
  LapFlags laps;
};

// An image to localise, and the time that its pose is written with.
struct Live {
  std::filesystem::path image;
  double time;
};

std::vector<Live> Gather(const Options& options) {
  std::vector<Live> live;
  for (const auto& image : options.images)
    live.push_back({image, static_cast<double>(live.size())});
  for (const Lap& lap : options.laps.Read()) {
    for (const Frame& frame : lap.frames) {
      Require(!frame.left.empty(), lap.folder.string(), "has no images");
      live.push_back({frame.left, frame.time});
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

void Run(const Options& options) {
  const std::vector<Live> live = Gather(options);
  ThreadPool pool(options.common.threads);
  const Map map = Map::Open(options.map);
  CheckImages(live, map.description().camera.left);
  Localizer localizer(map, cnn::PoseNetwork::Load(options.model, options.common.threads), pool);
  const ProgressSink progress = TerminalProgress();

  std::vector<StampedPose> stamped;
  std::vector<SE3> poses;
  nlohmann::json figures = nlohmann::json::array();
  for (const Live& one : live) {
    const Localization answer = localizer.Localize(ReadColour(one.image), one.image.string());
    stamped.push_back({one.time, answer.world_from_camera});
    poses.push_back(answer.world_from_camera);
    const Eigen::Vector3d p = answer.world_from_camera.translation();
    if (options.out.empty() && options.kitti.empty()) {
      fmt::print("{}: x {:.3f} y {:.3f} z {:.3f} m, key frame {}, confidence {:.2f}, {:.0f} ms\n",
                 one.image.string(), p.x(), p.y(), p.z(), answer.key_frame, answer.confidence,
                 answer.ms.total);
    }
    figures.push_back({{"image", one.image.string()},
                       {"position_m", {p.x(), p.y(), p.z()}},
                       {"key_frame", answer.key_frame},
                       {"confidence", answer.confidence},
                       {"ms",
                        {{"recollect", answer.ms.recollect},
                         {"key_frame", answer.ms.key_frame},
                         {"relate", answer.ms.relate},
                         {"total", answer.ms.total}}}});
    Report(progress, "localise", static_cast<std::int64_t>(poses.size()),
           static_cast<std::int64_t>(live.size()));
  }
  if (!options.out.empty()) WriteTumTrajectory(options.out, stamped);
  if (!options.kitti.empty()) WriteKittiPoses(options.kitti, poses);
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
  command->add_option("--map", options->map, "the map")->required()->type_name("MAP");
  command->add_option("--model", options->model, "the relative-pose network")
      ->required()
      ->type_name("MODEL");
  command->add_option("--out", options->out, "write the poses here, as a TUM trajectory")
      ->type_name("FILE");
  command->add_option("--kitti", options->kitti, "write the poses here, as a KITTI trajectory")
      ->type_name("FILE");
}

}  // namespace recollect::app
