#include "recollect/map/map.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/map/trials.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/wnn/encoder.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 96, kHeight = 72;

class MapTest : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.spacing_m = 5;
    options_.network.neurons_x = 12;
    options_.network.neurons_y = 7;
  }

  // A straight drive of `frames` images of noise, 5 m apart, as JPEG or PNG files.
  Lap MakeLap(const std::string& name, int frames, const std::string& extension = ".jpg") const {
    Lap lap;
    lap.name = name;
    lap.folder = folder_ / name;
    lap.camera = {{kWidth, kHeight, 70, 70, 47.5, 35.5}, 0.24};
    fs::create_directories(lap.folder);
    cv::RNG random(std::hash<std::string>{}(name));
    for (int i = 0; i < frames; ++i) {
      cv::Mat image(kHeight, kWidth, CV_8UC3);
      random.fill(image, cv::RNG::UNIFORM, 0, 256);
      const fs::path file = lap.folder / (std::to_string(i) + extension);
      cv::imwrite(file.string(), image);
      Frame frame;
      frame.time = 0.5 * i;
      frame.world_from_body =
          SE3::FromRotationVector({0, 0.001 * i, 0}, Eigen::Vector3d(0, 0.25, 5.0 * i));
      frame.left = file;
      lap.frames.push_back(frame);
    }
    return lap;
  }

  // What the network makes of a stored image file.
  std::vector<std::uint64_t> PatternOf(const fs::path& file) {
    wnn::Encoder encoder(options_.network, kWidth, kHeight, pool_);
    const cv::Mat image = cv::imread(file.string());
    return encoder.Encode(
        {image.data, image.cols, image.rows, 3, static_cast<std::ptrdiff_t>(image.step)});
  }

  void ExpectHolds(const Map& map, const std::vector<Lap>& laps) {
    int key = 0;
    for (std::size_t l = 0; l < laps.size(); ++l) {
      for (std::size_t f = 0; f < laps[l].frames.size(); ++f, ++key) {
        ASSERT_LT(key, map.size());
        const KeyFrame key_frame = map.At(key);
        EXPECT_EQ(key_frame.lap, l);
        EXPECT_EQ(key_frame.frame, f);
        EXPECT_EQ(key_frame.time, laps[l].frames[f].time);
        EXPECT_EQ(key_frame.world_from_camera.Matrix(), laps[l].WorldFromCamera(f).Matrix());
        EXPECT_EQ(map.memory().Pattern(key), PatternOf(laps[l].frames[f].left)) << key;
      }
    }
    EXPECT_EQ(key, map.size());
  }

  testing::ScratchFolder folder_;
  MapOptions options_;
  ThreadPool pool_{2};
};

TEST_F(MapTest, GivesBackWhatWasMapped) {
  const std::vector<Lap> laps = {MakeLap("one", 70), MakeLap("two", 5)};
  CreateMap(folder_ / "m.map", laps, options_, pool_);
  const Map map = Map::Open(folder_ / "m.map");
  ExpectHolds(map, laps);
  EXPECT_EQ(map.description().laps[1].name, "two");
  EXPECT_EQ(map.description().camera.left, laps[0].camera.left);
  EXPECT_EQ(map.description().network.neurons(), 84);
  // JPEG files are kept as they are, to the bit.
  const cv::Mat stored = map.Image(71), original = cv::imread(laps[1].frames[1].left.string());
  EXPECT_EQ(cv::norm(stored, original, cv::NORM_INF), 0);
  EXPECT_THROW(map.At(75), Error);
  EXPECT_THROW(map.Image(-1), Error);
}

