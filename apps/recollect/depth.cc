#include <fmt/format.h>

#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "command.h"
#include "commands.h"
#include "depth_flags.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/kitti_reader.h"
#include "recollect/dataset/reader.h"
#include "recollect/depth/disparity.h"
#include "recollect/depth/lap_depth.h"
#include "recollect/depth/pair_check.h"

namespace recollect::app {
namespace {

namespace fs = std::filesystem;

struct DepthFlags {
  Common common;
  fs::path left, right, calibration, out, colour, lap;
  std::string method = "sps";
  stereo::MatchOptions options;
};

void Warn(const std::string& warning) {
  if (!warning.empty()) fmt::print(stderr, "recollect: warning: {}\n", warning);
}

void WriteColour(const fs::path& path, const cv::Mat& disparity) {
  AtomicWrite(path, [&](const fs::path& temporary) {
    bool written = false;
    try {
      written =
          cv::imwrite(temporary.string(),
                      stereo::ColourDisparity(disparity, stereo::GreatestDisparity(disparity)));
    } catch (const cv::Exception&) {
      // Refused below.
    }
    Require(written, path.string(), "cannot be written", "give it the ending .png or .jpg");
  });
}

void RunPair(const DepthFlags& flags, ThreadPool& pool) {
  Require(!flags.left.empty() && !flags.right.empty(), "depth", "wants LEFT and RIGHT, or --lap");
  Require(!flags.calibration.empty() && !flags.out.empty(), "depth",
          "of a pair wants --calib and --out");
  const cv::Mat left = ReadColour(flags.left), right = ReadColour(flags.right);
  stereo::RequirePair(left, right, flags.right.string());
  const StereoCamera camera = ReadKittiStereo(flags.calibration, left.cols, left.rows);
  const stereo::PairCheck check = stereo::CheckPair(stereo::ToGray(left), stereo::ToGray(right));
  stereo::RequireLeftIsLeft(check, flags.left.string());
  Warn(stereo::RectificationWarning(check, flags.left.string()));
  stereo::Matcher matcher(flags.options, pool);
  const Stopwatch watch;
  const cv::Mat disparity = matcher.Disparity(left, right);
  const double ms = watch.Milliseconds();
  stereo::WriteDepth(flags.out, stereo::DepthFromDisparity(disparity, camera));
  if (!flags.colour.empty()) WriteColour(flags.colour, disparity);
  const double density = static_cast<double>(cv::countNonZero(disparity >= 0)) /
                         static_cast<double>(disparity.total());
  fmt::print("{}: {:.1f} % of the pixels, {:.0f} ms\n", flags.method, 100 * density, ms);
  WriteFigures(flags.common, {{"method", flags.method},
                              {"density", density},
                              {"ms", ms},
                              {"matches", check.matches},
                              {"vertical_px", check.vertical_px},
                              {"reversed", check.reversed}});
}

void RunLap(const DepthFlags& flags, ThreadPool& pool) {
  Require(flags.left.empty() && flags.calibration.empty() && flags.colour.empty(), "--lap",
          "goes without images, --calib and --colour");
  const Lap lap = ReadLap(flags.lap);
  const fs::path out = flags.out.empty() ? lap.folder / "depth" : flags.out;
  const Stopwatch watch;
  const stereo::LapDepthResult result =
      stereo::WriteLapDepth(lap, out, flags.options, pool, TerminalProgress());
  for (const std::string& warning : result.warnings) Warn(warning);
  fmt::print("{} depth images made in {:.1f} s, {} were there; {} frames without a right image\n",
             result.made, watch.Seconds(), result.kept, result.without_right);
  WriteFigures(flags.common, {{"method", flags.method},
                              {"made", result.made},
                              {"kept", result.kept},
                              {"without_right", result.without_right},
                              {"seconds", watch.Seconds()},
                              {"warnings", result.warnings}});
}

void Run(DepthFlags flags) {
  flags.options.method = stereo::ParseMethod(flags.method);
  flags.options.sps.planes.seed = flags.common.seed;
  ThreadPool pool(flags.common.threads);
  flags.lap.empty() ? RunPair(flags, pool) : RunLap(flags, pool);
}

}  // namespace

void AddStereoFlags(CLI::App& command, stereo::MatchOptions& options) {
  command
      .add_option("--disparities", options.sgm.disparities, "px searched, a multiple of 16 to 256")
      ->capture_default_str();
  command.add_option("--superpixels", options.sps.superpixels, "planes an image, about")
      ->capture_default_str();
}

void AddDepth(CLI::App& app) {
  const auto flags = std::make_shared<DepthFlags>();
  CLI::App* command = AddCommand(app, "depth", "Depth from a stereo pair, or from a lap of them",
                                 flags->common, [flags] { Run(*flags); });
  command->add_option("left", flags->left, "left image of a rectified pair")->type_name("LEFT");
  command->add_option("right", flags->right, "right image")->type_name("RIGHT");
  command
      ->add_option("--calib", flags->calibration, "calibration as KITTI writes it: P0 P1 or P2 P3")
      ->type_name("FILE");
  command->add_option("--lap", flags->lap, "a lap with right images instead")->type_name("DIR");
  command
      ->add_option("--out", flags->out,
                   "depth image: 16-bit PNG, centimetres, 0 unknown; of a lap the folder\n"
                   "of such (default: depth in the lap's)")
      ->type_name("PATH");
  command->add_option("--method", flags->method, "sps, sgm or sgbm")->capture_default_str();
  command->add_option("--colour", flags->colour, "disparity as colours, .png or .jpg")
      ->type_name("FILE");
  AddStereoFlags(*command, flags->options);
}

}  // namespace recollect::app
