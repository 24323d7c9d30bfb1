#pragma once

#include <string>
#include <vector>

#include "common/runtime/result.h"
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

}  // namespace conav::nhpm
