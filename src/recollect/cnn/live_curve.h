#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recollect/cnn/trainer.h"

namespace recollect::cnn {

// The curve as one HTML file without anything else to load: position errors over the steps, and
// the last validations as a table. While `running`, a browser that shows it reads it again every
// few seconds. status: a line on how far it is. Nothing is written where `path` is empty.
void WriteLiveCurve(const std::filesystem::path& path, const std::vector<CurvePoint>& curve,
                    const std::string& status, bool running);

}  // namespace recollect::cnn
