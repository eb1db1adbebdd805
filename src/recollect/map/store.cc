#include "recollect/map/store.h"

#include <lmdb.h>

#include <array>
#include <cerrno>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 5> kTableNames = {"meta", "keyframes", "images", "patterns",
                                                    "geometry"};
constexpr std::size_t kOptionalFrom = 4;  // tables that older maps have not
// Address space, not memory or disk: room for about two million key frames.
constexpr std::size_t kAddressSpace = std::size_t{256} << 30;

void Check(int code, const fs::path& file, const char* doing) {
  if (code == MDB_SUCCESS) return;
  const bool foreign = code == MDB_INVALID || code == MDB_VERSION_MISMATCH ||
                       code == MDB_CORRUPTED || code == MDB_PAGE_NOTFOUND || code == MDB_NOTFOUND;
  throw Error(file.string(), fmt::format("{} failed ({})", doing, mdb_strerror(code)),
              foreign ? "this is not a whole Recollect map" : "");
}

MDB_val ToValue(Bytes bytes) { return {bytes.size(), const_cast<std::byte*>(bytes.data())}; }

std::optional<Bytes> Find(MDB_txn* txn, MDB_dbi table, Bytes key, const fs::path& file) {
  MDB_val k = ToValue(key), v;
  const int code = mdb_get(txn, table, &k, &v);
  if (code == MDB_NOTFOUND) return std::nullopt;
  Check(code, file, "reading");
  return Bytes(static_cast<const std::byte*>(v.mv_data), v.mv_size);
}

Bytes AsBytes(const std::uint32_t& key) { return std::as_bytes(std::span(&key, 1)); }
Bytes AsBytes(const std::string& key) { return std::as_bytes(std::span(key)); }

// An environment with one transaction and its tables, closed in the right order.
struct Session {
  fs::path path;  // what is opened
  fs::path file;  // what errors call it
  MDB_env* env = nullptr;
  MDB_txn* txn = nullptr;
  std::array<MDB_dbi, kTableNames.size()> tables{};
  std::array<bool, kTableNames.size()> missing{};

  Session(const fs::path& opened, const fs::path& shown, bool writing, bool create)
      : path(opened), file(shown) {
    const fs::path lock = opened.string() + "-lock";
    const bool had_lock = fs::exists(lock);
    try {
      Open(writing, create);
    } catch (...) {
      Close();
      // What is no map of ours is left as it was.
      std::error_code ignored;
      if (!had_lock) fs::remove(lock, ignored);
      throw;
    }
  }
  ~Session() { Close(); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void Open(bool writing, bool create) {
    if (!create) {
      Require(fs::exists(path), file.string(), "no such map",
              "make one with: recollect map create");
      Require(fs::is_regular_file(path), file.string(), "is no file, so no map");
      Require(fs::file_size(path) > 0, file.string(), "is empty, so no map");
    }
    Check(mdb_env_create(&env), file, "opening");
    Check(mdb_env_set_maxdbs(env, kTableNames.size()), file, "opening");
    Check(mdb_env_set_mapsize(env, kAddressSpace), file, "opening");
    const unsigned flags = MDB_NOSUBDIR | MDB_NOTLS | (writing ? 0u : MDB_RDONLY);
    int code = mdb_env_open(env, path.c_str(), flags, 0644);
    if (!writing && (code == EACCES || code == EROFS)) {
      // No right to keep the lock file beside the map: then nobody here can be writing it either.
      Close();
      Check(mdb_env_create(&env), file, "opening");
      Check(mdb_env_set_maxdbs(env, kTableNames.size()), file, "opening");
      code = mdb_env_open(env, path.c_str(), flags | MDB_NOLOCK, 0644);
    }
    Check(code, file, "opening");
    CheckWhole();
    Begin(writing);
    for (std::size_t i = 0; i < tables.size(); ++i) {
      const bool optional = i >= kOptionalFrom;
      const unsigned kind = i == 0 ? 0u : MDB_INTEGERKEY;
      const unsigned make = create || (optional && writing) ? MDB_CREATE : 0u;
      const int code_of_table = mdb_dbi_open(txn, kTableNames[i], kind | make, &tables[i]);
      missing[i] = optional && code_of_table == MDB_NOTFOUND;
      if (!missing[i]) Check(code_of_table, file, "opening");
    }
  }

  void Begin(bool writing) {
    Check(mdb_txn_begin(env, nullptr, writing ? 0u : MDB_RDONLY, &txn), file, "opening");
  }

  // A file cut short would end the process with SIGBUS when its lost pages are touched.
  void CheckWhole() const {
    MDB_envinfo info;
    MDB_stat stat;
    Check(mdb_env_info(env, &info), file, "opening");
    Check(mdb_env_stat(env, &stat), file, "opening");
    const std::size_t pages = info.me_last_pgno + 1;
    Require(fs::file_size(path) >= pages * stat.ms_psize || info.me_last_txnid == 0, file.string(),
            fmt::format("is cut short: {} bytes of {}", fs::file_size(path), pages * stat.ms_psize),
            "copy or create the map again");
  }

  void Close() {
    if (txn != nullptr) mdb_txn_abort(std::exchange(txn, nullptr));
    if (env != nullptr) mdb_env_close(std::exchange(env, nullptr));
  }

  MDB_dbi Handle(Table table) const { return tables[static_cast<std::size_t>(table)]; }
  bool Has(Table table) const { return !missing[static_cast<std::size_t>(table)]; }
};

}  // namespace