TEST_F(MapTest, KeepsOtherImagesCloseToTheOriginal) {
  const Lap lap = MakeLap("png", 2, ".png");
  CreateMap(folder_ / "m.map", std::span(&lap, 1), options_, pool_);
  const Map map = Map::Open(folder_ / "m.map");
  EXPECT_EQ(map.Image(1).size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(map.memory().Pattern(1), PatternOf(lap.frames[1].left));
}

TEST_F(MapTest, SamplesKeyFramesAtTheSpacing) {
  const Lap lap = MakeLap("one", 21);
  options_.spacing_m = 20;
  CreateMap(folder_ / "m.map", std::span(&lap, 1), options_, pool_);
  const Map map = Map::Open(folder_ / "m.map");
  ASSERT_EQ(map.size(), 6);
  EXPECT_EQ(map.At(1).frame, 4u);
}

// Appending in any steps, across full and partly filled blocks, ends in the map made at once.
TEST_F(MapTest, GrowsByAppending) {
  const std::vector<Lap> laps = {MakeLap("one", 60), MakeLap("two", 3), MakeLap("three", 1),
                                 MakeLap("four", 70)};
  CreateMap(folder_ / "m.map", std::span(laps).first(1), options_, pool_);
  const Map before = Map::Open(folder_ / "m.map");
  AddToMap(folder_ / "m.map", std::span(laps).subspan(1, 2), pool_);
  AddToMap(folder_ / "m.map", std::span(laps).subspan(3), pool_);
  ExpectHolds(Map::Open(folder_ / "m.map"), laps);
  ExpectHolds(before, {laps[0]});  // an open reader keeps its own state
}

// What was in the file stays where it was: appending costs the same in a map of any size.
TEST_F(MapTest, AppendingDoesNotRewriteTheRest) {
  const fs::path file = folder_ / "m.map";
  const std::vector<Lap> first = {MakeLap("one", 200)}, second = {MakeLap("two", 3)};
  CreateMap(file, first, options_, pool_);
  const std::string before = ReadFile(file);
  AddToMap(file, second, pool_);
  const std::string after = ReadFile(file);
  ASSERT_GE(after.size(), before.size());
  constexpr std::size_t kPage = 4096;
  std::size_t changed = 0;
  for (std::size_t at = 0; at < before.size(); at += kPage) {
    changed += before.compare(at, kPage, after, at, kPage) != 0;
  }
  EXPECT_LT(static_cast<double>(changed), 0.1 * static_cast<double>(before.size()) / kPage);
}

TEST_F(MapTest, KeepsGeometryBesideItsKeyFramesWhereThereIsSome) {
  const fs::path plain = folder_ / "plain.map", shaped = folder_ / "shaped.map";
  const std::vector<Lap> first = {MakeLap("a", 20)}, second = {MakeLap("b", 3)};
  const GeometrySource source = [](const Lap& lap, std::size_t frame) {
    return std::vector<std::byte>(frame + 1, static_cast<std::byte>(lap.name[0]));
  };
  CreateMap(plain, first, options_, pool_);
  AddToMap(plain, second, pool_, {}, source);  // a map without geometry stays one
  EXPECT_FALSE(Map::Open(plain).HasGeometry());
  EXPECT_FALSE(Map::Open(plain).Geometry(0));

  options_.geometry = source;
  CreateMap(shaped, first, options_, pool_);
  EXPECT_THROW(AddToMap(shaped, second, pool_), Error);
  EXPECT_EQ(Map::Open(shaped).size(), 20);
  AddToMap(shaped, second, pool_, {}, source);
  SetGeometryInflation(shaped, 1.5);
  const Map map = Map::Open(shaped);
  ASSERT_EQ(map.size(), 23);
  EXPECT_TRUE(map.HasGeometry());
  EXPECT_EQ(map.description().geometry_inflation, 1.5);
  for (const int key : {0, 15, 16, 19}) {
    EXPECT_EQ(map.Geometry(key)->size(), static_cast<std::size_t>(key + 1));
    EXPECT_EQ(map.Geometry(key)->front(), std::byte{'a'});
  }
  EXPECT_EQ(map.Geometry(22)->size(), 3u);
  EXPECT_EQ(map.Geometry(22)->front(), std::byte{'b'});
}

TEST_F(MapTest, RefusesBadLapsAndLeavesTheMapAlone) {
  const std::vector<Lap> laps = {MakeLap("one", 3)};
  const fs::path file = folder_ / "m.map";
  CreateMap(file, laps, options_, pool_);
  const std::string before = ReadFile(file);

  EXPECT_THROW(AddToMap(file, laps, pool_), Error);  // the same name again
  std::vector<Lap> other = {MakeLap("two", 3)};
  other[0].camera.left.width = 640;
  EXPECT_THROW(AddToMap(file, other, pool_), Error);
  other = {MakeLap("three", 3)};
  other[0].frames[2].left = folder_ / "missing.jpg";
  EXPECT_THROW(AddToMap(file, other, pool_), Error);  // found half way through
  other[0].frames[2].left.clear();
  EXPECT_THROW(AddToMap(file, other, pool_), Error);
  EXPECT_THROW(CreateMap(file, other, options_, pool_), Error);
  EXPECT_THROW(CreateMap(file, {}, options_, pool_), Error);
  try {
    CreateMap("/proc/new.map", laps, options_, pool_);
    FAIL() << "a map in /proc";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("/proc/new.map: "), 0u) << error.what();
  }
  ExpectHolds(Map::Open(file), laps);
  EXPECT_EQ(ReadFile(file), before);
}

