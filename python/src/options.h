// The option table, as Python sees it.
#pragma once

#include <nanobind/nanobind.h>
#include <sherd/options.h>

#include <string>
#include <utility>
#include <vector>

namespace pysherd {

/// Names of options and texts of values, in the order of the table; an option that repeats may
/// appear several times.
using GivenOptions = std::vector<std::pair<std::string, std::string>>;

/// Sets the options by the rows of the table, and reads the file of `seeds`.
///   throws  Error(usage) naming the keyword; Error(input) the file of seeds
[[nodiscard]] sherd::RunOptions optionsFrom(const GivenOptions& given);

/// Sets options that have values already; the same otherwise.
[[nodiscard]] sherd::RunOptions optionsFrom(const GivenOptions& given, sherd::RunOptions before);

/// Sets what the preset among the given options draws by the fracture's seed, and returns it.
[[nodiscard]] GivenOptions drawnByPreset(const GivenOptions& given, sherd::RunOptions& options);

/// Returns options as given, but for those with their defaults and those of their material.
[[nodiscard]] GivenOptions givenOf(const sherd::RunOptions& options);

/// Whether an option is among those given.
[[nodiscard]] bool isGiven(const GivenOptions& given, const char* name);

/// Returns the keyword of an option: its name with underscores.
[[nodiscard]] std::string keywordOf(std::string name);

/// Describes the options with these names, spelled as keywords, for sherd::idleOptions.
///   input  the file that is broken; empty: there is none
[[nodiscard]] sherd::OptionUse useOf(std::vector<std::string> names, std::string input);

void bindOptions(nanobind::module_& module);

}  // namespace pysherd
