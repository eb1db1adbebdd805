#include "recollect/simulation/simulate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <mutex>
#include <numbers>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/random.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/sampling.h"
#include "recollect/simulation/lap_renderer.h"
#include "recollect/simulation/lap_writer.h"

namespace recollect::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

void RequireSane(const SimulateOptions& o) {
  const auto range = [](const char* name, double value, double low, double high) {
    Require(value >= low && value <= high, name, fmt::format("{} is out of range", value),
            fmt::format("take {} to {}", low, high));
  };
  range("spacing", o.spacing, 0.1, 100);
  range("every", o.every, 1, 1000);
  range("baseline", o.baseline, 0.01, 5);
  range("jpeg-quality", o.jpeg_quality, 10, 100);
  range("depth-step", o.depth_step, 1, 2);
  range("rolling-shutter", o.rolling_shutter, 0, 0.2);
  range("change", o.change.strength, 0, 10);
  Require(!o.out.empty(), "out", "no folder given");
}

Route ReadRoute(const SimulateOptions& o) {
  if (o.route == "ring") return RingRoute(o.seed);
  constexpr std::string_view kUfes = "ufes:";
  if (o.route.starts_with(kUfes)) return UfesRoute(o.route.substr(kUfes.size()));
  Require(o.route.ends_with(".tum") || o.route.ends_with(".txt"), "route",
          fmt::format("'{}' is not known", o.route), "take ring, ufes:FOLDER or FILE.tum");
  return TumRoute(o.route);
}

// The poses of a drive that are to be rendered, in order.
std::vector<std::size_t> ChooseFrames(const Drive& drive, const SimulateOptions& o,
                                      const FaultPlan& faults, std::uint64_t seed) {
  Lap lap;
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  for (std::size_t i = 0; i < drive.times.size(); ++i) {
    Frame frame;
    frame.time = drive.times[i];
    frame.world_from_body = drive.world_from_car[i];
    lap.frames.push_back(std::move(frame));
  }
  const std::vector<std::size_t> all = SampleFrames(lap, o.spacing);
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < all.size(); k += static_cast<std::size_t>(o.every)) {
    if (FaultOf(faults, static_cast<std::int64_t>(k), seed) != Fault::kDropped)
      chosen.push_back(all[k]);
  }
  return chosen;
}

std::string UtcText(double unix_time) {
  const auto whole = static_cast<std::time_t>(unix_time);
  std::tm utc{};
  gmtime_r(&whole, &utc);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02} UTC", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min);
}

// Everything that a lap's pictures follow from; two runs that agree in it may share frames.
std::string Describe(const SimulateOptions& o, const Route& route, const Drive& drive,
                     const Day& day, std::size_t frames) {
  const Change& c = o.change;
  return fmt::format(
      "rendered, not recorded: lap {} of the simulated route {}\n"
      "start: {} (unix time {:.6f})\nweather: {}\nsun: {:.1f} degrees above the horizon\n"
      "frames: {}, spacing {} m, every {}\nworld origin: UTM 24S, northing {:.3f}, easting {:.3f}\n"
      "change: strength {}, light {}, structures {}, traffic {}, season {}\n"
      "camera: baseline {}, rolling shutter {} s, JPEG {}, stereo {}, depth {} step {}\n"
      "faults: {}\nseed: {}\nversion: {}\n",
      drive.number, route.name, UtcText(drive.times.front()), drive.times.front(),
      Name(day.weather), std::asin(day.to_sun.z()) / kDegree, frames, o.spacing, o.every,
      route.origin_utm.x(), route.origin_utm.y(), c.strength, c.light, c.structures, c.traffic,
      c.season, o.baseline, o.rolling_shutter, o.jpeg_quality, o.stereo, o.depth, o.depth_step,
      o.faults, o.seed, 3);
}

