#pragma once

#include <functional>
#include <string>
#include <vector>

namespace recollect {

// Runs `body` in a process of its own and hands its numbers back; what it does to malloc, threads
// or libraries' settings ends with it. To be called while this process has one thread. Throws Error
// with what `body` threw, or naming `what` when the process was lost.
std::vector<double> RunInChild(const std::string& what,
                               const std::function<std::vector<double>()>& body);

}  // namespace recollect
