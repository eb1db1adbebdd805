#include "recollect/evaluation/paper_split.h"

#include <algorithm>
#include <array>
#include <map>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

constexpr std::array kRecordings = {"20160825", "20160825-01", "20160825-02", "20160830",
                                    "20161021", "20170119",    "20171122",    "20171205",
                                    "20180112", "20180112-02"};
// Numbers of the paper's laps, from 1.
constexpr std::array kMapLaps = {1, 2, 3, 8, 9, 10};
constexpr std::array kTrainLaps = {1, 2, 3, 5, 8, 9, 10};
constexpr int kValidLap = 4, kTestLap = 7;

constexpr const char* kSimulatedMark = "rendered, not recorded";
constexpr const char* kUfesMark = "of the simulated route ufes";

std::string DescriptionOf(const Lap& lap) {
  const auto file = lap.folder / "lap.txt";
  return std::filesystem::exists(file) ? ReadFile(file) : "";
}

// Digits at the end of a name; -1 for none.
int NumberOf(const std::string& name) {
  std::size_t begin = name.size();
  while (begin > 0 && name[begin - 1] >= '0' && name[begin - 1] <= '9') --begin;
  if (begin == name.size() || name.size() - begin > 6) return -1;
  return std::stoi(name.substr(begin));
}

// The paper's number -> index, empty where these are other laps.
std::map<int, std::size_t> UfesLaps(const std::vector<Lap>& laps) {
  std::map<int, std::size_t> found;
  for (std::size_t i = 0; i < laps.size(); ++i) {
    const auto dated = std::find(kRecordings.begin(), kRecordings.end(), laps[i].name);
    if (dated != kRecordings.end()) {
      found[static_cast<int>(dated - kRecordings.begin()) + 1] = i;
    } else if (DescriptionOf(laps[i]).find(kUfesMark) != std::string::npos) {
      found[NumberOf(laps[i].name)] = i;
    }
  }
  return found.contains(kTestLap) ? found : std::map<int, std::size_t>{};
}

std::size_t Find(const std::vector<Lap>& laps, const std::string& name) {
  const bool number = !name.empty() && name.size() <= 6 &&
                      name.find_first_not_of("0123456789") == std::string::npos;
  for (std::size_t i = 0; i < laps.size(); ++i) {
    if (laps[i].name == name) return i;
  }
  for (std::size_t i = 0; number && i < laps.size(); ++i) {
    if (NumberOf(laps[i].name) == std::stoi(name)) return i;
  }
  std::string all;
  for (const Lap& lap : laps) all += " " + lap.name;
  throw Error("lap " + name, "is not there", "there are:" + all);
}

template <std::size_t N>
std::vector<std::size_t> Those(const std::map<int, std::size_t>& found,
                               const std::array<int, N>& numbers) {
  std::vector<std::size_t> laps;
  for (const int number : numbers) {
    if (found.contains(number)) laps.push_back(found.at(number));
  }
  return laps;
}

bool Holds(const std::vector<std::size_t>& laps, std::size_t lap) {
  return std::find(laps.begin(), laps.end(), lap) != laps.end();
}

}  // namespace

PaperSplit ChooseSplit(const std::vector<Lap>& laps, const SplitNames& names) {
  Require(!laps.empty(), "laps", "there are none");
  PaperSplit split;
  const std::map<int, std::size_t> ufes = UfesLaps(laps);
  split.of_the_paper =
      !ufes.empty() && names.map.empty() && names.valid.empty() && names.test.empty();
  split.test = !names.test.empty() ? Find(laps, names.test)
               : !ufes.empty()     ? ufes.at(kTestLap)
                                   : laps.size() - 1;
  if (!names.valid.empty()) {
    split.valid = Find(laps, names.valid);
  } else if (ufes.contains(kValidLap) && names.map.empty()) {
    split.valid = ufes.at(kValidLap);
  }
  for (const std::string& name : names.map) split.map.push_back(Find(laps, name));
  split.train = split.map;
  if (names.map.empty() && !ufes.empty()) {
    split.map = Those(ufes, kMapLaps);
    split.train = Those(ufes, kTrainLaps);
    std::erase(split.map, split.test);
    std::erase(split.train, split.test);
  } else if (names.map.empty()) {
    for (std::size_t i = 0; i < laps.size(); ++i) {
      if (i != split.test && i != split.valid) split.map.push_back(i);
    }
    split.train = split.map;
  }
  Require(!split.map.empty(), "laps to map", "none is left",
          "one lap is live, at least one other is mapped");
  Require(!Holds(split.map, split.test), laps[split.test].name, "is mapped and live, too");
  Require(split.valid != split.test, laps[split.test].name, "is validated on and live, too");
  Require(!split.valid || !Holds(split.train, *split.valid),
          split.valid ? laps[*split.valid].name : "", "is trained and validated on");
  return split;
}

std::string RoleOf(const PaperSplit& split, std::size_t lap) {
  if (lap == split.test) return "live";
  if (lap == split.valid) return "validated on";
  const bool mapped = Holds(split.map, lap), trained = Holds(split.train, lap);
  return mapped && trained ? "mapped, trained on"
         : mapped          ? "mapped"
         : trained         ? "trained on"
                           : "not used";
}

bool IsSimulated(const Lap& lap) { return DescriptionOf(lap).starts_with(kSimulatedMark); }

}  // namespace recollect
