// Text that a terminal shows as it is.
#pragma once

#include <string>
#include <string_view>

namespace sherd {

/// Whether a line break is escaped as the other control characters are.
enum class LineBreaks { escaped, kept };

/// Escapes what a terminal would obey instead of showing it: the control characters U+0000 to
/// U+001F and U+007F to U+009F as \u001b, bytes that are not UTF-8 as \x9b.  All other text stays,
/// so escaping twice is escaping once; and those of characters are JSON's, so JSON keeps its
/// meaning.
///   source  The Unicode Standard 15.0, table 3-7 (well-formed UTF-8)
[[nodiscard]] std::string printable(std::string_view text, LineBreaks breaks = LineBreaks::escaped);

}  // namespace sherd
