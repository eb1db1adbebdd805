#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect::cnn {

// Laps of the test street, in a folder of their own.
class TestStreet {
 public:
  explicit TestStreet(const std::vector<testing::StreetDrive>& drives) {
    for (std::size_t i = 0; i < drives.size(); ++i) {
      laps_.push_back(testing::DriveStreet(folder_ / ("lap-" + std::to_string(i)), drives[i]));
    }
  }

  const std::vector<Lap>& laps() const { return laps_; }
  std::filesystem::path File(const std::string& name) const { return folder_ / name; }

 private:
  testing::ScratchFolder folder_;
  std::vector<Lap> laps_;
};

}  // namespace recollect::cnn
