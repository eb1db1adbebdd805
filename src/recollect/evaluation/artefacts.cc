#include "recollect/evaluation/artefacts.h"

#include "recollect/core/files.h"
#include "recollect/evaluation/data_hash.h"

namespace recollect {
namespace fs = std::filesystem;
using nlohmann::json;

json ToJson(const RunStamp& stamp) {
  return {{"command", stamp.command},
          {"seed", stamp.seed},
          {"versions", stamp.versions},
          {"data_hash", stamp.data_hash}};
}

Artefacts::Artefacts(fs::path folder, RunStamp stamp)
    : folder_(std::move(folder)), stamp_(std::move(stamp)) {}

json Artefacts::Step(const std::string& name, const json& inputs, const std::function<json()>& make,
                     const std::vector<std::string>& files) {
  json stamp = ToJson(stamp_);
  stamp.erase("command");
  stamp["step"] = name;
  stamp["inputs"] = inputs;
  keys_[name] = Hash().Add(stamp.dump()).Text();

  const auto hashes = [&] {
    json of = json::object();
    for (const std::string& file : files) of[file] = HashOfFile(Path(file));
    return of;
  };
  const auto all_there = [&] {
    return std::all_of(files.begin(), files.end(),
                       [&](const std::string& file) { return fs::exists(Path(file)); });
  };
  const fs::path path = Path(name + ".json");
  if (fs::exists(path) && all_there()) {
    // A file that is not one of these, or was cut short, is one that does not agree.
    const json old = json::parse(ReadFile(path), nullptr, /*allow_exceptions=*/false);
    if (old.is_object() && old.contains("result") && old.value("key", "") == keys_[name] &&
        old.value("files", json()) == hashes()) {
      reused_.push_back(name);
      return old["result"];
    }
  }
  json result = make();
  stamp["command"] = stamp_.command;
  AtomicWrite(
      path,
      json{{"key", keys_[name]}, {"stamp", stamp}, {"files", hashes()}, {"result", result}}.dump() +
          "\n");
  return result;
}

}  // namespace recollect
