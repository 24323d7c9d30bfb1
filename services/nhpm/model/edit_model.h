#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/msg/planning.h"
#include "common/runtime/result.h"

namespace conav::nhpm {

/// Which model answered. Equal checksums give equal bits for equal queries.
struct ModelIdentity {
  std::string name;      // "nhpm", "glpf", or what the weights file says
  std::string version;   // for people
  std::string checksum;  // SHA-256 of the parameters, 64 hexadecimal digits
  bool operator==(const ModelIdentity&) const = default;
};

/// What the service serves, the planner embeds and the evaluator compares.
///
/// Shapes:  one answer per query, in order; grids as large as the query's belief; masked as
///          PerceptionAnswer says.
/// Errors:  kInvalidArgument (CheckPerceptionQuery), kUnavailable (good queries of a grid size that
///          the model was not made for), kOutOfRange (the model's arithmetic overflows). Never throws.
///          An empty batch gives an empty answer.
/// Threads: const and safe to call concurrently.
/// Source:  paper section 4, F_theta(x, tau, o).
class EditModel {
 public:
  virtual ~EditModel() = default;
  [[nodiscard]] virtual Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) const = 0;
  virtual const ModelIdentity& identity() const = 0;
};

}  // namespace conav::nhpm
