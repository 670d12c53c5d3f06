// Checks that an output file replaces no input and no file of a fracture.
#include "cli/terminal/output_path.h"

#include <sherd/error.h>
#include <sherd/folder.h>

#include <optional>

namespace sherd::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& option, const fs::path& output,
                         const std::string& why) {
  throw Error(ErrorCode::usage,
              option + ": " + output.string() + " " + why + "; name another file");
}

}  // namespace

void requireNoInput(const std::string& option, const fs::path& output,
                    std::span<const fs::path> inputs) {
  // A killed run may have left the folder half replaced, which hides files and the manifest.
  requireSettled(output.has_parent_path() ? output.parent_path() : ".");
  std::error_code failed;
  if (!fs::exists(fs::symlink_status(output, failed))) return;  // nothing is replaced
  for (const fs::path& input : inputs) {
    if (fs::equivalent(input, output, failed)) refuse(option, output, "is read by this command");
  }
  // Resolves links of the folders only; a link at the file itself is refused when it is written.
  const fs::path whole = fs::absolute(output);
  const fs::path file = fs::weakly_canonical(whole.parent_path(), failed) / whole.filename();
  if (failed) return;
  if (const std::optional<fs::path> manifest = manifestListing(file)) {
    refuse(option, output, "is listed by the fracture's " + manifest->string());
  }
}

void requireDifferent(const std::string& option, const fs::path& output, const std::string& other,
                      const fs::path& otherOutput) {
  std::error_code none;
  const auto real = [&none](const fs::path& file) {
    const fs::path whole = fs::absolute(file);
    return fs::weakly_canonical(whole.parent_path(), none) / whole.filename();
  };
  if (real(output) == real(otherOutput)) refuse(option, output, "is named by " + other + " too");
}

}  // namespace sherd::cli
