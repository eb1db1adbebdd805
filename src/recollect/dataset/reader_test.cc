#include "recollect/dataset/reader.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"
#include "recollect/dataset/test_folder.h"
#include "recollect/dataset/trajectory_io.h"

namespace recollect {
namespace {

TEST(Reader, ReadsAKittiLap) {
  const TestFolder folder;
  folder.MakeKitti();
  const Lap lap = ReadLap(folder.path());
  ASSERT_EQ(lap.frames.size(), 3u);
  EXPECT_EQ(lap.name, folder.path().filename());
  EXPECT_EQ(lap.camera.left, (PinholeCamera{16, 12, 20, 20, 8, 6}));
  EXPECT_DOUBLE_EQ(lap.camera.baseline, 0.5);
  // P2 = K [I | t] with t = (0.1, 0, 0): camera 2 is 0.1 m to the left of camera 0, the body.
  EXPECT_LT((lap.body_from_camera.translation() - Eigen::Vector3d(-0.1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((lap.WorldFromCamera(2).translation() - Eigen::Vector3d(-0.1, 0, 2)).norm(), 1e-15);
  EXPECT_EQ(lap.frames[1].time, 0.5);
  EXPECT_EQ(lap.frames[1].left, folder.path() / "image_2/000001.png");
  EXPECT_EQ(lap.frames[1].right, folder.path() / "image_3/000001.png");
  EXPECT_TRUE(lap.frames[0].right.empty());
  EXPECT_EQ(lap.frames[2].depth, folder.path() / "depth/000002.png");
  ASSERT_EQ(lap.gps.size(), 2u);
  EXPECT_EQ(lap.gps[0].quality, 4);
  EXPECT_EQ(lap.gps[0].p_world, Eigen::Vector3d(0, 0, 0.1));
}

TEST(Reader, ReadsTheLeastOfAKittiLap) {
  const TestFolder folder;
  folder.MakeKitti();
  for (const char* part : {"times.txt", "gps.csv", "depth", "image_3"}) folder.Remove(part);
  std::filesystem::rename(folder.path() / "image_2", folder.path() / "image_0");
  folder.Write("calib.txt", "20 0 8 0 0 20 6 0 0 0 1 0\r\n");  // bare, and only of camera 0
  const Lap lap = ReadLap(folder.path());
  ASSERT_EQ(lap.frames.size(), 3u);
  EXPECT_EQ(lap.camera.baseline, 0);
  EXPECT_EQ(lap.body_from_camera.translation(), Eigen::Vector3d(0, 0, 0));
  EXPECT_DOUBLE_EQ(lap.frames[2].time, 0.2);
  EXPECT_TRUE(lap.frames[0].depth.empty());
}

TEST(Reader, TakesLinesThatEndInCrLf) {
  const TestFolder folder;
  folder.MakeKitti();
  for (const std::string file : {"calib.txt", "poses.txt", "times.txt", "gps.csv"}) {
    std::string text;
    for (const char c : folder.Read(file)) text += c == '\n' ? "\r\n" : std::string(1, c);
    folder.Write(file, text + "\r\n");
  }
  EXPECT_EQ(ReadLap(folder.path()).frames.size(), 3u);
}

TEST(Reader, ReadsATumSequence) {
  const TestFolder folder;
  folder.MakeTum();
  const Lap lap = ReadLap(folder.path());
  ASSERT_EQ(lap.frames.size(), 2u);  // the third image is 0.05 s after the last pose
  EXPECT_EQ(lap.camera.left, (PinholeCamera{16, 12, 20, 20, 8, 6}));
  EXPECT_EQ(lap.frames[0].depth, folder.path() / "depth/1.png");
  EXPECT_TRUE(lap.frames[1].depth.empty());  // 0.04 s away
  EXPECT_NEAR(lap.frames[1].world_from_body.translation().x(), 0.11, 1e-12);
  EXPECT_EQ(lap.depth_unit, 1.0 / 5000);
}

TEST(Reader, KnowsTheDefaultCameraOfTum) {
  const TestFolder folder;
  folder.MakeTum();
  folder.Remove("calibration.txt");
  folder.Remove("depth.txt");
  for (const std::string name : {"rgb/1.png", "rgb/2.png", "rgb/3.png"}) {
    folder.WriteImage(name, 640, 480);
  }
  EXPECT_EQ(ReadLap(folder.path()).camera.left, (PinholeCamera{640, 480, 525, 525, 319.5, 239.5}));
}

TEST(Reader, ReadsUfesLaps) {
  const TestFolder folder;
  folder.MakeUfes();
  const std::vector<Lap> laps = ReadLaps(folder.path());
  ASSERT_EQ(laps.size(), 2u);
  EXPECT_EQ(laps[0].name, "20160825");
  EXPECT_EQ(laps[1].name, "20160825-01");
  EXPECT_EQ(laps[0].camera.left, (PinholeCamera{640, 480, 480, 480, 320, 240}));
  EXPECT_EQ(laps[0].camera.baseline, 0.24);
  EXPECT_EQ(laps[0].frames[1].left, folder.path() / "20160825/b.l.png");
  EXPECT_TRUE(laps[0].frames[1].right.empty());
  EXPECT_TRUE(laps[1].frames[0].left.empty());
  EXPECT_EQ(laps[0].frames[0].time, 100.5);
  EXPECT_NEAR(std::atan2(Heading(laps[0], 0).y(), Heading(laps[0], 0).x()), 1.5, 1e-14);
  ASSERT_EQ(laps[0].gps.size(), 2u);
  EXPECT_EQ(laps[0].gps[1].quality, 0);
  EXPECT_TRUE(laps[1].gps.empty());
}

TEST(Reader, ReadsAFolderOfLapsInOrderOfTheirNames) {
  const TestFolder laps, other;
  other.MakeKitti();
  for (const char* name : {"lap-02", "lap-01"}) {
    std::filesystem::copy(other.path(), laps.path() / name,
                          std::filesystem::copy_options::recursive);
  }
  laps.Write("notes/README.md", "not a lap");
  const std::vector<Lap> read = ReadLaps(laps.path());
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].name, "lap-01");
  EXPECT_EQ(read[1].name, "lap-02");
}

TEST(Reader, ReadsTrajectoriesAsLapsOfPoses) {
  const TestFolder folder;
  const SE3 pose = SE3::FromRotationVector({0, 1, 0}, {1, 2, 3});
  WriteTumTrajectory(folder.path() / "a.tum", {{5, pose}, {6, pose}});
  WriteKittiPoses(folder.path() / "b.txt", {pose, pose, pose});
  EXPECT_EQ(ReadLap(folder.path() / "a.tum").frames[1].time, 6);
  EXPECT_EQ(ReadLap(folder.path() / "a.tum").name, "a");
  EXPECT_EQ(ReadLap(folder.path() / "b.txt").frames.size(), 3u);
}

TEST(Reader, CanBeToldTheFormat) {
  EXPECT_EQ(ParseFormat("ufes"), Format::kUfes);
  const TestFolder folder;
  folder.MakeKitti();
  EXPECT_EQ(ReadLaps(folder.path(), Format::kKitti).size(), 1u);
}

TEST(Reader, ReadsTheTorcsLaps) {
  const std::filesystem::path data = RECOLLECT_SHARED_DATA "/torcs-wheel";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is missing";
  const std::vector<Lap> laps = ReadLaps(data);
  ASSERT_EQ(laps.size(), 4u);
  EXPECT_EQ(laps[3].name, "lap-04");
  EXPECT_EQ(laps[0].frames.size(), 440u);
  EXPECT_EQ(laps[0].camera.left.width, 640);
  EXPECT_NEAR(laps[0].camera.baseline, 0.24, 1e-9);
  EXPECT_FALSE(laps[0].frames[5].right.empty());
  EXPECT_TRUE(laps[0].frames[6].right.empty());
  EXPECT_EQ(laps[0].gps.size(), 418u);
  const cv::Mat depth = ReadDepth(laps[0].frames[7].depth, laps[0].depth_unit);
  EXPECT_EQ(DepthCamera(laps[0].camera.left, depth.cols, depth.rows),
            laps[0].camera.left.Subsampled(2));
  EXPECT_EQ(ReadColour(laps[0].frames[7].left).size(), cv::Size(640, 480));
  EXPECT_EQ(SampleFrames(laps[0], 5).size(), 80u);
}

TEST(Reader, ReadsRealKittiSequences) {
  const std::filesystem::path data = RECOLLECT_SHARED_DATA;
  if (!std::filesystem::exists(data / "kitti-03")) GTEST_SKIP() << data << " is missing";
  const Lap lap = ReadLap(data / "kitti-03");
  EXPECT_EQ(lap.frames.size(), 801u);
  EXPECT_EQ(lap.camera.left.width, 828);
  EXPECT_EQ(lap.camera.baseline, 0);
  const Lap stereo = ReadLap(data / "kitti-stereo");
  EXPECT_EQ(stereo.frames.size(), 24u);
  EXPECT_NEAR(stereo.camera.baseline, 0.537, 0.001);
  EXPECT_FALSE(stereo.frames[0].right.empty());
  EXPECT_DOUBLE_EQ(stereo.frames[10].time, 1);
}

}  // namespace
}  // namespace recollect
