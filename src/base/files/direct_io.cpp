// Writing past the system's cache.
#include "base/files/direct_io.h"

#include <fcntl.h>

namespace sherd {

void setDirect(int descriptor, bool direct) {
  const int flags = ::fcntl(descriptor, F_GETFL);
  if (flags < 0) return;
  (void)::fcntl(descriptor, F_SETFL, direct ? flags | O_DIRECT : flags & ~O_DIRECT);
}

}  // namespace sherd
