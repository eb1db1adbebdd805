#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "recollect/dataset/lap.h"
#include "recollect/simulation/sensors.h"

namespace recollect::simulation {

// Puts one lap on disk, frame by frame and in any order, from any thread. Until Finish it lives in
// a hidden folder beside its own, where a later run with the same `description` finds and keeps
// what is done. Everything throws Error for folders and disks that take no more.
class LapWriter {
 public:
  // Makes or finds the lap's folder `name` in `out`. Throws Error where a lap of that name was
  // made, or begun, with another description.
  LapWriter(std::filesystem::path out, std::string name, std::string description, bool stereo,
            bool depth);

  bool finished() const { return finished_; }
  // Whether all pictures of a frame are there.
  bool Has(std::int64_t frame) const;
  // Pictures of a frame; empty ones are not written.
  void Write(std::int64_t frame, const cv::Mat& left, const cv::Mat& right, const cv::Mat& depth,
             int jpeg_quality);
  // A text file of the lap.
  void WriteText(const std::string& file, const std::string& text);
  // Gives the lap its name: from now on it is there, whole.
  void Finish();

 private:
  std::filesystem::path Path(const char* kind, std::int64_t frame, const char* extension) const;

  std::filesystem::path folder_, work_;
  bool stereo_, depth_;
  bool finished_ = false;
};

// The text of poses.txt (KITTI: 3x4 row-major a row), calib.txt and gps.csv.
std::string KittiPoses(const std::vector<SE3>& poses);
std::string KittiCalibration(const StereoCamera& camera);
std::string GpsTable(const std::vector<GpsFix>& fixes);

}  // namespace recollect::simulation
