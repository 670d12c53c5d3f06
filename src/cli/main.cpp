// The program `sherd`: one parse, one call, one catch.
#include <fcntl.h>
#include <poll.h>
#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/files/atomic_file.h"
#include "base/text/printable.h"
#include "base/threads.h"
#include "base/version.h"
#include "cli/arguments/command_line.h"
#include "cli/arguments/config_arguments.h"
#include "cli/evaluate/cgal_checks.h"
#include "cli/terminal/command.h"
#include "cli/terminal/interrupts.h"
#include "cli/terminal/uncaught.h"
#include "cli/terminal/worker_threads.h"

namespace sherd::cli {

void printResult(const std::string& text) {
  constexpr std::size_t kAtOnce = 4096;  // PIPE_BUF: a pipe that polls writable accepts so much
  constexpr int kMilliseconds = 100;
  const std::string shown = printable(text, LineBreaks::kept);
  std::string_view rest = shown;
  while (!rest.empty()) {
    stopIfInterrupted();
    pollfd to{STDOUT_FILENO, POLLOUT, 0};
    if (::poll(&to, 1, kMilliseconds) == 0) continue;
    const ssize_t n = ::write(STDOUT_FILENO, rest.data(), std::min(rest.size(), kAtOnce));
    if (n < 0 && errno != EINTR && errno != EAGAIN) {
      throw Error(ErrorCode::output, "standard output: " + reasonOf(errno));
    }
    rest.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
  }
}

void printMessage(const std::string& line) { std::fputs((printable(line) + "\n").c_str(), stderr); }

std::string sentenceOf(const Error& error) {
  std::string flags;
  for (const std::string& name : error.options()) flags += (flags.empty() ? "--" : ", --") + name;
  return error.what() + (flags.empty() ? flags : " (" + flags + ")");
}

namespace {

// A file size limit and a closed pipe must become errors with a message, not kill the process by a
// signal; and no opened file may get the number of a standard stream that the caller closed.
void prepareProcess() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (int stream = 0; stream <= 2; ++stream) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // Read only, so that writing to a closed standard output still fails.
    if (::open("/dev/null", stream == 2 ? O_WRONLY : O_RDONLY) != stream) std::_Exit(1);
  }
}

// Returns CLI11's message without its full stop and line breaks.
std::string oneLine(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

// Leaves the limit of memory out of an error's options where the command has none: it decides in
// the readers of all commands.
Action namingOwnLimit(Action run, const CLI::App& command) {
  static constexpr const char* kLimit = "max-memory";
  if (command.get_option_no_throw(std::string("--") + kLimit) != nullptr) return run;
  return [run = std::move(run)] {
    try {
      run();
    } catch (const Error& e) {
      OptionNames options = e.options();
      std::erase(options, kLimit);
      throw Error(e.code(), e.what(), std::move(options));
    }
  };
}

// Prints help and version itself; `run` stays empty then.
void parse(int argc, char** argv, Action& run) {
  CLI::App app("Breaks 3D models into fragments.", "sherd");
  const std::string version = std::string("sherd " SHERD_VERSION " (") + programLicense() + ")";
  app.set_version_flag("--version", version, "Print the version and the program's license");
  app.require_subcommand(1);
  const CLI::App* const configured[] = {addFractureCommand(app, run), addDatasetCommand(app, run),
                                        addAssemblageCommand(app, run)};
  addMergeCommand(app, run);
  addInspectCommand(app, run);
  addConvertCommand(app, run);
  addEvaluateCommand(app, run);
  addRenderCommand(app, run);
  addViewCommand(app, run);
  addOptionsCommand(app, run);
  addDevicesCommand(app, run);
  addDoctorCommand(app, run);
  app.footer(
      "Exit status: 0 done, 1 internal error, 2 usage, 3 input, 4 device, 5 output, 130 "
      "interrupted.");
  try {
    std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    checkArguments(app, arguments);
    for (const CLI::App* command : configured) {
      if (arguments.empty() || arguments.front() != command->get_name()) continue;
      arguments = expandedArguments({arguments.begin() + 1, arguments.end()}, *command);
      arguments.insert(arguments.begin(), command->get_name());
    }
    std::reverse(arguments.begin(), arguments.end());  // CLI11 expects reverse order
    app.parse(std::move(arguments));
    if (run) run = namingOwnLimit(std::move(run), *app.get_subcommands().front());
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) {
      throw Error(ErrorCode::usage, oneLine(e.what()) + " (try sherd --help)");
    }
    std::ostringstream text;
    app.exit(e, text, text);
    printResult(text.str());
  }
}

int report(ErrorCode code, const std::string& sentence) {
  claimExit(static_cast<int>(code));
  printMessage("sherd: " + (code == ErrorCode::cancelled ? interruptSentence() : sentence));
  return static_cast<int>(code);
}

int runProgram(int argc, char** argv) {
  try {
    endUncaughtOrderly();
    prepareProcess();
    watchForInterrupts();
    Action run;
    parse(argc, argv, run);
    if (run) {
      const auto workers = startedWorkers();
      run();
    }
    claimExit(0);
    return 0;
  } catch (const Error& e) {
    return report(e.code(), sentenceOf(e));
  } catch (const std::bad_alloc&) {
    return report(ErrorCode::internal, kNoMemory);
  } catch (const std::exception& e) {
    return report(ErrorCode::internal,
                  isOfThread(e) ? kNoThread : std::string("internal error: ") + e.what());
  }
}

}  // namespace
}  // namespace sherd::cli

int main(int argc, char** argv) { return sherd::cli::runProgram(argc, argv); }
