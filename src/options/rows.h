// The rows of the table of options, by stage.
#pragma once

#include <sherd/options.h>

#include <span>

namespace sherd {

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
