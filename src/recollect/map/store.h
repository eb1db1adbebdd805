#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace recollect {

using Bytes = std::span<const std::byte>;

// The tables of a map file. Numbers are the keys of all but kMeta. kGeometry may be missing: then
// it reads as empty.
enum class Table { kMeta, kKeyFrames, kImages, kPatterns, kGeometry };

// A map's file: one LMDB environment, read in place through the memory map. Readers see one
// consistent state, the one at opening, whatever writers do meanwhile. Throws Error, naming the
// file, on every failure: missing, foreign, truncated, no rights, disk full.
class StoreReader {
 public:
  explicit StoreReader(const std::filesystem::path& file);
  ~StoreReader();
  StoreReader(StoreReader&&) noexcept;
  StoreReader& operator=(StoreReader&&) noexcept;

  // Valid as long as this object. Pattern values are 16-byte aligned.
  std::optional<Bytes> Get(Table table, std::uint32_t key) const;
  std::optional<Bytes> Get(const std::string& meta_key) const;
  std::size_t Count(Table table) const;
  const std::filesystem::path& file() const;
  // Size of the file.
  std::size_t FileBytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// One write transaction: nothing is seen by readers before Commit, and nothing remains of it when
// it is destroyed without. One writer at a time; a second waits.
class StoreWriter {
 public:
  // Opens an existing store, or makes an empty one where `create` is set. Errors name `shown`,
  // which is `file` unless that is only a temporary name.
  StoreWriter(const std::filesystem::path& file, bool create,
              const std::filesystem::path& shown = {});
  ~StoreWriter();
  StoreWriter(const StoreWriter&) = delete;
  StoreWriter& operator=(const StoreWriter&) = delete;

  void Put(Table table, std::uint32_t key, Bytes value);
  void Put(const std::string& meta_key, Bytes value);
  // What a reader would get after Commit; valid until the next Put or Commit.
  std::optional<Bytes> Get(Table table, std::uint32_t key) const;
  std::optional<Bytes> Get(const std::string& meta_key) const;
  // Puts on disk what was written since the last Commit; more may be written after it.
  void Commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Makes a store beside `file`, lets `fill` write it, and renames it into place when all of it is
// on disk: whoever opens `file` sees the old map or the new one, never a part.
void CreateStore(const std::filesystem::path& file,
                 const std::function<void(StoreWriter& writer)>& fill);

}  // namespace recollect
