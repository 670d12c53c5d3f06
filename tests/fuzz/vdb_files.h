// `.vdb` files for fuzzing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sherd::fuzz {

/// Small files of several types of grids, compressed in every way.
[[nodiscard]] std::vector<std::string> vdbFiles();

/// Read a file whole, and its grids of floats.
void readVdb(std::string_view bytes);

}  // namespace sherd::fuzz
