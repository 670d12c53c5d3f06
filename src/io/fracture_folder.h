// The folder that a fracture goes into.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sherd {

/// Put a fracture into a folder in place of the one that is there, as writeFracture promises.
///   fresh   its files but for the manifest, relative to the folder
///   write   writes them and the manifest below the folder that it is given, whose sub-folders are
///           there
///   return  the manifest's path
///   throws  Error(output); what `write` throws
std::filesystem::path replaceFracture(
    const std::filesystem::path& folder, const std::vector<std::string>& fresh,
    const std::function<void(const std::filesystem::path&)>& write);

}  // namespace sherd
