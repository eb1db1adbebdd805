#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace recollect {

// What a run was made of, said by each of its files.
struct RunStamp {
  std::string command;  // as it was typed
  std::uint64_t seed = 1;
  nlohmann::json versions = nlohmann::json::object();  // name -> version
  std::string data_hash;                               // see HashOf
};
nlohmann::json ToJson(const RunStamp& stamp);

// The steps of a long run, one JSON file each, STEP.json of a folder: {"stamp", "result"}, written
// whole. A step is done once: its file is taken again where everything but the command agrees,
// seed, versions and data, the inputs named by the caller, and the bytes of the files that it left.
class Artefacts {
 public:
  Artefacts(std::filesystem::path folder, RunStamp stamp);

  // What `make` gives, now or when the step was done. inputs: all that its result depends on, other
  // steps' keys among it. files: what it writes itself, named within the folder.
  nlohmann::json Step(const std::string& name, const nlohmann::json& inputs,
                      const std::function<nlohmann::json()>& make,
                      const std::vector<std::string>& files = {});

  // Names the state that a step's result follows from; for the inputs of later steps.
  std::string Key(const std::string& name) const { return keys_.at(name); }

  std::filesystem::path Path(const std::string& file) const { return folder_ / file; }
  const std::vector<std::string>& reused() const { return reused_; }  // steps that were not done

 private:
  std::filesystem::path folder_;
  RunStamp stamp_;
  std::map<std::string, std::string> keys_;
  std::vector<std::string> reused_;
};

}  // namespace recollect
