// Work that an error elsewhere does not cut off.
#pragma once

#include <tbb/task_group.h>

namespace sherd {

/// Do `work` to its end, or to its own error, whatever happens to the loop it is a part of.
///
/// TBB's loops stop at the first error, and with them every loop that runs within them: OpenVDB's
/// return with half their work done, and what comes after them reads what was never written.  So
/// where a parallel loop can fail in one place and is within OpenVDB in another, its body is this.
template <class Work>
void uncancelled(const Work& work) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::task_group(own).run_and_wait(work);
}

}  // namespace sherd
