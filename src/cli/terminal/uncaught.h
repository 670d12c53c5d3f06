// Exceptions that nothing catches.
#pragma once

namespace sherd::cli {

/// Whatever calls std::terminate ends the program with one sentence and status 1.  Until this is
/// called, so do static objects of the libraries that throw before main.
void endUncaughtOrderly();

}  // namespace sherd::cli
