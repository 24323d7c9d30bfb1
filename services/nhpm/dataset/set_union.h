#pragma once

#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav::nhpm {

/// Joins sets in which no trajectory may come twice: it could be trained on and tested with.
class SetUnion {
 public:
  /// `name` names the set in messages, as a file does. Errors: kRefused; then nothing was added.
  [[nodiscard]] Result<void> Add(SegmentSet set, const std::string& name);

  SegmentSet Take() { return std::move(all_); }

 private:
  SegmentSet all_;
  std::vector<std::string> places_;  // of each trajectory: "a.pb.zst: trajectory 3"
};

}  // namespace conav::nhpm
