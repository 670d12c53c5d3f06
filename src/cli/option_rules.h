// Options that contradict each other, or do nothing with others.
#pragma once

#include <sherd/dataset.h>

#include <string>
#include <vector>

#include "cli/command.h"

namespace sherd::cli {

/// The options of a parsed command line.
struct ParsedOptions {
  const CLI::App& command;
  const RunOptions& run;
  std::string mesh{};                       ///< of sherd fracture; empty for sherd dataset
  bool dryRun = false;                      ///< of sherd dataset, as the fields below
  const DatasetOptions* dataset = nullptr;  ///< null: sherd fracture
};

/// Checks the given options against each other, by the rules in option_rules.cpp.
///   return  a sentence for each option that does nothing
///   throws  Error(usage) options contradict each other
[[nodiscard]] std::vector<std::string> idleOptions(const ParsedOptions& options);

}  // namespace sherd::cli
