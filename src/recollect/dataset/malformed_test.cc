// What each kind of broken data set is refused with: one line, naming file and line.
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/dataset/reader.h"
#include "recollect/dataset/test_folder.h"

namespace recollect {
namespace {

using Break = std::function<void(const TestFolder&)>;

struct Case {
  std::string name;
  std::string layout;  // of the sound data set: kitti, tum, ufes, or none for an empty folder
  Break break_it;
  std::string error;      // the message, with DIR for the folder
  std::string read = "";  // what is read within the folder
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

// The breaks that most cases are made of.
Break Write(const std::string& file, const std::string& content) {
  return [=](const TestFolder& folder) { folder.Write(file, content); };
}
Break Replace(const std::string& file, const std::string& old, const std::string& now) {
  return [=](const TestFolder& folder) { folder.Replace(file, old, now); };
}
Break Remove(const std::string& file) {
  return [=](const TestFolder& folder) { folder.Remove(file); };
}
Break Image(const std::string& file, int width, int height, int type = CV_8UC3) {
  return [=](const TestFolder& folder) { folder.WriteImage(file, width, height, type); };
}
Break Cut(const std::string& file, std::size_t length) {
  return [=](const TestFolder& folder) { folder.Write(file, folder.Read(file).substr(0, length)); };
}

const std::string kTumColumns = "(time tx ty tz qx qy qz qw)";
const std::string kPoseColumns = "(x y z rx ry rz timestamp left_image right_image)";

std::vector<Case> Cases() {
  return {
      // Folders.
      {"MissingFolder", "", [](const TestFolder&) {}, "DIR/nowhere: no such folder", "nowhere"},
      {"EmptyFolder", "", [](const TestFolder&) {},
       "DIR: holds no lap that can be recognised; a lap has calib.txt and poses.txt (KITTI), "
       "rgb.txt "
       "and groundtruth.txt (TUM), or camera3.txt and camerapos-*.txt (UFES-LAPS)"},
      {"FileInsteadOfFolder", "", Write("notes.txt", "hello\n"),
       "DIR/notes.txt: is neither a folder nor a trajectory; trajectories have 8 numbers a row "
       "(TUM) "
       "or 12 (KITTI)",
       "notes.txt"},
      {"SeveralLapsWhereOneIsWanted", "ufes", [](const TestFolder&) {},
       "DIR: holds 2 laps where one is wanted; name one of them"},
      {"LapWithinABrokenLap", "",
       [](const TestFolder& folder) { folder.Write("lap-01/poses.txt", ""); },
       "DIR/lap-01: has no images; the left ones belong in image_2 (colour) or image_0 (gray)"},

      // KITTI: calib.txt.
      {"NoCalibration", "kitti", Remove("calib.txt"), "DIR/calib.txt: no such file"},
      {"CalibrationIsAFolder", "kitti",
       [](const TestFolder& folder) {
         folder.Remove("calib.txt");
         folder.Write("calib.txt/a", "");
       },
       "DIR/calib.txt: is a folder where a file belongs"},
      {"EmptyCalibration", "kitti", Write("calib.txt", ""),
       "DIR/calib.txt: P2 is missing; image_2 needs its projection"},
      {"LeftProjectionMissing", "kitti", Replace("calib.txt", "P2:", "Q2:"),
       "DIR/calib.txt: P2 is missing; image_2 needs its projection"},
      {"RightProjectionMissing", "kitti", Replace("calib.txt", "P3:", "Q3:"),
       "DIR/calib.txt: P3 is missing; image_3 needs its projection"},
      {"ProjectionTwice", "kitti", Replace("calib.txt", "P3:", "P2:"),
       "DIR/calib.txt:4: P2 is given twice"},
      {"ShortProjection", "kitti", Replace("calib.txt", "P1: 20 0 ", "P1: 20 "),
       "DIR/calib.txt:2: 12 fields where 13 belong (a name and a 3x4 matrix)"},
      {"NegativeFocalLength", "kitti", Replace("calib.txt", "P2: 20", "P2: -20"),
       "DIR/calib.txt:3: focal length is not positive"},
      {"SkewedProjection", "kitti", Replace("calib.txt", "P2: 20 0", "P2: 20 1"),
       "DIR/calib.txt:3: projection is not that of a rectified camera"},
      {"CamerasTheWrongWayRound", "kitti", Replace("calib.txt", "8 -8 0", "8 28 0"),
       "DIR/calib.txt: camera 3 is not to the right of camera 2"},
      {"CalibrationOfWords", "kitti", Replace("calib.txt", "P0: 20", "P0: twenty"),
       "DIR/calib.txt:1: 'twenty' is not a number"},

      // KITTI: poses.txt and times.txt.
      {"NoPoses", "kitti", Remove("poses.txt"), "DIR/poses.txt: no such file"},
      {"EmptyPoses", "kitti", Write("poses.txt", "\n\r\n# none\n"), "DIR/poses.txt: holds no pose"},
      {"ShortPose", "kitti", Replace("poses.txt", "0 1 1\n", "0 1\n"),
       "DIR/poses.txt:2: 11 fields where 12 belong (a 3x4 matrix)"},
      {"LongPose", "kitti", Replace("poses.txt", "0 1 1\n", "0 1 1 0\n"),
       "DIR/poses.txt:2: 13 fields where 12 belong (a 3x4 matrix)"},
      {"NanInPose", "kitti", Replace("poses.txt", "0 1 2\n", "0 1 nan\n"),
       "DIR/poses.txt:3: 'nan' is not a finite number"},
      {"InfinityInPose", "kitti", Replace("poses.txt", "0 1 2\n", "0 1 -inf\n"),
       "DIR/poses.txt:3: '-inf' is not a finite number"},
      {"TooLargeANumber", "kitti", Replace("poses.txt", "0 1 2\n", "0 1 1e999\n"),
       "DIR/poses.txt:3: '1e999' is not a number"},
      {"GarbageAfterANumber", "kitti", Replace("poses.txt", "0 1 2\n", "0 1 2m\n"),
       "DIR/poses.txt:3: '2m' is not a number"},
      {"CommaForAPoint", "kitti", Replace("poses.txt", "0 1 2\n", "0 1 2,5\n"),
       "DIR/poses.txt:3: '2,5' is not a number"},
      {"BlankLineKeepsItsNumber", "kitti", Replace("poses.txt", "0 1 1\n", "0 1 1\n\nx\n"),
       "DIR/poses.txt:4: 1 fields where 12 belong (a 3x4 matrix)"},
      {"ScaledRotation", "kitti", Replace("poses.txt", "1 0 0 0 0 1", "1.1 0 0 0 0 1"),
       "DIR/poses.txt:1: the left 3x3 block is not a rotation"},
      {"Mirrored", "kitti", Replace("poses.txt", "1 0 0 0 0 1", "-1 0 0 0 0 1"),
       "DIR/poses.txt:1: the left 3x3 block is not a rotation"},
      {"ZeroRotation", "kitti", Write("poses.txt", "0 0 0 0 0 0 0 0 0 0 0 0\n"),
       "DIR/poses.txt:1: the left 3x3 block is not a rotation"},
      {"MorePosesThanImages", "kitti",
       [](const TestFolder& folder) {
         folder.Write("poses.txt", folder.Read("poses.txt") + "1 0 0 0 0 1 0 0 0 0 1 3\n");
       },
       "DIR/image_2: 3 images for the 4 poses of poses.txt; the first missing is number 3"},
      {"FewerTimesThanPoses", "kitti", Write("times.txt", "0\n1\n"),
       "DIR/times.txt: 2 times for the 3 poses of poses.txt"},
      {"TimesGoBack", "kitti", Write("times.txt", "0\n1\n0.5\n"),
       "DIR/times.txt:3: time 0.5 is not after 1"},
      {"TimesStandStill", "kitti", Write("times.txt", "0\n1\n1\n"),
       "DIR/times.txt:3: time 1 is not after 1"},
      {"AnEndlessField", "kitti", Write("times.txt", std::string(5000, '7') + "x\n"),
       "DIR/times.txt:1: '" + std::string(40, '7') + "...' is not a number"},
      {"TwoTimesInARow", "kitti", Write("times.txt", "0 1\n2\n3\n"),
       "DIR/times.txt:1: 2 fields where 1 belong (seconds)"},
      {"BinaryTimes", "kitti", Write("times.txt", std::string("\0ab", 3)),
       "DIR/times.txt:1: '?ab' is not a number"},

      // KITTI: images.
      {"NoImages", "kitti", Remove("image_2"),
       "DIR: has no images; the left ones belong in image_2 (colour) or image_0 (gray)"},
      {"EmptyImageFolder", "kitti",
       [](const TestFolder& folder) {
         folder.Remove("image_2");
         folder.Write("image_2/readme.md", "");
       },
       "DIR/image_2: holds no image; images are named NUMBER.png or NUMBER.jpg"},
      {"ImageMissing", "kitti", Remove("image_2/000001.png"),
       "DIR/image_2: 2 images for the 3 poses of poses.txt; the first missing is number 1"},
      {"ImageWithoutANumber", "kitti", Image("image_2/left.png", 16, 12),
       "DIR/image_2/left.png: the name of an image must be its number"},
      {"ImageOfAnotherSize", "kitti", Image("image_2/000002.png", 12, 16),
       "DIR/image_2/000002.png: 12x16 pixels where the lap's first image has 16x12"},
      {"RightImageOfAnotherSize", "kitti", Image("image_3/000001.png", 8, 6),
       "DIR/image_3/000001.png: 8x6 pixels where the lap's first image has 16x12"},
      {"RightImageOfNoFrame", "kitti", Image("image_3/000007.png", 16, 12),
       "DIR/image_3/000007.png: no left image has that number"},
      {"TruncatedPng", "kitti", Cut("image_2/000001.png", 20),
       "DIR/image_2/000001.png: is not an image that can be decoded"},
      {"EmptyPng", "kitti", Write("image_2/000001.png", ""), "DIR/image_2/000001.png: is empty"},
      {"TextForAnImage", "kitti", Write("image_2/000001.png", "no picture"),
       "DIR/image_2/000001.png: is not an image that can be decoded"},
      {"EightBitDepth", "kitti", Image("depth/000001.png", 8, 6, CV_8UC1),
       "DIR/depth/000001.png: depth has 8 bits and 1 channels where 16 and 1 belong"},
      {"ColourDepth", "kitti", Image("depth/000001.png", 8, 6, CV_16UC3),
       "DIR/depth/000001.png: depth has 16 bits and 3 channels where 16 and 1 belong"},
      {"DepthOfNoWholeFraction", "kitti", Image("depth/000001.png", 10, 6, CV_16UC1),
       "DIR/depth/000001.png: 10x6 is no whole fraction of the 16x12 image"},
      {"DepthOfNoFrame", "kitti", Image("depth/000003.png", 8, 6, CV_16UC1),
       "DIR/depth/000003.png: no left image has that number"},

      // KITTI: gps.csv.
      {"GpsWithoutHeader", "kitti", Write("gps.csv", "0,0,0,0,4\n"),
       "DIR/gps.csv:1: not the header 'time x y z quality'"},
      {"EmptyGps", "kitti", Write("gps.csv", ""), "DIR/gps.csv: is empty"},
      {"ShortGpsRow", "kitti", Write("gps.csv", "time,x,y,z,quality\n0,1,2,3\n"),
       "DIR/gps.csv:2: 4 fields where 5 belong (time x y z quality)"},
      {"EmptyGpsField", "kitti", Write("gps.csv", "time,x,y,z,quality\n0,1,,3,4\n"),
       "DIR/gps.csv:2: '' is not a number"},
      {"FractionalGpsQuality", "kitti", Write("gps.csv", "time,x,y,z,quality\n0,1,2,3,4.5\n"),
       "DIR/gps.csv:2: quality 4.5 is none of 0..9"},
      {"GpsTimesGoBack", "kitti", Write("gps.csv", "time,x,y,z,quality\n1,1,2,3,4\n0,1,2,3,4\n"),
       "DIR/gps.csv:3: time 0 is not after 1"},

      // TUM.
      {"TumWithoutImages", "tum", Remove("rgb.txt"), "DIR/rgb.txt: no such file"},
      {"TumWithoutTruth", "tum", Remove("groundtruth.txt"), "DIR/groundtruth.txt: no such file"},
      {"TumListsNoImage", "tum", Write("rgb.txt", "# nothing\n"), "DIR/rgb.txt: lists no image"},
      {"TumImageMissing", "tum", Remove("rgb/2.png"), "DIR/rgb.txt:3: there is no file rgb/2.png"},
      {"TumDepthMissing", "tum", Remove("depth/2.png"),
       "DIR/depth.txt:2: there is no file depth/2.png"},
      {"TumImageWithoutTime", "tum", Replace("rgb.txt", "1.11 ", ""),
       "DIR/rgb.txt:3: 1 fields where 2 belong (time and file)"},
      {"TumTimesGoBack", "tum", Replace("rgb.txt", "1.11", "0.9"),
       "DIR/rgb.txt:3: time 0.9 is not after 1"},
      {"TumShortPose", "tum", Replace("groundtruth.txt", "0.05 0 0 0 0 0 1", "0.05 0 0 0 0 1"),
       "DIR/groundtruth.txt:3: 7 fields where 8 belong " + kTumColumns},
      {"TumZeroQuaternion", "tum", Replace("groundtruth.txt", "0 0 0 1\n", "0 0 0 0\n"),
       "DIR/groundtruth.txt:2: the quaternion is not of length 1"},
      {"TumNoPoseInTime", "tum", Write("groundtruth.txt", "9 0 0 0 0 0 0 1\n"),
       "DIR: no image of rgb.txt is within 0.02 s of a pose of groundtruth.txt"},
      {"TumUnknownCamera", "tum", Remove("calibration.txt"),
       "DIR: 16x12 images have no default camera; add calibration.txt with fx fy cx cy"},
      {"TumShortCalibration", "tum", Write("calibration.txt", "20 20 8\n"),
       "DIR/calibration.txt:1: 3 fields where 4 belong (fx fy cx cy)"},
      {"TumZeroFocalLength", "tum", Write("calibration.txt", "20 0 8 6\n"),
       "DIR/calibration.txt:1: focal length is not positive"},
      {"TumEightBitDepth", "tum", Image("depth/1.png", 16, 12, CV_8UC1),
       "DIR/depth/1.png: depth has 8 bits and 1 channels where 16 and 1 belong"},
      {"TrajectoryOfNans", "", Write("a.tum", "0 nan 0 0 0 0 0 1\n"),
       "DIR/a.tum:1: 'nan' is not a finite number", "a.tum"},

      // UFES-LAPS.
      {"UfesWithoutCamera", "ufes", Remove("camera3.txt"), "DIR/camera3.txt: no such file"},
      {"UfesCameraOfComments", "ufes", Write("camera3.txt", "# fx\n"),
       "DIR/camera3.txt: 0 rows of numbers where 1 belongs"},
      {"UfesShortCamera", "ufes", Write("camera3.txt", "0.75,0.5,1,0.5\n"),
       "DIR/camera3.txt:1: 4 fields where 5 belong (fx,cx,fy,cy,baseline)"},
      {"UfesNegativeBaseline", "ufes", Write("camera3.txt", "0.75,0.5,1,0.5,-0.24\n"),
       "DIR/camera3.txt:1: baseline is not positive"},
      {"UfesWithoutHeader", "ufes", Write("camerapos-20160825.txt", "1 2 0 0 0 0 1 a b\n"),
       "DIR/camerapos-20160825.txt:1: not the header 'x y z rx ry rz timestamp left_image "
       "right_image'"},
      {"UfesShortRow", "ufes", Replace("camerapos-20160825.txt", " /far/b.r.png", ""),
       "DIR/camerapos-20160825.txt:3: 8 fields where 9 belong " + kPoseColumns},
      {"UfesBadNumber", "ufes", Replace("camerapos-20160825.txt", "10 21", "10 --21"),
       "DIR/camerapos-20160825.txt:3: '--21' is not a number"},
      {"UfesTimesGoBack", "ufes", Replace("camerapos-20160825.txt", " 101 ", " 100 "),
       "DIR/camerapos-20160825.txt:3: time 100 is not after 100.5"},
      {"UfesNoPoses", "ufes",
       Write("camerapos-20160825.txt", "x y z rx ry rz timestamp left_image right_image\n"),
       "DIR/camerapos-20160825.txt: holds no pose"},
      {"UfesEmptyPoses", "ufes", Write("camerapos-20160825.txt", ""),
       "DIR/camerapos-20160825.txt: is empty"},
      {"UfesGpsQuality", "ufes", Replace("cameragps-20160825.txt", "1 4 ", "1 -1 "),
       "DIR/cameragps-20160825.txt:2: quality -1 is none of 0..9"},
  };
}

class Malformed : public ::testing::TestWithParam<Case> {};

TEST_P(Malformed, IsRefusedInOneLine) {
  const Case& c = GetParam();
  const TestFolder folder;
  if (c.layout == "kitti") folder.MakeKitti();
  if (c.layout == "tum") folder.MakeTum();
  if (c.layout == "ufes") folder.MakeUfes();
  c.break_it(folder);
  const std::string path = (c.read.empty() ? folder.path() : folder.path() / c.read).string();
  try {
    ReadLap(path);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    std::string message = error.what();
    const std::string here = folder.path().string();
    ASSERT_TRUE(message.starts_with(here)) << message;
    EXPECT_EQ("DIR" + message.substr(here.size()), c.error);
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(DataSets, Malformed, ::testing::ValuesIn(Cases()),
                         [](const auto& info) { return info.param.name; });

TEST(MalformedFormat, NameIsRefused) {
  try {
    ParseFormat("euroc");
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "format: 'euroc' is none; use guess, kitti, tum or ufes");
  }
}

}  // namespace
}  // namespace recollect
