#include "recollect/core/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "recollect/core/error.h"

namespace recollect {
namespace fs = std::filesystem;

std::string ReadFile(const fs::path& path) {
  Require(fs::exists(path), path.string(), "no such file");
  Require(!fs::is_directory(path), path.string(), "is a folder where a file belongs");
  std::ifstream in(path, std::ios::binary);
  Require(in.is_open(), path.string(), std::strerror(errno));
  std::string content{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  Require(!in.bad(), path.string(), "cannot be read");
  return content;
}

void AtomicWrite(const fs::path& path, std::string_view content) {
  AtomicWrite(path, [&](const fs::path& temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    Require(!out.fail(), path.string(),
            fmt::format("cannot be written ({})", errno != 0 ? std::strerror(errno) : "i/o error"),
            "check the folder's rights and the free space");
  });
}

void AtomicWrite(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  Require(!error, path.string(), fmt::format("its folder cannot be made ({})", error.message()));
  Require(!fs::is_directory(path), path.string(), "is a folder where a file is to be written");
  fs::path temporary = path.parent_path() / fmt::format(".{}.{}{}", path.stem().string(), getpid(),
                                                        path.extension().string());
  try {
    write(temporary);
  } catch (...) {
    fs::remove(temporary, error);
    throw;
  }
  fs::rename(temporary, path, error);
  if (error) {
    const std::string reason = error.message();
    fs::remove(temporary, error);
    throw Error(path.string(), fmt::format("cannot be put in place ({})", reason));
  }
}

}  // namespace recollect
