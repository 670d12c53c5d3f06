// Reading whole files.
#pragma once

#include <filesystem>
#include <string>

#include "base/memory_budget.h"

namespace sherd {

/// Reads a whole file into memory.
///   memory  charged with its size; null: no limit
///   throws  Error(input) absent, a directory, not a regular file, unreadable, larger than `memory`
[[nodiscard]] std::string readFileBytes(const std::filesystem::path& file,
                                        MemoryBudget* memory = nullptr);

}  // namespace sherd
