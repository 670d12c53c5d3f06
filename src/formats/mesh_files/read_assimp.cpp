// Reads FBX and DAE files by Assimp, in a separate process.
#include "formats/mesh_files/read_assimp.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sherd/files.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "base/files/unfinished.h"
#include "base/text/text_scan.h"
#include "formats/mesh/beside.h"
#include "formats/mesh/mesh_stream.h"
#include "formats/mesh_files/stated_coordinates.h"

extern char** environ;

namespace sherd {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "sherd-assimp";

class FileDescriptor {
 public:
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() { close(); }
  int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

Error cannotStart(const std::string& what) {
  return Error(ErrorCode::internal,
               std::string(kProgram) + " cannot be started: " + what + ": " + std::strerror(errno));
}

std::string findProgram(const MeshFile& file) {
  const AssimpProgram program = findAssimp();
  if (program.found) return program.found->string();
  throw inputError(file, "the program " + std::string(kProgram) +
                             ", which reads this format, is not at " +
                             program.tried.back().string() + " (install it, or set SHERD_ASSIMP)");
}

// Writes `bytes` to a new file and rewinds it.
void fill(const FileDescriptor& file, const std::string& bytes) {
  if (file.number() < 0) throw cannotStart("its input");
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(file.number(), bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno != EINTR) throw cannotStart("its input");
    done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
  }
  if (::lseek(file.number(), 0, SEEK_SET) != 0) throw cannotStart("its input");
}

// The running process; the destructor kills it.
class Child {
 public:
  // posix_spawn, not fork: other threads of this process may hold locks.
  Child(const std::string& program, const std::vector<std::string>& arguments, int in, int out) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments)
      argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawn_file_actions_adddup2(&files, in, 0);
    ::posix_spawn_file_actions_adddup2(&files, out, 1);
    ::posix_spawn_file_actions_addopen(&files, 2, "/dev/null", O_WRONLY, 0);
    // This process blocks signals, to wait for them in a thread, and ignores some; the child gets
    // the defaults, so that they end it.
    sigset_t none, usual;
    ::sigemptyset(&none);
    ::sigemptyset(&usual);
    ::sigaddset(&usual, SIGPIPE);
    ::sigaddset(&usual, SIGXFSZ);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setsigdefault(&attributes, &usual);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    const Uncut whole;
    errno = ::posix_spawn(&id_, program.c_str(), &files, &attributes, argv.data(), environ);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&files);
    if (errno != 0) throw cannotStart(program);
    running_ = Unfinished(id_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    (void)wait();
  }

  // Returns the status of waitpid(); 0 if the calling program disabled waiting for children.
  int wait() {
    running_.end();
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_ = -1;
  Unfinished running_;
};

// Returns all output of the process; nothing if it takes too long or writes too much.
std::optional<std::string> answerOf(int pipe, const AssimpLimits& limits, const MeshFile& file) {
  constexpr long long kPollMilliseconds = 100;

  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::seconds(limits.wallSeconds);
  std::string answer;
  GrowingMemory memory(file.memory);
  std::vector<char> buffer(std::size_t{1} << 20);
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    if (left.count() <= 0 || answer.size() >> 20 > limits.memoryMiB) return std::nullopt;
    pollfd ready{pipe, POLLIN, 0};
    checkpoint(file);
    const auto wait = std::min<long long>(left.count(), kPollMilliseconds);
    if (::poll(&ready, 1, static_cast<int>(wait)) <= 0) continue;
    const ssize_t got = ::read(pipe, buffer.data(), buffer.size());
    if (got == 0) return answer;
    memory.hold(answer.size() + buffer.size());
    if (got > 0) answer.append(buffer.data(), static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) throw cannotStart("its answer");
  }
}

