#pragma once

#include "recollect/wnn/asking.h"
#include "recollect/wnn/candidates.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/tally.h"

namespace recollect::wnn {

// The neurons that may vote for one candidate, some of which have been asked.
struct Stratum {
  int votes = 0;  // that the candidate has for certain, from elsewhere
  int size = 0;   // neurons that may vote for it
  int asked = 0;  // of these
  int yes = 0;    // of these voted for it
};

// Evidence, as the logarithm of a fair bet's winnings, that candidate a gets more votes than b
// when all neurons of both strata are asked, if those asked so far came in random order. Infinite
// when it is certain. The bet is the prior-posterior ratio of Waudby-Smith and Ramdas (2020) for
// sampling without replacement, multiplied over both strata, at the totals with a not ahead that
// suit the votes best. See docs/search.md, "Anytime".
double LogEvidenceAhead(const Stratum& a, const Stratum& b);

// Decides between `candidates` when neurons [0, tally.read()) have answered and no other label can
// win: asks neurons that may vote for the leader and its closest rival, until the full committee
// would choose otherwise with a chance of at most error_bound only.
Verdict AskRunoff(const Memory& memory, Asking& asking, const Tally& tally,
                  const Candidates& candidates, double error_bound);

}  // namespace recollect::wnn