// A process killed while it makes a map leaves the old one, or none, under the map's name.
TEST_F(MapTest, IsNeverSeenHalfWritten) {
  const std::vector<Lap> old = {MakeLap("old", 2)}, fresh = {MakeLap("new", 1100)};
  const fs::path file = folder_ / "m.map";
  CreateMap(file, old, options_, pool_);
  const pid_t child = fork();
  if (child == 0) {
    ThreadPool pool(1);
    CreateMap(file, fresh, options_, pool, [](const Progress& p) {
      if (p.done == 1090) _exit(7);  // after a commit of the blocks before it
    });
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(WEXITSTATUS(status), 7);
  ExpectHolds(Map::Open(file), old);
}

TEST_F(MapTest, TellsForeignAndDamagedFiles) {
  const std::vector<Lap> laps = {MakeLap("one", 70)};
  const fs::path file = folder_ / "m.map";
  CreateMap(file, laps, options_, pool_);
  const auto message = [](const fs::path& path) -> std::string {
    try {
      Map::Open(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "opened";
  };
  EXPECT_EQ(message(file), "opened");
  EXPECT_NE(message(folder_ / "none.map").find("no such map"), std::string::npos);
  EXPECT_NE(message(folder_.path()).find("is no file"), std::string::npos);

  AtomicWrite(folder_ / "empty.map", "");
  EXPECT_NE(message(folder_ / "empty.map").find("is empty"), std::string::npos);
  AtomicWrite(folder_ / "text.map", std::string(100000, 'x'));
  EXPECT_NE(message(folder_ / "text.map").find("not a whole Recollect map"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "text.map-lock"));
  const std::string whole = ReadFile(file);
  AtomicWrite(folder_ / "short.map", whole.substr(0, whole.size() / 2));
  EXPECT_NE(message(folder_ / "short.map").find("cut short"), std::string::npos);

  StoreWriter writer(file, false);
  writer.Put("description", std::as_bytes(std::span("{\"version\": 99}", 15)));
  writer.Commit();
  EXPECT_NE(message(file).find("format version 99"), std::string::npos);
  writer.Put("description", std::as_bytes(std::span("{", 1)));
  writer.Commit();
  EXPECT_NE(message(file).find("description cannot be read"), std::string::npos);
}

TEST_F(MapTest, TellsMissingBlocksAndRecords) {
  const std::vector<Lap> laps = {MakeLap("one", 70)};
  const fs::path file = folder_ / "m.map";
  CreateMap(file, laps, options_, pool_);
  StoreWriter writer(file, false);
  const std::vector<std::byte> junk(100);
  writer.Put(Table::kKeyFrames, 3, junk);
  writer.Commit();
  const Map map = Map::Open(file);
  EXPECT_THROW(map.At(3), Error);
  EXPECT_NO_THROW(map.At(2));
  writer.Put(Table::kPatterns, 1, junk);
  writer.Commit();
  EXPECT_THROW(Map::Open(file), Error);
}

TEST_F(MapTest, KeepsHowSureItsAnswersAre) {
  const fs::path file = folder_ / "m.map";
  const std::vector<Lap> laps = {MakeLap("a", 12)};
  CreateMap(file, laps, options_, pool_);
  EXPECT_FALSE(Map::Open(file).description().recognition);
  CalibrateRecognition(file, pool_);
  const auto kept = Map::Open(file).description().recognition;
  ASSERT_TRUE(kept);
  EXPECT_GE(kept->trials, 12);
  EXPECT_FALSE(kept->thresholds.empty());
  ExpectHolds(Map::Open(file), laps);

  // Another map is as sure as that is, no more.
  const std::vector<Lap> more = {MakeLap("b", 2)};
  AddToMap(file, more, pool_);
  EXPECT_FALSE(Map::Open(file).description().recognition);

  // What is written comes back as it was.
  wnn::Calibration some;
  some.sequence = {0.02, 0.5, 0.25};
  some.right = {1, 0.75, 2};
  some.here = {-3, 4, 5};
  some.thresholds = {{0.9, 0.4}, {0.99, 0.8}};
  some.trials = 7;
  SetRecognition(file, some);
  const auto back = Map::Open(file).description().recognition;
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sequence.trust, 0.5);
  EXPECT_EQ(back->right, some.right);
  EXPECT_EQ(back->here, some.here);
  EXPECT_EQ(back->trials, 7);
  EXPECT_EQ(wnn::ThresholdFor(*back, 0.95), 0.8);

  // Maps once said "weights", of other features.
  std::string old = ToJson(Map::Open(file).description());
  old.replace(old.find("\"right\""), 7, "\"weights\"");
  EXPECT_FALSE(ParseMapDescription(old, "old").recognition);
}

TEST_F(MapTest, TooSmallAMapIsNotCalibrated) {
  const fs::path file = folder_ / "m.map";
  const std::vector<Lap> laps = {MakeLap("a", 2)};
  CreateMap(file, laps, options_, pool_);
  EXPECT_THROW(CalibrateRecognition(file, pool_), Error);
  EXPECT_FALSE(Map::Open(file).description().recognition);
}

// A lap twice around a circle of 24 key frames and six further, and back the other way.
TEST(RouteOf, PassesOfOneLapLieBesideEachOther) {
  std::vector<KeyFrame> frames;
  const auto add = [&](int step, bool back) {
    const double angle = 2 * M_PI * step / 24;
    const Eigen::Vector3d at(19.1 * std::cos(angle), 19.1 * std::sin(angle), 0);
    const Eigen::Vector3d ahead =
        (back ? -1 : 1) * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0);
    Eigen::Matrix3d axes;
    axes << ahead.cross(Eigen::Vector3d::UnitZ()), -Eigen::Vector3d::UnitZ(), ahead;
    frames.push_back({SE3(axes, at), 0, 0, static_cast<std::uint32_t>(frames.size())});
  };
  for (int step = 0; step < 54; ++step) add(step, false);
  for (int step = 53; step > 44; --step) add(step, true);
  const wnn::Route route = RouteOf(frames, 5);
  EXPECT_EQ(route.beside[2], (std::vector<int>{26, 50}));
  EXPECT_EQ(route.beside[26], (std::vector<int>{2, 50}));
  EXPECT_EQ(route.beside[10], std::vector<int>{34});
  EXPECT_TRUE(route.WithinOne(3, 50));
  EXPECT_TRUE(route.beside[58].empty());
  // Passes the other way see another scene.
  ASSERT_EQ(route.along[2].size(), 15u);
  for (const auto& [place, places] : route.along[2]) {
    ASSERT_LT(place, 54);
    EXPECT_NEAR(places, (place + 10) % 24 - 12, 0.2) << place;
  }
}

}  // namespace
}  // namespace recollect
