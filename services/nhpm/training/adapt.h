#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "nhpm/training/example.h"

namespace conav::nhpm {

/// All trajectories of one participant, in the order of the file.
struct Person {
  std::string participant;
  SegmentSet set;
};

/// By participant, in the order of first appearance.
std::vector<Person> PeopleOf(const SegmentSet& set);

/// The one of that name; the only one where the name is empty.
/// Errors: kInvalidArgument, naming who is there.
[[nodiscard]] Result<Person> FindPerson(const std::vector<Person>& people,
                                        const std::string& participant);

/// What an adaptation learns from: a set of examples for each trajectory, or for each segment where
/// there is only one trajectory. Requires CheckOneSize(set).
std::vector<ExampleSet> AdaptationGroups(const SegmentSet& set, const InputSelection& inputs);

/// Layers below this one keep the weights of the base when a network is adapted to a person.
inline constexpr int kFirstAdaptedLayer = 2;

struct AdaptOptions {
  int epochs = 60;    // at most
  int patience = 10;  // epochs without a better held-out loss before no more are tried
  int batch = 16;
  double learning_rate = 1e-3;
  /// The weights that count are a moving mean: this share of the step's weights is mixed in after
  /// each step, which evens out the noise of few examples. 1 = the step's weights themselves.
  double averaging = 0.05;
  /// Strengths of the pull towards the base that are tried: the loss has
  /// pull / 2 ||weights - base||^2 added.
  std::vector<double> pulls{1e-2, 1e-3};
  int folds = 4;  // at most
  std::uint64_t seed = 1;
};

struct Adaptation {
  NetworkWeights weights;
  double pull = 0.0;  // chosen
  int epochs = 0;     // chosen; 0 = the base was best, and `weights` is the base
  /// Mean MBCE over examples while they were held out: of the base, and with what was chosen.
  double base_loss = 0.0;
  double held_out_loss = 0.0;
};

/// Fine-tunes the last two layers of `base` on one person's examples, without forgetting: the pull
/// towards the base and the number of epochs are those with the lowest loss in cross-validation, in
/// which a group (a trajectory) is never split. The base stays where they gain less over it than two
/// standard errors of that gain: there is nothing certain to learn about this person then.
///
/// The result depends on base, groups and options only, not on `threads`.
/// Errors: kInvalidArgument (fewer than two groups with examples), kUnavailable (`stop` asked).
[[nodiscard]] Result<Adaptation> Adapt(const NetworkWeights& base,
                                       const std::vector<ExampleSet>& groups,
                                       const AdaptOptions& options, int threads,
                                       const StopToken& stop);

}  // namespace conav::nhpm
