// The extension module pysherd._core: what the package's Python code calls.  Functions that work
// return a Job.
#include <sherd/sherd.h>

#include "bind_fractures.h"
#include "errors.h"
#include "job.h"
#include "options.h"
#include "process.h"
#include "sealed.h"
#include "solid.h"
#include "stream.h"

NB_MODULE(_core, module) {
  nanobind::set_leak_warnings(false);  // an interpreter that closes may leave fractures
  pysherd::bindErrors();
  pysherd::bindProcess(module);
  pysherd::bindJobs(module);
  pysherd::bindOptions(module);
  pysherd::bindSealed(module);
  pysherd::bindSolids(module);
  pysherd::bindFractures(module);
  pysherd::bindStreams(module);
  module.def("version", sherd::version);
}
