// Checks that untrusted paths, and symbolic links in them, stay below a folder.
#pragma once

#include <filesystem>
#include <string>

namespace sherd {

/// Whether a name is a path that stays below its folder: relative, without ".", ".." or zero bytes,
/// no component longer than 255 bytes, no trailing slash.
[[nodiscard]] bool isBelowFolder(const std::string& name);

/// Whether a path below a folder, with all symbolic links resolved, is in the folder: the rule for
/// files that are read.  For a path that does not exist, its parent decides.
///   name    relative, without ".."
///   throws  Error(input) a link on the way is a loop or cannot be read
[[nodiscard]] bool staysWithin(const std::filesystem::path& folder,
                               const std::filesystem::path& name);

/// Requires that every folder between `folder` and a file below it is a folder or absent: a
/// symbolic link there could lead out of `folder`.
///   throws  Error(output)
void requireOwnSubfolder(const std::filesystem::path& folder, const std::string& file);

/// The same, and that the file itself is a regular file or absent.
///   throws  Error(output)
void requireOwnFile(const std::filesystem::path& folder, const std::string& file);

/// Whether a regular file exists below a folder, without symbolic links in its path.
[[nodiscard]] bool isOwnFile(const std::filesystem::path& folder, const std::string& file);

/// Removes a file if isOwnFile.
///   throws  Error(output)
void removeOwnFile(const std::filesystem::path& folder, const std::string& file);

}  // namespace sherd
