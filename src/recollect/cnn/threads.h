#pragma once

namespace recollect::cnn {

// Has torch use so many threads, 0 for one a core (OpenMP may begin with a single one), and keeps
// malloc from giving memory back between two runs of a network: otherwise half of the time goes
// into page faults.
void SetThreads(int threads);

}  // namespace recollect::cnn
