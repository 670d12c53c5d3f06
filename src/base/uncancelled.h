// Work that an error in another task does not cancel.
#pragma once

#include <tbb/task_group.h>

namespace sherd {

/// Runs `work` in an isolated context, so that it ends only by itself or by its own error.
///
/// TBB cancels a loop at the first error, and with it all nested loops: those of OpenVDB then
/// return with partial results, and the code after them reads uninitialized values.  So the body of
/// a parallel loop that can throw in one task while another is inside OpenVDB runs through this.
template <class Work>
void uncancelled(const Work& work) {
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::task_group(own).run_and_wait(work);
}

}  // namespace sherd