struct StoreReader::State : Session {
  using Session::Session;
};

StoreReader::StoreReader(const fs::path& file)
    : state_(std::make_unique<State>(file, file, /*writing=*/false, /*create=*/false)) {}
StoreReader::~StoreReader() = default;
StoreReader::StoreReader(StoreReader&&) noexcept = default;
StoreReader& StoreReader::operator=(StoreReader&&) noexcept = default;

std::optional<Bytes> StoreReader::Get(Table table, std::uint32_t key) const {
  if (!state_->Has(table)) return std::nullopt;
  return Find(state_->txn, state_->Handle(table), AsBytes(key), state_->file);
}

std::optional<Bytes> StoreReader::Get(const std::string& meta_key) const {
  return Find(state_->txn, state_->Handle(Table::kMeta), AsBytes(meta_key), state_->file);
}

std::size_t StoreReader::Count(Table table) const {
  if (!state_->Has(table)) return 0;
  MDB_stat stat;
  Check(mdb_stat(state_->txn, state_->Handle(table), &stat), state_->file, "reading");
  return stat.ms_entries;
}

const fs::path& StoreReader::file() const { return state_->file; }

std::size_t StoreReader::FileBytes() const { return fs::file_size(state_->path); }

struct StoreWriter::State : Session {
  using Session::Session;
};

StoreWriter::StoreWriter(const fs::path& file, bool create, const fs::path& shown)
    : state_(
          std::make_unique<State>(file, shown.empty() ? file : shown, /*writing=*/true, create)) {}
StoreWriter::~StoreWriter() = default;

void StoreWriter::Put(Table table, std::uint32_t key, Bytes value) {
  MDB_val k = ToValue(AsBytes(key)), v = ToValue(value);
  Check(mdb_put(state_->txn, state_->Handle(table), &k, &v, 0), state_->file, "writing");
}

void StoreWriter::Put(const std::string& meta_key, Bytes value) {
  MDB_val k = ToValue(AsBytes(meta_key)), v = ToValue(value);
  Check(mdb_put(state_->txn, state_->Handle(Table::kMeta), &k, &v, 0), state_->file, "writing");
}

std::optional<Bytes> StoreWriter::Get(Table table, std::uint32_t key) const {
  return Find(state_->txn, state_->Handle(table), AsBytes(key), state_->file);
}

std::optional<Bytes> StoreWriter::Get(const std::string& meta_key) const {
  return Find(state_->txn, state_->Handle(Table::kMeta), AsBytes(meta_key), state_->file);
}

void StoreWriter::Commit() {
  Check(mdb_txn_commit(std::exchange(state_->txn, nullptr)), state_->file, "writing");
  Check(mdb_env_sync(state_->env, 1), state_->file, "writing");
  state_->Begin(/*writing=*/true);
}

void CreateStore(const fs::path& file, const std::function<void(StoreWriter&)>& fill) {
  AtomicWrite(file, [&](const fs::path& temporary) {
    const fs::path lock = temporary.string() + "-lock";
    const auto remove_lock = [&] {
      std::error_code ignored;
      fs::remove(lock, ignored);
    };
    try {
      StoreWriter writer(temporary, /*create=*/true, file);
      fill(writer);
      writer.Commit();
    } catch (...) {
      remove_lock();
      throw;
    }
    remove_lock();
  });
}

}  // namespace recollect
