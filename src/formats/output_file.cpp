// Writing files to a path or to a sink.
#include <sherd/files.h>

#include "base/files/atomic_file.h"

namespace sherd {

void OutputFile::write(std::string_view bytes) const {
  if (!sink_) return writeWhole(name_, bytes);
  sink_->take(name_.generic_string(), [&](const ByteSink& sink) { sink(bytes); });
}

void OutputFile::write(const Content& content) const {
  if (sink_) return sink_->take(name_.generic_string(), content);
  AtomicFile out(name_);
  content([&](std::string_view bytes) { out.write(bytes); });
  out.commit();
}

}  // namespace sherd
