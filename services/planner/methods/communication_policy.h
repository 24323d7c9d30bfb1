#pragma once

#include <cstdint>
#include <memory>

#include "common/runtime/random.h"
#include "planner/decision/method.h"
#include "planner/methods/method_config.h"

namespace conav::planner {

/// What a rule may look at when it decides whether a picture is sent now.
struct CommunicationMoment {
  int moves_since_picture = 0;  // since the start, before the first one
  bool sent_before = false;
  bool guidance_fails = false;  // GuidanceFails()
};

/// Whether the operator's path no longer leads the robot on: a known wall lies on what is left of
/// it, the robot is beside it or at its end, or it expired. Without any path so far: no.
bool GuidanceFails(const Situation& situation);

CommunicationMoment MomentOf(const Situation& situation);

/// A rule that sends pictures in the place of the search, for comparison with it. The heading is
/// the one with the largest expected information, less what its turn costs, of those not sent yet.
/// Threads: one worker's.
class CommunicationPolicy {
 public:
  virtual ~CommunicationPolicy() = default;
  /// Whether a picture shall be sent before the next move. Asked once per decision.
  virtual bool Wants(const CommunicationMoment& moment) = 0;
  /// Expected edits, in cells, below which a view is not sent nevertheless.
  virtual double least_information() const { return 0.0; }
  /// CommunicationConfig::turn_cost, expected edits per radian.
  double turn_cost() const { return turn_cost_; }
  void set_turn_cost(double turn_cost) { turn_cost_ = turn_cost; }

 private:
  double turn_cost_ = 0.0;
};

class NeverPolicy final : public CommunicationPolicy {
 public:
  bool Wants(const CommunicationMoment&) override { return false; }
};

/// With a fixed probability, drawn at each decision.
class RandomPolicy final : public CommunicationPolicy {
 public:
  RandomPolicy(double probability, std::uint64_t seed) : probability_(probability), random_(seed) {}
  bool Wants(const CommunicationMoment&) override { return random_.Chance(probability_); }

 private:
  double probability_;
  Random random_;
};

/// After every so many moves.
class EveryMovesPolicy final : public CommunicationPolicy {
 public:
  explicit EveryMovesPolicy(int moves) : moves_(moves) {}
  bool Wants(const CommunicationMoment& moment) override {
    return moment.moves_since_picture >= moves_;
  }

 private:
  int moves_;
};

/// When the operator's path fails; once per place, as one who has answered has no better one.
class WhenBlockedPolicy final : public CommunicationPolicy {
 public:
  bool Wants(const CommunicationMoment& moment) override {
    return moment.guidance_fails && (moment.moves_since_picture > 0 || !moment.sent_before);
  }
};

/// Whenever the best view is worth it.
class ThresholdPolicy final : public CommunicationPolicy {
 public:
  explicit ThresholdPolicy(double cells) : cells_(cells) {}
  bool Wants(const CommunicationMoment&) override { return true; }
  double least_information() const override { return cells_; }

 private:
  double cells_;
};

/// Null for policy "search".
std::unique_ptr<CommunicationPolicy> MakeCommunicationPolicy(const CommunicationConfig& config,
                                                             std::uint64_t seed);

}  // namespace conav::planner
