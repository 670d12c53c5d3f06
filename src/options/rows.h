// The rows of the table of options, by stage.
#pragma once

#include <sherd/options.h>

#include <limits>
#include <span>

#include "options/values.h"

namespace sherd {

// What rows of several stages use.
inline constexpr auto kFracture = [](auto& o) -> auto& { return o.fracture; };
inline constexpr int kMostHidden =
    std::numeric_limits<int>::max();  ///< of what only manifests hold
inline const NumberRange kShare = between(0.0, 1.0, "0..1");
inline const NumberRange kNotNegative{.text = "0 and up"};

[[nodiscard]] std::span<const FractureOptionRow> generalRows();
[[nodiscard]] std::span<const FractureOptionRow> solidRows();
[[nodiscard]] std::span<const FractureOptionRow> seedRows();
[[nodiscard]] std::span<const FractureOptionRow> growthRows();
[[nodiscard]] std::span<const FractureOptionRow> erosionRows();
[[nodiscard]] std::span<const FractureOptionRow> withheldRows();
[[nodiscard]] std::span<const FractureOptionRow> pointRows();
[[nodiscard]] std::span<const FractureOptionRow> fileRows();
[[nodiscard]] std::span<const FractureOptionRow> surfaceRows();

}  // namespace sherd
