// How much of a fracture is done, over all stages.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace sherd::cli {

/// Joins the fractions of the stages that Progress::report names to one of the whole run, 0..1,
/// which never falls.
class OverallProgress {
 public:
  ///   isExact  surfaces are Surface::exact, whose union and cut are stages of their own
  explicit OverallProgress(bool isExact);

  /// Sets the number of objects that are broken one after another; 1 until then.
  void setParts(std::size_t parts) { parts_ = parts; }

  /// Begins with the next object.
  void nextPart();

  /// Returns the share of the run that is done.  Stages without a known share change nothing.
  ///   fraction  of the stage
  double update(std::string_view stage, double fraction);

 private:
  struct Stage {
    std::string_view name;
    int rank;      ///< a stage ends those of lower ranks; those of one rank take turns
    double share;  ///< of the time
    double done = 0.0;
  };

  std::array<Stage, 9> stages_;
  std::size_t part_ = 0, parts_ = 1;
  double overall_ = 0.0;
};

}  // namespace sherd::cli
