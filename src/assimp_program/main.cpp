// sherd-assimp: reads a mesh on standard input by Assimp and writes it to standard output as
// src/formats/mesh/mesh_stream.h has it, for readByAssimp().  A crash here does not end Sherd.
//
// usage: sherd-assimp fbx|dae MEMORY_MIB CPU_SECONDS
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

#include "assimp_program/scene.h"
#include "formats/mesh/mesh_stream.h"

namespace {

void limit(int resource, rlim_t most) {
  const rlimit limits{most, most};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &limits);
}

std::string readAll(int file) {
  std::string out;
  std::string buffer(std::size_t{1} << 20, '\0');
  for (ssize_t got = 1; got > 0;) {
    got = ::read(file, buffer.data(), buffer.size());
    if (got > 0) out.append(buffer, 0, static_cast<std::size_t>(got));
  }
  return out;
}

int refuse(const std::string& why) {
  std::fputs(why.c_str(), stdout);
  return 3;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return refuse("usage: sherd-assimp fbx|dae MEMORY_MIB CPU_SECONDS");
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // end with the parent process
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_AS, std::strtoull(argv[2], nullptr, 10) << 20);
  const rlim_t seconds = std::strtoull(argv[3], nullptr, 10);
  const rlimit cpu{seconds, seconds + 1};  // SIGXCPU first: it names the cause
  ::setrlimit(RLIMIT_CPU, &cpu);
  try {
    const std::string stream = sherd::streamOf(sherd::readScene(readAll(0), argv[1]));
    return std::fwrite(stream.data(), 1, stream.size(), stdout) == stream.size() ? 0 : 1;
  } catch (const std::bad_alloc&) {
    return refuse("it needs more memory than its limit");
  } catch (const std::exception& e) {
    return refuse(e.what());
  }
}
