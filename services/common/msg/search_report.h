#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/robot.h"

/// Domain values of a planner's search report; see idl/conav_msgs.
namespace conav {

/// The terms of a reward, or of a return, each discounted like it: Sum() is the reward.
/// Source: paper, appendix C; `progress` is our addition.
struct RewardTerms {
  double goals = 0.0;          // r_g of goals reached
  double steps = 0.0;          // R_env of all other steps
  double progress = 0.0;       // steps saved on the way to the nearest goal
  double guidance = 0.0;       // R_guidance
  double smoothness = 0.0;     // R_smooth
  double information = 0.0;    // R_info
  double communication = 0.0;  // -c

  /// In this order the search has always added them: the same seed gives the same decisions.
  double Sum() const {
    return goals + steps + guidance + smoothness + progress + information + communication;
  }
  RewardTerms& operator+=(const RewardTerms& other) {
    goals += other.goals;
    steps += other.steps;
    progress += other.progress;
    guidance += other.guidance;
    smoothness += other.smoothness;
    information += other.information;
    communication += other.communication;
    return *this;
  }
  friend RewardTerms operator*(double factor, const RewardTerms& terms) {
    return {factor * terms.goals,        factor * terms.steps,      factor * terms.progress,
            factor * terms.guidance,     factor * terms.smoothness, factor * terms.information,
            factor * terms.communication};
  }
  bool operator==(const RewardTerms&) const = default;
};

/// One action at the root of a search.
struct SearchAction {
  CommandKind kind = CommandKind::kMove;
  Cell target;
  double heading_rad = 0.0;
  std::uint32_t visits = 0;
  double mean_value = 0.0;
  double information_gain = 0.0;
  double feasibility = 1.0;
  RewardTerms terms;  // means over the visits; add up to mean_value where the report has terms
  bool operator==(const SearchAction&) const = default;
};

/// A node of the search's tree and the action that leads to it.
struct ReportedNode {
  int parent = -1;  // index into SearchReport::tree, below the own one; -1 = the root
  CommandKind kind = CommandKind::kMove;
  Cell target;               // cell that a move enters, or that a picture is sent from
  double heading_rad = 0.0;  // of a picture
  std::uint32_t visits = 0;
  double mean_value = 0.0;
  double feasibility = 1.0;
  bool operator==(const ReportedNode&) const = default;
};

/// A picture that the search asked the perception model about, on whatever path.
struct ReportedView {
  Cell cell;
  double heading_rad = 0.0;
  /// Expected number of cells edited; the largest over the paths on which it was asked.
  double information_gain = 0.0;
  bool operator==(const ReportedView&) const = default;
};

/// Bounds of a report, so that its size has one: about 28 kB.
inline constexpr std::size_t kMaxReportedNodes = 256;
inline constexpr std::size_t kMaxReportedViews = 512;

struct SearchReport {
  SimTime stamp;
  std::string world;
  std::string robot;
  std::string method;
  std::uint64_t decision = 0;
  Cell cell;
  std::uint64_t belief_revision = 0;
  std::uint64_t guidance_revision = 0;
  std::vector<SearchAction> actions;
  int chosen = -1;  // index into actions; -1 = wait
  bool has_terms = false;
  /// The most visited nodes, the root first; empty unless asked for.
  std::vector<ReportedNode> tree;
  std::vector<ReportedView> views;
  std::uint32_t iterations = 0;
  std::uint32_t nodes = 0;
  std::uint32_t perception_queries = 0;
  std::uint32_t perception_cached = 0;
  std::string perception_model;
  double duration_ms = 0.0;
  bool operator==(const SearchReport&) const = default;
};

}  // namespace conav
