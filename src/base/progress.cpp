// Progress reports and cancellation.
#include <sherd/error.h>
#include <sherd/progress.h>

namespace sherd {

void reportProgress(const Progress* progress, std::string_view stage, double fraction) {
  if (!progress) return;
  if (progress->cancelled && progress->cancelled())
    throw Error(ErrorCode::cancelled, "stopped on request");
  if (progress->report) progress->report(stage, fraction);
}

}  // namespace sherd
