#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/search_report.h"
#include "common/runtime/result.h"

/// Domain values of perception queries; with search_report.h, also of the planner's reports. See
/// idl/conav_msgs.
namespace conav {

/// The models that can predict the operator's edits.
enum class PerceptionModelKind {
  kNhpm,            // the network of the paper for mazes, the default
  kGlpf,            // the GLPF, its baseline
  kEncoderDecoder,  // the network of the paper for rasters
  kAuto,            // kNhpm and kGlpf, weighted by the person's own edits: in the planner only
};

inline constexpr std::array kPerceptionModels{
    PerceptionModelKind::kNhpm, PerceptionModelKind::kGlpf, PerceptionModelKind::kEncoderDecoder};
inline constexpr std::array kPlannersModels{PerceptionModelKind::kNhpm, PerceptionModelKind::kGlpf,
                                            PerceptionModelKind::kEncoderDecoder,
                                            PerceptionModelKind::kAuto};

/// As in configurations and in the identity of the model that answers.
constexpr std::string_view Name(PerceptionModelKind model) {
  switch (model) {
    case PerceptionModelKind::kNhpm:
      return "nhpm";
    case PerceptionModelKind::kGlpf:
      return "glpf";
    case PerceptionModelKind::kEncoderDecoder:
      return "encoder-decoder";
    case PerceptionModelKind::kAuto:
      return "auto";
  }
  return "";
}

/// The one that is loaded and served: the network of kAuto.
constexpr PerceptionModelKind Served(PerceptionModelKind model) {
  return model == PerceptionModelKind::kAuto ? PerceptionModelKind::kNhpm : model;
}

/// Asks: how would the operator edit `belief` after the robot took `path` and sent a picture from
/// `cell` towards `heading_rad` that shows `visible`? Paper section 4: (x, tau, o).
struct PerceptionQuery {
  BeliefGrid belief;       // x: P(wall) in [0, 1]
  std::vector<Cell> path;  // tau
  Cell cell;
  double heading_rad = 0.0;
  VisibleCells visible;  // o
  bool operator==(const PerceptionQuery&) const = default;
};

/// A query without its belief, for the many that one decision asks about one belief.
struct ShownView {
  std::vector<Cell> path;
  Cell cell;
  double heading_rad = 0.0;
  VisibleCells visible;
  bool operator==(const ShownView&) const = default;
};

/// Probabilities that the operator adds or removes a wall, cell by cell. Masked as in paper section
/// 4: nothing to add where the belief has a wall, nothing to remove where it has none, never on the
/// border.
struct PerceptionAnswer {
  Grid<float> add;
  Grid<float> remove;
  bool operator==(const PerceptionAnswer&) const = default;
};

/// A batch of queries; (client, request_id) makes a repeat harmless. All beliefs have one shape.
struct PerceptionRequest {
  std::string client;
  std::uint64_t request_id = 0;
  std::string replica;           // the node to answer; empty = any
  std::string model;             // requested model; empty = whichever is served
  std::string model_checksum;    // requested SHA-256; empty = any
  std::string person;            // whose edits; empty = the average operator's
  std::uint32_t timeout_ms = 0;  // how long the client waits from arrival; 0 = unknown
  std::vector<PerceptionQuery> queries;
  bool operator==(const PerceptionRequest&) const = default;
};

enum class PerceptionStatus : std::uint8_t { kOk, kRefused, kBusy };

/// Answers in the order of the queries; none, plus a reason, when rejected or busy.
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

/// A probability of an edit in whole units of 2^-42, by rounding: sums of them are exact, so that
/// neither the order of the cells nor what else is on the map changes the bits of a sum.
inline std::int64_t EditUnits(float probability) {
  constexpr double kShift = 1536.0;  // the last bit of numbers near it is 2^-42
  return std::bit_cast<std::int64_t>(kShift + static_cast<double>(probability)) -
         std::bit_cast<std::int64_t>(kShift);
}
/// Of so many units; at most 2^20 edits.
inline double EditsOf(std::int64_t units) { return std::ldexp(static_cast<double>(units), -42); }

/// ||p_add||_1 + ||p_remove||_1, in cells: the expected information reward of paper section 5.2.
/// Of EditUnits, so that every model gives the same bits.
double ExpectedEdits(const PerceptionAnswer& answer);

/// Checks that `query` can be answered. Rejects an empty belief or one with values outside of [0,
/// 1], a cell outside the belief, and a heading that is NaN.
/// Errors: kInvalidArgument. Every perception model rejects a batch with such a query.
[[nodiscard]] Result<void> CheckPerceptionQuery(const PerceptionQuery& query);
/// The two parts of it.
[[nodiscard]] Result<void> CheckBelief(const BeliefGrid& belief);
[[nodiscard]] Result<void> CheckShownView(const BeliefGrid& belief, const ShownView& view);

}  // namespace conav
