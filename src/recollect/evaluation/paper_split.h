#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect {

// Which laps do what; indices into the list that they were chosen from.
struct PaperSplit {
  std::vector<std::size_t> map;      // mapped, and learnt by the place recogniser
  std::vector<std::size_t> train;    // trained on by the relative-pose network
  std::optional<std::size_t> valid;  // none: a share of the road is kept out of the training
  std::size_t test = 0;              // live
  bool of_the_paper = false;
};

// Laps by name, or by number where that is how the name ends ("7" for lap-07); empty: the default.
struct SplitNames {
  std::vector<std::string> map;
  std::string valid, test;
};

// Where the laps are UFES-LAPS, by their dates or rendered by `recollect simulate --route
// ufes:...`, the splits that the paper really made (Forechi et al. 2018, section IV): map laps 01,
// 02, 03, 08, 09 and 10, trained on these and 05, validated on 04, tested on 07; laps that are not
// there are left out. Else leave-one-lap-out: the last lap is live, all others are mapped and
// trained on. Names given replace their part; laps named to be mapped are those trained on, too.
// Throws Error for unknown names, for a lap with two parts that exclude each other, and for nothing
// to map.
PaperSplit ChooseSplit(const std::vector<Lap>& laps, const SplitNames& names = {});

// In words, of each lap: "mapped, trained on", "live", "validated on" or "not used".
std::string RoleOf(const PaperSplit& split, std::size_t lap);

// True where `recollect simulate` rendered the lap.
bool IsSimulated(const Lap& lap);

}  // namespace recollect
