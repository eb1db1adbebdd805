#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace recollect {

// The whole of a file. Throws Error naming it when it is missing, a folder or unreadable.
std::string ReadFile(const std::filesystem::path& path);

// Writes `content` to a temporary file beside `path` and renames it into place, so that a reader
// sees the old file or the new one, never a part. Missing parent folders are made. Throws Error,
// and leaves nothing behind, when any of it fails (no rights, disk full).
void AtomicWrite(const std::filesystem::path& path, std::string_view content);

// The same for writers that want a file name to write to: calls write(temporary path), then
// renames. The temporary name keeps the extension of `path`.
void AtomicWrite(const std::filesystem::path& path,
                 const std::function<void(const std::filesystem::path&)>& write);

}  // namespace recollect
