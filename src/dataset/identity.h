// What shapes a dataset, as text.
#pragma once

#include <sherd/dataset.h>

#include <string>

namespace sherd {

/// Whether a text, also one of an earlier version, is the identity of a dataset with these options.
[[nodiscard]] bool isIdentityOf(const DatasetOptions& options, const std::string& text);

/// Returns the options as the layout takes them: loaders of Breaking Bad read only vertices and
/// faces, and every file as a piece.
[[nodiscard]] DatasetOptions laidOut(DatasetOptions options);

}  // namespace sherd
