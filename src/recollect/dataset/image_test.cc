#include "recollect/dataset/image.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/dataset/test_folder.h"

namespace recollect {
namespace {

// The message of the Error that `read` throws, with the folder's path left out.
template <typename Function>
std::string Refusal(const TestFolder& folder, Function read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string prefix = folder.path().string() + "/", what = error.what();
    return what.starts_with(prefix) ? what.substr(prefix.size()) : what;
  }
  return "";
}

TEST(Image, ReadsColourAndGrayEitherWay) {
  const TestFolder folder;
  const cv::Mat colour(4, 6, CV_8UC3, cv::Scalar(10, 100, 200));
  cv::imwrite(folder.path() / "colour.png", colour);
  folder.WriteImage("gray.jpg", 6, 4, CV_8UC1);

  EXPECT_EQ(cv::norm(ReadColour(folder.path() / "colour.png"), colour), 0);
  const cv::Mat gray = ReadGray(folder.path() / "colour.png");
  EXPECT_EQ(gray.type(), CV_8UC1);
  EXPECT_NEAR(gray.at<std::uint8_t>(0, 0), 0.114 * 10 + 0.587 * 100 + 0.299 * 200, 1);
  const cv::Mat widened = ReadColour(folder.path() / "gray.jpg");
  EXPECT_EQ(widened.type(), CV_8UC3);
  EXPECT_EQ(widened.at<cv::Vec3b>(1, 1), cv::Vec3b(7, 7, 7));
}

TEST(Image, ReadsDepthInMetres) {
  const TestFolder folder;
  cv::Mat steps(2, 3, CV_16UC1, cv::Scalar(0));
  steps.at<std::uint16_t>(1, 2) = 12345;
  cv::imwrite(folder.path() / "depth.png", steps);
  const cv::Mat depth = ReadDepth(folder.path() / "depth.png");
  EXPECT_EQ(depth.type(), CV_32FC1);
  EXPECT_EQ(depth.at<float>(0, 0), 0);
  EXPECT_FLOAT_EQ(depth.at<float>(1, 2), 123.45F);
  EXPECT_FLOAT_EQ(ReadDepth(folder.path() / "depth.png", 1.0 / 5000).at<float>(1, 2), 2.469F);
}

TEST(Image, InfoComesFromTheHeader) {
  const TestFolder folder;
  for (const std::string name : {"a.png", "a.jpg", "a.bmp"}) {
    folder.WriteImage(name, 70, 40);
    const ImageInfo info = ReadImageInfo(folder.path() / name);
    EXPECT_EQ(info.width, 70) << name;
    EXPECT_EQ(info.height, 40) << name;
    EXPECT_EQ(info.channels, 3) << name;
    EXPECT_EQ(info.bits, 8) << name;
  }
  folder.WriteImage("depth.png", 300, 2, CV_16UC1);
  const ImageInfo info = ReadImageInfo(folder.path() / "depth.png");
  EXPECT_EQ(info.width, 300);
  EXPECT_EQ(info.channels, 1);
  EXPECT_EQ(info.bits, 16);
}

TEST(Image, RefusesWhatItCannotRead) {
  const TestFolder folder;
  const auto colour = [&](const std::string& name) {
    return Refusal(folder, [&] { ReadColour(folder.path() / name); });
  };
  const auto depth = [&](const std::string& name) {
    return Refusal(folder, [&] { ReadDepth(folder.path() / name); });
  };
  const auto info = [&](const std::string& name) {
    return Refusal(folder, [&] { ReadImageInfo(folder.path() / name); });
  };
  folder.Write("empty.png", "");
  folder.Write("text.png", "this is no image");
  for (const std::string name : {"cut.png", "cut.jpg"}) {
    folder.WriteImage(name, 64, 48);
    folder.Write(name, folder.Read(name).substr(0, folder.Read(name).size() * 2 / 3));
  }
  folder.WriteImage("cut.png", 64, 48);
  folder.Write("cut.png", folder.Read("cut.png").substr(0, 20));
  folder.WriteImage("deep.png", 4, 4, CV_16UC1);
  folder.WriteImage("shallow.png", 4, 4, CV_8UC1);

  EXPECT_EQ(colour("missing.png"), "missing.png: no such file");
  EXPECT_EQ(colour(""), ": is a folder where a file belongs");
  EXPECT_EQ(colour("empty.png"), "empty.png: is empty");
  EXPECT_EQ(colour("text.png"), "text.png: is not an image that can be decoded");
  EXPECT_EQ(colour("cut.png"), "cut.png: image is cut short");
  EXPECT_EQ(colour("cut.jpg"), "cut.jpg: image is cut short");
  EXPECT_EQ(colour("deep.png"), "deep.png: has 16 bits a channel where 8 belong");
  EXPECT_EQ(depth("shallow.png"),
            "shallow.png: depth has 8 bits and 1 channels where 16 and 1 belong");
  EXPECT_EQ(info("missing.png"), "missing.png: no such file");
  EXPECT_EQ(info("cut.png"), "cut.png: is not an image that can be decoded");
  EXPECT_EQ(info("text.png"), "text.png: is not an image that can be decoded");
}

}  // namespace
}  // namespace recollect
