// The threads of TBB under limits of the system.
#pragma once

#include <tbb/global_control.h>

#include <memory>

namespace sherd::cli {

/// Starts TBB's threads where ulimit -v, -d or -u may leave too few for them: TBB starts them when
/// work comes, and ends the process if it cannot.
///   return  limits TBB to the threads that can be started; null if all can
[[nodiscard]] std::unique_ptr<tbb::global_control> startedWorkers();

}  // namespace sherd::cli