// Reads textures that the file names but does not contain from beside it.
void readTextures(const MeshFile& file, RawMesh& mesh) {
  const std::vector<Texture> named = std::exchange(mesh.appearance.textures, {});
  std::vector<int> number;
  for (const Texture& texture : named) {
    if (texture.bytes.empty()) {
      number.push_back(textureBeside(file, texture.name, mesh));
    } else {
      number.push_back(static_cast<int>(mesh.appearance.textures.size()));
      mesh.appearance.textures.push_back(texture);
    }
  }
  for (Material& material : mesh.appearance.materials) {
    if (material.texture >= 0)
      material.texture = number[static_cast<std::size_t>(material.texture)];
  }
}

// Returns the folder of the shared library that holds this code; nothing where the program does.
std::optional<fs::path> libraryFolder(const fs::path& program) {
  Dl_info info{};
  std::error_code error;
  if (::dladdr(static_cast<const void*>(&kProgram), &info) == 0) return {};
  const fs::path file = fs::canonical(info.dli_fname, error);
  if (error || file == program) return {};
  return file.parent_path();
}

}  // namespace

AssimpProgram findAssimp() {
  AssimpProgram program;
  std::error_code error;
  if (const char* named = std::getenv("SHERD_ASSIMP"); named != nullptr) {
    program.tried.emplace_back(named);
  } else {
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    const fs::path here = self.parent_path();
    if (const auto library = libraryFolder(self)) program.tried = {*library / "bin" / kProgram};
    program.tried.insert(program.tried.end(),
                         {here / kProgram, here / SHERD_LIBEXEC_FROM_BIN / kProgram,
                          fs::path(SHERD_LIBEXEC) / kProgram});
  }
  for (const fs::path& path : program.tried) {
    if (::access(path.c_str(), X_OK) != 0 || !fs::is_regular_file(path, error)) continue;
    program.found = path;
    break;
  }
  return program;
}

AssimpLimits assimpLimits(std::size_t bytes, std::uint64_t memory) {
  const std::uint64_t mebibytes = bytes >> 20;
  const auto seconds = static_cast<unsigned>(30 + 2 * mebibytes);
  return {std::min(1024 + 64 * mebibytes, memory >> 20), seconds, 2 * seconds};
}

RawMesh readByAssimp(const MeshFile& file, const AssimpLimits& limits) {
  const std::string program = findProgram(file);
  charge(file, file.bytes.size());  // the process's copy
  const FileDescriptor in(::memfd_create("mesh", MFD_CLOEXEC));
  fill(in, file.bytes);
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw cannotStart("a pipe");
  const FileDescriptor from(ends[0]);
  FileDescriptor to(ends[1]);
  const char* format = file.format == MeshFormat::fbx ? "fbx" : "dae";
  Child child(program,
              {format, std::to_string(limits.memoryMiB), std::to_string(limits.cpuSeconds)},
              in.number(), to.number());
  to.close();
  const std::optional<std::string> answer = answerOf(from.number(), limits, file);
  const auto refuse = [&](const std::string& why) {
    return inputError(file, "cannot be read (Assimp " + why + ")");
  };
  if (!answer)
    throw refuse("took more than " + std::to_string(limits.wallSeconds) +
                 " s or answered more than " + std::to_string(limits.memoryMiB) + " MiB");
  const int status = child.wait();
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP)
      throw Error(ErrorCode::cancelled, file.name + ": reading was stopped");
    if (signal == SIGXCPU)
      throw refuse("took more than " + std::to_string(limits.cpuSeconds) + " s");
    throw refuse("stopped with signal " + std::to_string(signal));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    throw refuse("says: " + plainText(answer->substr(0, 160)));
  charge(file, answer->size());
  std::optional<RawMesh> mesh = meshFromStream(*answer, file.memory);
  if (!mesh) throw refuse("gave an invalid answer");
  for (std::string& warning : mesh->warnings) warning = file.name + ": " + warning;
  setStatedCoordinates(file, *mesh);
  readTextures(file, *mesh);
  return std::move(*mesh);
}

}  // namespace sherd
