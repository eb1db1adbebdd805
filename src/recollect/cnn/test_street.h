#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "recollect/testing/street.h"

namespace recollect::cnn {

// A folder of this process with laps of the test street in it, removed at the end.
class TestStreet {
 public:
  explicit TestStreet(const std::vector<testing::StreetDrive>& drives)
      : folder_(std::filesystem::temp_directory_path() /
                ("recollect_cnn_" + std::to_string(getpid()))) {
    for (std::size_t i = 0; i < drives.size(); ++i) {
      laps_.push_back(testing::DriveStreet(folder_ / ("lap-" + std::to_string(i)), drives[i]));
    }
  }
  ~TestStreet() { std::filesystem::remove_all(folder_); }
  TestStreet(const TestStreet&) = delete;
  TestStreet& operator=(const TestStreet&) = delete;

  const std::vector<Lap>& laps() const { return laps_; }
  std::filesystem::path File(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
  std::vector<Lap> laps_;
};

}  // namespace recollect::cnn
