#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "operator/timeline/heard.h"

namespace conav::operators {

/// Something that was heard.
struct Moment {
  static constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

  double position_s = 0.0;
  /// Number of the moment that says the same anew: whoever hears that one need not hear this one.
  std::size_t replaced_by = kNever;
  Heard heard;
};

/// A recorded run, all of it. Positions: s since its beginning.
struct Timeline {
  console::Session session;
  double duration_s = 0.0;
  std::vector<Moment> moments;  // by position
  std::vector<console::Mark> marks;
};

}  // namespace conav::operators
