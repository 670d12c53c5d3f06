// Options that contradict each other, or do nothing beside others.
#pragma once

#include <sherd/dataset.h>

#include <string>
#include <vector>

#include "cli/drawn_options.h"
#include "cli/fracture_options.h"

namespace sherd::cli {

/// What a command line came to.
struct ParsedOptions {
  const CLI::App& command;
  const FractureOptions& fracture;
  const WriteArguments& write;
  std::string mesh{};                       ///< of sherd fracture; empty: a whole library
  bool dryRun = false;                      ///< of sherd dataset, and so is the rest
  const DatasetOptions* dataset = nullptr;  ///< null: sherd fracture
  const std::vector<DrawnOption>* drawn = nullptr;
};

/// Check the options that were given against each other, by the table in option_rules.cpp.
///   return  a sentence for each option that does nothing
///   throws  Error(usage) options contradict each other
[[nodiscard]] std::vector<std::string> idleOptions(const ParsedOptions& options);

}  // namespace sherd::cli
