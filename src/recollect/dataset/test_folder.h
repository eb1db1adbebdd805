#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "recollect/testing/scratch_folder.h"

namespace recollect {

// A folder for one test and small data sets to put there.
class TestFolder : public testing::ScratchFolder {
 public:
  void Write(const std::string& file, const std::string& content) const {
    std::filesystem::create_directories((path() / file).parent_path());
    std::ofstream(path() / file, std::ios::binary) << content;
  }
  std::string Read(const std::string& file) const {
    std::ifstream in(path() / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // An image of the given size and OpenCV type, all pixels 7; its kind is told by its name.
  void WriteImage(const std::string& file, int width, int height, int type = CV_8UC3) const {
    std::filesystem::create_directories((path() / file).parent_path());
    cv::imwrite(path() / file, cv::Mat(height, width, type, cv::Scalar::all(7)));
  }
  void Remove(const std::string& file) const { std::filesystem::remove_all(path() / file); }
  // The first occurrence of `old` in a file becomes `now`.
  void Replace(const std::string& file, const std::string& old, const std::string& now) const {
    std::string content = Read(file);
    content.replace(content.find(old), old.size(), now);
    Write(file, content);
  }

  // Three frames along z, a metre apart; stereo, depth at half size, satellite fixes.
  void MakeKitti() const {
    Write("calib.txt",
          "P0: 20 0 8 0 0 20 6 0 0 0 1 0\nP1: 20 0 8 -10 0 20 6 0 0 0 1 0\n"
          "P2: 20 0 8 2 0 20 6 0 0 0 1 0\nP3: 20 0 8 -8 0 20 6 0 0 0 1 0\n"
          "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    Write("poses.txt",
          "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n");
    Write("times.txt", "0\n0.5\n1\n");
    Write("gps.csv", "time,x,y,z,quality\n0,0,0,0.1,4\n0.9,0,0,2.1,0\n");
    for (const std::string number : {"000000", "000001", "000002"}) {
      WriteImage("image_2/" + number + ".png", 16, 12);
      WriteImage("depth/" + number + ".png", 8, 6, CV_16UC1);
    }
    WriteImage("image_3/000001.png", 16, 12);
  }

  // Three images at 10 Hz, 16 x 12; poses every 0.05 s along x at 1 m/s, but for the last image.
  void MakeTum() const {
    Write("calibration.txt", "20 20 8 6\n");
    Write("rgb.txt", "# time file\n1.00 rgb/1.png\n1.11 rgb/2.png\n1.20 rgb/3.png\n");
    Write("depth.txt", "1.005 depth/1.png\n1.15 depth/2.png\n");
    Write("groundtruth.txt",
          "# timestamp tx ty tz qx qy qz qw\n"
          "1.00 0 0 0 0 0 0 1\n1.05 0.05 0 0 0 0 0 1\n1.10 0.10 0 0 0 0 0 1\n"
          "1.15 0.15 0 0 0 0 0 1\n");
    for (const std::string name : {"rgb/1.png", "rgb/2.png", "rgb/3.png"}) WriteImage(name, 16, 12);
    for (const std::string name : {"depth/1.png", "depth/2.png"}) {
      WriteImage(name, 16, 12, CV_16UC1);
    }
  }

  // Two recordings of two poses; the first has its left images, and satellite fixes.
  void MakeUfes() const {
    const std::string header = "x y z rx ry rz timestamp left_image right_image\n";
    Write("camera3.txt", "# fx, cx, fy, cy, baseline\n0.75,0.5,1,0.5,0.24\n");
    Write("camerapos-20160825.txt", header +
                                        "10 20 0 0.01 0.02 1.5 100.5 /far/a.l.png /far/a.r.png\n"
                                        "10 21 0 0 0 1.5 101 /far/b.l.png /far/b.r.png\n");
    Write("camerapos-20160825-01.txt", header + "10 20 0 0 0 0 200 c.l.png c.r.png\n");
    Write("cameragps-20160825.txt",
          "x y z heading valid quality timestamp\n10 20 0 0.5 1 4 100.5\n0 0 0 0.5 0 0 101\n");
    WriteImage("20160825/a.l.png", 16, 12);
    WriteImage("20160825/b.l.png", 16, 12);
  }
};

}  // namespace recollect