std::string Readme(const SimulateOptions& o, const Route& route) {
  return fmt::format(
      "# Laps of a simulated campus\n\n"
      "These pictures are rendered, not photographs: a world made up by `recollect simulate` "
      "around the\n"
      "route `{}` (seed {}, change {}).\n\n"
      "In each `lap-NN/`:\n\n"
      "- `image_2/%06d.jpg`: left camera, 640 x 480, no distortion; `image_3/`: right camera, {} m "
      "to the\n"
      "  right, where there is one.\n"
      "- `depth/%06d.png`: true distance along the left camera's z axis in centimetres, 16 bits; "
      "pixel\n"
      "  (i, j) belongs to pixel ({}i, {}j) of the image. 0: sky, or 200 m and more. Moving things "
      "count.\n"
      "- `poses.txt`: left camera to world, 3x4 row-major, one line a frame. Camera axes: x right, "
      "y down,\n"
      "  z forward. World: metres, x north, y west, z up, the same in all laps.\n"
      "- `times.txt`: seconds from the lap's start, one line a frame. `calib.txt`: KITTI's "
      "P0..P3.\n"
      "- `gps.csv`: time,x,y,z,quality of the left camera, with errors; `gps.nmea`: the same as "
      "GGA sentences.\n"
      "- `odometry.csv`: time,speed,steering of the wheels, with errors; m/s and radians.\n"
      "- `lap.txt`: date, weather, sun and the options it was made with; `faults.csv`, where "
      "faults were\n"
      "  asked for: frame,fault.\n",
      route.name, o.seed, o.change.strength, o.baseline, o.depth_step, o.depth_step);
}

// Renders what is missing of one lap and completes it.
class LapJob {
 public:
  LapJob(const SimulateOptions& options, const Route& route, const Drive& drive,
         const FaultPlan& faults)
      : options_(options),
        route_(route),
        drive_(drive),
        faults_(faults),
        fault_seed_(SubSeed(options.seed, 1000 + static_cast<std::uint64_t>(drive.number))),
        day_(MakeDay(drive.times.front(), options.change, options.weather, options.seed)),
        frames_(ChooseFrames(drive, options, faults, fault_seed_)),
        writer_(options.out, fmt::format("lap-{:02}", drive.number),
                Describe(options, route, drive, day_, frames_.size()), options.stereo,
                options.depth) {}

  const Day& day() const { return day_; }
  std::int64_t size() const { return static_cast<std::int64_t>(frames_.size()); }
  std::int64_t Missing() const {
    std::int64_t missing = 0;
    for (std::int64_t i = 0; i < size(); ++i) missing += writer_.Has(i) ? 0 : 1;
    return missing;
  }

  void Run(const Campus& campus, const PictureSet& pictures, ThreadPool& pool,
           const std::function<void()>& on_frame) {
    if (writer_.finished()) return;
    const LapRenderer renderer(campus, pictures, drive_, day_, options_);
    pool.For(size(), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        if (writer_.Has(i)) continue;
        Render(renderer, i);
        on_frame();
      }
    });
    WriteSensors(renderer);
    writer_.Finish();
  }

 private:
  Fault FaultAt(std::int64_t frame) const { return FaultOf(faults_, frame, fault_seed_); }

  void Render(const LapRenderer& renderer, std::int64_t frame) {
    const auto pose = [&](std::int64_t i) { return frames_[static_cast<std::size_t>(i)]; };
    const Fault fault = FaultAt(frame);
    LapRenderer::Shot shot = renderer.Take(pose(frame), fault == Fault::kOverexposed ? 5.0F : 1.0F);
    if (fault == Fault::kFrozen) {
      std::int64_t good = frame;
      while (good > 0 && FaultAt(good) == Fault::kFrozen) --good;
      const LapRenderer::Shot old = renderer.Take(pose(good));
      shot.left = old.left;
      shot.right = old.right;
    }
    const std::uint64_t seed = SubSeed(fault_seed_, static_cast<std::uint64_t>(frame));
    Spoil(fault, seed, shot.left);
    if (!shot.right.empty()) Spoil(fault, seed, shot.right);
    writer_.Write(frame, shot.left, shot.right, shot.depth, options_.jpeg_quality);
  }

  void WriteSensors(const LapRenderer& renderer) {
    std::vector<SE3> poses;
    std::vector<double> times;
    std::vector<Eigen::Vector3d> positions;
    std::string time_text, gga, wheels = "time,speed,steering\n", faults = "frame,fault\n";
    const double start = drive_.times.front();
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      poses.push_back(renderer.WorldFromCamera(frames_[k]));
      positions.push_back(poses.back().translation());
      times.push_back(drive_.times[frames_[k]] - start);
      time_text += fmt::format("{:.6f}\n", times.back());
      faults += fmt::format("{},{}\n", k, Name(FaultAt(static_cast<std::int64_t>(k))));
    }
    const std::vector<GpsFix> fixes = SimulateGps(
        times, positions, [&](const Eigen::Vector3d& p) { return renderer.OpenSky(p); },
        SubSeed(day_.seed, 41));
    for (const GpsFix& fix : fixes)
      gga += GgaSentence(fix, start + fix.time, route_.origin_utm) + "\r\n";
    for (const WheelReading& w : SimulateWheels(drive_, SubSeed(day_.seed, 42))) {
      wheels += fmt::format("{:.4f},{:.4f},{:.5f}\n", w.time - start, w.speed, w.steering);
    }
    writer_.WriteText("gps.csv", GpsTable(fixes));
    writer_.WriteText("gps.nmea", gga);
    writer_.WriteText("odometry.csv", wheels);
    if (!faults_.entries.empty()) writer_.WriteText("faults.csv", faults);
    writer_.WriteText("calib.txt", KittiCalibration(renderer.camera()));
    writer_.WriteText("times.txt", time_text);
    writer_.WriteText("poses.txt", KittiPoses(poses));
  }

  const SimulateOptions& options_;
  const Route& route_;
  const Drive& drive_;
  const FaultPlan& faults_;
  std::uint64_t fault_seed_;
  Day day_;
  std::vector<std::size_t> frames_;
  LapWriter writer_;
};

}  // namespace

