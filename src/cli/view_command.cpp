// `sherd view`: a page that shows a fracture.
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/folder.h>
#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <memory>

#include "base/memory.h"
#include "base/text/printable.h"
#include "cli/arguments/option_text.h"
#include "cli/terminal/command.h"
#include "cli/terminal/held_files.h"
#include "cli/terminal/interrupts.h"
#include "cli/terminal/output_path.h"

extern char** environ;

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::string path;
  std::string output;
  std::uint64_t maxBytes = ViewerOptions{}.maxBytes;
  std::string unit;
  std::string up;
  bool opens = false;
};

// The page beside the folder: bowl.html for bowl/, and for bowl/manifest.json.
fs::path pageBeside(const fs::path& path) {
  fs::path folder = fs::absolute(path).lexically_normal();
  if (folder.filename() == kManifestName) folder = folder.parent_path();
  if (!folder.has_filename()) folder = folder.parent_path();
  const std::string name = folder.filename().string() + ".html";
  const fs::path given = path.lexically_normal();
  const bool isHere = given.is_relative() && given.has_filename() && given != "." &&
                      !given.has_parent_path() && given.filename() != kManifestName;
  return isHere ? fs::path(name) : folder.parent_path() / name;
}

// Starts the browser that the desktop is set to; a failure is no error, as the page is written.
void openInBrowser(const fs::path& page) {
  const std::string file = fs::absolute(page).string();
  const std::array<const char*, 3> words = {"xdg-open", file.c_str(), nullptr};
  pid_t process = 0;
  const int failed = ::posix_spawnp(&process, words[0], nullptr, nullptr,
                                    const_cast<char* const*>(words.data()), environ);
  int status = 0;
  if (failed != 0 || ::waitpid(process, &status, 0) != process || status != 0) {
    printMessage("sherd: warning: xdg-open did not open " + file);
  }
}

void runView(const ViewArguments& arguments) {
  const fs::path output =
      arguments.output.empty() ? pageBeside(arguments.path) : fs::path(arguments.output);
  setInterruptedState(output.string() + " is as it was before");
  requireNoInput("--output", output);
  const ViewerOptions options{.maxBytes = arguments.maxBytes,
                              .unit = arguments.unit,
                              .up = arguments.up.empty() ? '\0' : arguments.up.front()};
  const Viewer viewer =
      viewerOf(arguments.path, options, {.maxMemory = freeMemory()}, &untilInterrupted());
  HeldFiles files;
  OutputFile(files, output).write(viewer.html);
  for (const std::string& warning : viewer.warnings) {
    printMessage("sherd: warning: " + warning + " (--max-size)");
  }
  finish(files, [&] { printResult(printable(output.string()) + "\n"); });
  if (arguments.opens) openInBrowser(output);
}

}  // namespace

void addViewCommand(CLI::App& app, Action& run) {
  CLI::App* command = app.add_subcommand("view", "Make a page that shows a fracture in a browser");
  auto arguments = std::make_shared<ViewArguments>();
  command->add_option("PATH", arguments->path, "A fracture's folder, or its manifest.json")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "The page; default beside the folder: bowl.html for bowl/")
      ->type_name("FILE");
  command
      ->add_option("--max-size", arguments->maxBytes,
                   "Size of the meshes and textures in the page, such as 64M (powers of 1024); "
                   "larger meshes are simplified")
      ->transform(size())
      ->type_name("SIZE")
      ->default_str("64M");
  command
      ->add_option(
          "--unit", arguments->unit,
          "The unit of the mesh's lengths, shown beside them; default that of the fracture")
      ->check(CLI::Validator(
          [](const std::string& text) -> std::string {
            return text.size() <= 16 ? "" : "'" + text + "' is longer than 16 bytes";
          },
          ""));
  command
      ->add_option("--up", arguments->up,
                   "The mesh's axis that points up; default that of the fracture")
      ->check(CLI::IsMember({"x", "y", "z"}));
  command->add_flag("--open", arguments->opens, "Open the page in a browser, by xdg-open");
  command->callback([arguments, &run] { run = [arguments] { runView(*arguments); }; });
}

}  // namespace sherd::cli
