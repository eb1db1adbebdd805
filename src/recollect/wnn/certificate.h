#pragma once

#include "recollect/wnn/asking.h"
#include "recollect/wnn/candidates.h"
#include "recollect/wnn/entry_set.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/tally.h"

namespace recollect::wnn {

// Goes on asking, when neurons [0, tally.read()) have answered, until no vote still to come can
// change the winner. A candidate (see Candidates) can still gain only those neurons whose nearest
// candidate it is, where any other label can gain them all. The leader's neurons are asked first,
// the closest before the others: they settle the matter soonest.
Verdict AskUntilCertain(const Memory& memory, Asking& asking, Tally& tally,
                        const EntrySet* allowed);

}  // namespace recollect::wnn
