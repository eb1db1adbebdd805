#pragma once

#include <filesystem>

#include "recollect/evaluation/evaluate.h"

namespace recollect {

// Whether an answer is one to look at: not localised, or half a metre off and more.
bool IsFailure(const Localization& answer, const PoseError& error);

// A contact sheet of the worst of these, the worst first, a row each: the live image as the
// localiser saw it, the recollected key frame and the one nearest to the truth. Nothing is written
// where there is none. Returns how many there are in all.
int WriteFailures(const Evaluation& evaluation, const Map& map, const std::filesystem::path& jpg);

}  // namespace recollect
