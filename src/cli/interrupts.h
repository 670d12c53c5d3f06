// Ctrl-C: a flag that long work asks for.
#pragma once

namespace sherd::cli {

/// From now on SIGINT, SIGTERM and SIGHUP, unless the caller ignores them, only set a flag.  To be
/// called before any thread is started.
void watchForInterrupts();

/// Whether one of them came.
[[nodiscard]] bool isInterrupted();

/// throws Error(cancelled) where one came
void stopIfInterrupted();

}  // namespace sherd::cli
