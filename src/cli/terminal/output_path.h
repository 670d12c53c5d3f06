// Checks that an output file replaces no input and no file of a fracture.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace sherd::cli {

/// Refuses an output that is an input, or a file of a fracture by the manifest in its folder or one
/// above.  Only `sherd fracture` replaces files that a manifest lists.
///   option  prefix of the message: "--csv"
///   inputs  files that the command reads
///   throws  Error(usage); Error(input) a killed run left the folder half replaced, and that cannot
///           be undone (see requireSettled)
void requireNoInput(const std::string& option, const std::filesystem::path& output,
                    std::span<const std::filesystem::path> inputs = {});

/// Refuses two outputs of one command that are the same file.
///   throws  Error(usage)
void requireDifferent(const std::string& option, const std::filesystem::path& output,
                      const std::string& other, const std::filesystem::path& otherOutput);

}  // namespace sherd::cli
