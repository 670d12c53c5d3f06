// A parallel loop that an error does not cut off.
#pragma once

#include <tbb/parallel_for.h>

#include <cstddef>
#include <exception>
#include <vector>

namespace sherd {

/// body(i) for begin..end-1 in parallel.  Each comes to its end, or to its error; the error of the
/// lowest is thrown then.
///
/// TBB's own loop stops at the first error, and with it every loop that runs within it: OpenVDB's
/// return with half their work done, and what comes after them reads what was never written.
template <class Body>
void eachToItsEnd(std::size_t begin, std::size_t end, const Body& body) {
  std::vector<std::exception_ptr> errors(end - begin);
  tbb::parallel_for(begin, end, [&](std::size_t i) {
    try {
      body(i);
    } catch (...) {
      errors[i - begin] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace sherd
