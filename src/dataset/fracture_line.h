// What the journal notes of a fracture.
#pragma once

#include <sherd/dataset.h>

#include "dataset/journal.h"
#include "folder/manifest.h"

namespace sherd {

/// The unbroken object among an object's fractures.
inline constexpr const char* kWholeName = "whole";

/// The line of a fracture, but for its files.
class FractureLine {
 public:
  FractureLine(const std::string& name, const PlannedFracture& planned, std::uint64_t seed,
               int attempt, const DrawnOptions& drawn);

  ///   result  as it was before it is moved into a unit box
  ///   names   of its files, which `files` has stored under other names
  void addFragments(const FractureResult& result, const FractureFiles& names,
                    const StagedFiles& files, bool poses);

  [[nodiscard]] const Json& json() const { return line_; }

 private:
  std::uint64_t seed_;
  Json line_;
};

}  // namespace sherd
