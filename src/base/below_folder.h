// Files below a folder, and nowhere else: whoever wrote a list of them, whatever links are there.
#pragma once

#include <filesystem>
#include <string>

namespace sherd {

/// Whether a name is a path that stays below its folder: relative, without ".", ".." or bytes of 0,
/// no part longer than 255 bytes, and not a folder's name with a slash behind it.
[[nodiscard]] bool isBelowFolder(const std::string& name);

/// Whether a path below a folder leads to something in the folder once every symbolic link on the
/// way is followed: the rule for what is read.  A path to nothing does where its folder does.
///   name    relative, without ".."
///   throws  Error(input) a link on the way leads to itself, or cannot be read
[[nodiscard]] bool staysWithin(const std::filesystem::path& folder,
                               const std::filesystem::path& name);

/// Make sure that every folder between `folder` and a file below it is one, or absent: a symbolic
/// link in its place could lead anywhere.
///   throws  Error(output)
void requireOwnSubfolder(const std::filesystem::path& folder, const std::string& file);

/// The same, and that the file itself is a regular one, or absent.
///   throws  Error(output)
void requireOwnFile(const std::filesystem::path& folder, const std::string& file);

/// Whether a file below a folder is there as requireOwnFile wants it: no link leads to it.
[[nodiscard]] bool isOwnFile(const std::filesystem::path& folder, const std::string& file);

}  // namespace sherd
