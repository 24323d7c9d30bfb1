#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "nhpm/training/example.h"

// One user: its command; adaptation is looked for by name.

namespace conav::nhpm {

/// All trajectories of one participant, in the order of the file.
struct Person {
  std::string participant;
  SegmentSet set;
};

/// By participant, in the order of first appearance.
std::vector<Person> PeopleOf(const SegmentSet& set);

/// The person of that name; for an empty name the only one.
/// Errors: kInvalidArgument, naming the people of the data.
[[nodiscard]] Result<Person> FindPerson(const std::vector<Person>& people,
                                        const std::string& participant);

/// The data of an adaptation: a set of examples for each trajectory, or for each segment if there
/// is only one trajectory. Requires CheckOneSize(set).
std::vector<ExampleSet> AdaptationGroups(const SegmentSet& set, const InputSelection& inputs);

/// When a network is adapted to a person, layers below this one keep the base's weights.
inline constexpr int kFirstAdaptedLayer = 2;

struct AdaptOptions {
  int epochs = 60;    // at most
  int patience = 10;  // stop after this many epochs without a better held-out loss
  int batch = 16;
  double learning_rate = 1e-3;
  /// The result is a moving mean of the weights: each step mixes in this share, which evens out the
  /// noise of few examples. 1 = the step's weights themselves.
  double averaging = 0.05;
  /// Candidate strengths of the pull towards the base: the loss includes
  /// pull / 2 ||weights - base||^2.
  std::vector<double> pulls{1e-2, 1e-3};
  int folds = 4;  // at most
  /// Standard deviations, over people, of the line through the logits that is fitted first.
  double slope_deviation = 0.25;
  double offset_deviation = 0.7;
  std::uint64_t seed = 1;
};

struct Adaptation {
  NetworkWeights weights;
  double pull = 0.0;        // chosen
  int epochs = 0;           // chosen; 0 = no fine-tuning
  bool calibrated = false;  // otherwise, without epochs, `weights` is the base
  /// Mean MBCE over examples while held out: of the base, and of the choice.
  double base_loss = 0.0;
  double held_out_loss = 0.0;
};

/// Adapts `base` to one person's examples, without forgetting, in two stages:
///
///   1. calibrates: each output's logits become slope logit + offset, the most probable line given
///      the examples and how people differ. Few pictures suffice.
///   2. fine-tunes the last two layers. Cross-validation chooses the pull towards stage 1 and the
///      number of epochs with the lowest loss, and never splits a group (a trajectory). Done only
///      where the gain over stage 1 is more than two standard errors.
///
/// The result is the base where stage 1 does not lower the held-out loss, and stage 2 is not done.
///
/// The result depends on base, groups and options only, not on `threads`.
/// Errors: kInvalidArgument (fewer than two groups with examples), kUnavailable (`stop` requested).
[[nodiscard]] Result<Adaptation> Adapt(const NetworkWeights& base,
                                       const std::vector<ExampleSet>& groups,
                                       const AdaptOptions& options, int threads,
                                       const StopToken& stop);

}  // namespace conav::nhpm
