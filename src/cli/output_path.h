// Files that a command writes where others may be.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace sherd::cli {

/// Refuse to replace a file that is one of a fracture, by the manifest in its folder or one
/// above it, or one that is read.  What a manifest lists is replaced by `sherd fracture` only.
///   option  before the sentence: "--csv"
///   inputs  files that are read
///   throws  Error(usage); Error(input) the file's folder is a fracture's that a killed run left
///           half replaced, and that cannot be undone (see requireSettled)
void requireNoInput(const std::string& option, const std::filesystem::path& output,
                    std::span<const std::filesystem::path> inputs = {});

/// Refuse two files that are written by one command and are the same.
///   throws  Error(usage)
void requireDifferent(const std::string& option, const std::filesystem::path& output,
                      const std::string& other, const std::filesystem::path& otherOutput);

}  // namespace sherd::cli
