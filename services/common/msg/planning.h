#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/search_report.h"
#include "common/runtime/result.h"

/// Domain values of perception queries and, by search_report.h, of the planner's reports; see idl/conav_planning.idl.
namespace conav {

/// Who can predict the operator's edits: the network of the paper, or the GLPF.
inline constexpr const char* kNhpmModel = "nhpm";
inline constexpr const char* kGlpfModel = "glpf";
inline constexpr std::array kPerceptionModels{kNhpmModel, kGlpfModel};
/// Where nobody says otherwise.
inline constexpr const char* kDefaultPerceptionModel = kNhpmModel;

/// How would the operator edit `belief` after the robot went `path` and sent a picture from `cell`
/// towards `heading_rad` that shows `visible`? Paper section 4: (x, tau, o).
struct PerceptionQuery {
  BeliefGrid belief;       // x: P(wall) in [0, 1]
  std::vector<Cell> path;  // tau
  Cell cell;
  double heading_rad = 0.0;
  VisibleCells visible;  // o
  bool operator==(const PerceptionQuery&) const = default;
};

/// Probabilities that the operator adds or removes a wall, cell by cell; masked as in paper section
/// 4 (nothing to add where the belief has a wall, nothing to remove where it has none, never on the
/// border).
struct PerceptionAnswer {
  Grid<float> add;
  Grid<float> remove;
  bool operator==(const PerceptionAnswer&) const = default;
};

/// A batch of questions; (client, request_id) makes a repeat harmless. All beliefs have one shape.
struct PerceptionRequest {
  std::string client;
  std::uint64_t request_id = 0;
  std::string replica;           // node that shall answer; empty = any
  std::string model;             // name wanted; empty = whatever is served
  std::string model_checksum;    // SHA-256 wanted; empty = any
  std::string person;            // whose edits; empty = the average operator's
  std::uint32_t timeout_ms = 0;  // how long the asker waits from the arrival on; 0 = not said
  std::vector<PerceptionQuery> queries;
  bool operator==(const PerceptionRequest&) const = default;
};

enum class PerceptionStatus : std::uint8_t { kOk, kRefused, kBusy };

/// Answers in the order of the queries; none, and a reason, when refused or busy.
struct PerceptionReply {
  std::string client;
  std::uint64_t request_id = 0;
  std::string replica;
  PerceptionStatus status = PerceptionStatus::kOk;
  std::string reason;
  std::string model;
  std::string model_version;
  std::string model_checksum;
  std::vector<PerceptionAnswer> answers;
  bool operator==(const PerceptionReply&) const = default;
};

/// ||p_add||_1 + ||p_remove||_1, in cells: the expected information reward of paper section 5.2.
/// Summed in double, row-major, add before remove, so that every model behind the seam gives the
/// same bits.
double ExpectedEdits(const PerceptionAnswer& answer);

/// Names what makes `query` impossible to answer: an empty belief or one with values outside of
/// [0, 1], a cell outside of the belief, a heading that is no number.
/// Errors: kInvalidArgument. Every perception model refuses a batch that holds such a query.
[[nodiscard]] Result<void> CheckPerceptionQuery(const PerceptionQuery& query);

}  // namespace conav