std::vector<int> ParseLaps(std::string_view list, int count) {
  std::vector<int> laps;
  if (list == "all") {
    laps.resize(static_cast<std::size_t>(count));
    std::iota(laps.begin(), laps.end(), 1);
    return laps;
  }
  const auto number = [&](std::string_view text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    Require(
        error == std::errc() && end == text.data() + text.size() && value >= 1 && value <= count,
        "laps", fmt::format("'{}' is no lap", text),
        fmt::format("take numbers from 1 to {}, as in 1,3-5", count));
    return value;
  };
  while (true) {
    const std::string_view item = list.substr(0, list.find(','));
    const auto dash = item.find('-');
    const int first = number(item.substr(0, dash));
    const int last = dash == std::string_view::npos ? first : number(item.substr(dash + 1));
    Require(first <= last, "laps", fmt::format("'{}' runs backwards", item));
    for (int lap = first; lap <= last; ++lap) laps.push_back(lap);
    if (item.size() == list.size()) break;
    list.remove_prefix(item.size() + 1);
  }
  std::sort(laps.begin(), laps.end());
  laps.erase(std::unique(laps.begin(), laps.end()), laps.end());
  return laps;
}

SimulateResult Simulate(const SimulateOptions& options, const ProgressSink& progress) {
  RequireSane(options);
  const FaultPlan faults = ParseFaults(options.faults);
  const Route route = ReadRoute(options);
  const int available = route.drives.empty() ? 99 : static_cast<int>(route.drives.size());
  const std::vector<int> numbers = ParseLaps(options.laps, available);
  const Campus campus(route, SubSeed(options.seed, 0xca));

  ThreadPool pool(options.threads);
  AtomicWrite(options.out / "README.md", Readme(options, route));
  if (!route.registration.empty()) {
    std::string text = "# x y z of the car on an earlier, unrendered drive\n";
    for (const auto& p : route.registration)
      text += fmt::format("{:.3f} {:.3f} {:.3f}\n", p.x(), p.y(), p.z());
    AtomicWrite(options.out / "registration.txt", text);
  }

  // The same in every world: painted once in the life of a program.
  static const PictureSet pictures(pool);
  SimulateResult result;
  const Stopwatch watch;
  std::mutex mutex;
  for (const int number : numbers) {
    const Drive drive = route.DriveOf(number, options.seed);
    LapJob job(options, route, drive, faults);
    const std::int64_t missing = job.Missing();
    std::int64_t done = job.size() - missing;
    result.kept += done;
    result.rendered += missing;
    job.Run(campus, pictures, pool, [&] {
      const std::lock_guard lock(mutex);
      Report(progress, fmt::format("lap {:02}", number), ++done, job.size(),
             Name(job.day().weather));
    });
    result.laps.push_back({number, job.size(), Name(job.day().weather),
                           std::asin(static_cast<double>(job.day().to_sun.z())) / kDegree});
  }
  result.seconds = watch.Seconds();
  return result;
}

}  // namespace recollect::simulation
