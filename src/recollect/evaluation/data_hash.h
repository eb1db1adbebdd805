#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect {

// Tells data apart by accident, not on purpose: 64 bits (FNV-1a), no cryptography.
class Hash {
 public:
  Hash& Add(std::string_view bytes);
  std::string Text() const;  // 16 hexadecimal digits

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

// The whole of a file. Throws Error where it cannot be read.
std::string HashOfFile(const std::filesystem::path& file);

// Of laps, wherever their folder lies: all that was read of them (poses, times, satellite fixes,
// cameras), and of each image and depth image its file's name and size.
std::string HashOf(const std::vector<Lap>& laps);

}  // namespace recollect
