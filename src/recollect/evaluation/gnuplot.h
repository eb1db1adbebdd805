#pragma once

#include <filesystem>
#include <string>

namespace recollect {

// Has gnuplot draw what `script` says. Throws Error calling it `where`, with what to install, where
// that is missing or the script is wrong.
void RunGnuplot(const std::string& script, const std::filesystem::path& where);

}  // namespace recollect
