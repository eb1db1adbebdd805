#include "recollect/depth/lap_depth.h"

#include <algorithm>
#include <memory>
#include <mutex>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/dataset/image.h"
#include "recollect/depth/disparity.h"
#include "recollect/depth/pair_check.h"

namespace recollect::stereo {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kChecks = 5;  // pairs, spread over the lap
constexpr const char* kDescription = "depth.txt";

// All that the bits of a depth image depend on.
std::string Describe(const MatchOptions& options, const Lap& lap) {
  const SgmOptions& g = options.sgm;
  const SpsOptions& s = options.sps;
  return fmt::format(
      "recollect depth\nmethod {}\nfx {} baseline {}\nsgm {} {} {} {} {} {}\n"
      "sps {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}\n",
      MethodName(options.method), lap.camera.left.fx, lap.camera.baseline, g.disparities,
      g.small_penalty, g.large_penalty, g.consistency, g.speckle_size, g.speckle_step,
      s.superpixels, s.outer_rounds, s.inner_rounds, s.segments.position, s.segments.disparity,
      s.segments.boundary, s.segments.inlier_px, s.planes.smoothness, s.planes.hinge_penalty,
      s.planes.occlusion_penalty, s.planes.impossible_penalty, s.planes.inlier_px,
      s.planes.start_inlier_px, s.planes.draws, s.planes.seed);
}

void OpenFolder(const fs::path& out, const std::string& description) {
  const fs::path file = out / kDescription;
  if (fs::exists(file)) {
    Require(ReadFile(file) == description, out.string(), "holds depth made with other options",
            "remove it or choose another folder with --out");
    return;
  }
  Require(!fs::exists(out) || fs::is_empty(out), out.string(),
          "holds depth that recollect depth did not make", "choose another folder with --out");
  AtomicWrite(file, description);
}

std::vector<std::string> CheckSome(const Lap& lap, const std::vector<std::size_t>& frames) {
  std::vector<std::string> warnings;
  const std::size_t count = std::min(kChecks, frames.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Frame& frame = lap.frames[frames[i * frames.size() / count]];
    const cv::Mat left = ReadGray(frame.left), right = ReadGray(frame.right);
    RequirePair(left, right, frame.right.string());
    const PairCheck check = CheckPair(left, right);
    RequireLeftIsLeft(check, frame.right.string());
    const std::string warning = RectificationWarning(check, frame.right.string());
    if (!warning.empty()) warnings.push_back(warning);
  }
  return warnings;
}

}  // namespace

LapDepthResult WriteLapDepth(const Lap& lap, const fs::path& out, const MatchOptions& options,
                             ThreadPool& pool, const ProgressSink& progress) {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    if (!lap.frames[i].right.empty()) frames.push_back(i);
  }
  Require(!frames.empty(), lap.folder.string(), "has no right images",
          "they belong in image_3 (colour) or image_1 (gray)");
  Require(lap.camera.baseline > 0, lap.folder.string(), "has no baseline in its calibration");
  LapDepthResult result;
  result.without_right = std::ssize(lap.frames) - std::ssize(frames);
  const auto target = [&](std::size_t i) {
    return out / (lap.frames[i].left.stem().string() + ".png");
  };
  result.warnings = CheckSome(lap, frames);
  OpenFolder(out, Describe(options, lap));
  std::erase_if(frames, [&](std::size_t i) { return fs::exists(target(i)); });
  result.kept = std::ssize(lap.frames) - result.without_right - std::ssize(frames);
  if (frames.empty()) return result;

  // A frame to a thread: matchers with their memory are handed from frame to frame.
  struct Worker {
    ThreadPool alone{1};
    Matcher matcher;
    explicit Worker(const MatchOptions& options) : matcher(options, alone) {}
  };
  std::vector<std::unique_ptr<Worker>> idle;
  std::mutex mutex;
  pool.For(std::ssize(frames), 1, [&](std::int64_t begin, std::int64_t) {
    std::unique_ptr<Worker> worker;
    {
      const std::lock_guard lock(mutex);
      if (!idle.empty()) {
        worker = std::move(idle.back());
        idle.pop_back();
      }
    }
    if (!worker) worker = std::make_unique<Worker>(options);
    const std::size_t i = frames[static_cast<std::size_t>(begin)];
    const cv::Mat left = ReadColour(lap.frames[i].left), right = ReadColour(lap.frames[i].right);
    RequirePair(left, right, lap.frames[i].right.string());
    WriteDepth(target(i), DepthFromDisparity(worker->matcher.Disparity(left, right), lap.camera));
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(worker));
    Report(progress, "depth", ++result.made, std::ssize(frames));
  });
  return result;
}

}  // namespace recollect::stereo
