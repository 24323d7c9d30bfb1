#include "nhpm/training/people.h"

#include <fmt/format.h>

#include <algorithm>

namespace conav::nhpm {
namespace {

constexpr std::size_t kMostNamed = 8;

std::string NamesOf(const std::vector<Person>& people) {
  std::string text;
  for (std::size_t i = 0; i < std::min(people.size(), kMostNamed); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", people[i].participant);
  }
  return people.size() > kMostNamed ? text + ", ..." : text;
}

std::vector<ExampleSet> OnePerExample(const ExampleSet& set) {
  std::vector<ExampleSet> groups;
  for (const Example& example : set.examples) groups.push_back({set.rows, set.columns, {example}});
  return groups;
}

}  // namespace

std::vector<Person> PeopleOf(const SegmentSet& set) {
  std::vector<Person> people;
  for (const Trajectory& trajectory : set.trajectories) {
    auto found = std::find_if(people.begin(), people.end(), [&](const Person& person) {
      return person.participant == trajectory.participant;
    });
    if (found == people.end()) {
      people.push_back({trajectory.participant, {}});
      found = people.end() - 1;
    }
    found->set.trajectories.push_back(trajectory);
  }
  return people;
}

Result<Person> FindPerson(const std::vector<Person>& people, const std::string& participant) {
  if (participant.empty() && people.size() == 1) return people.front();
  for (const Person& person : people) {
    if (!participant.empty() && person.participant == participant) return person;
  }
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{}; there are {} ({})",
                          participant.empty() ? "--participant must say to whom to adapt"
                                              : "no participant '" + participant + "'",
                          people.size(), NamesOf(people)));
}

std::vector<ExampleSet> AdaptationGroups(const SegmentSet& set, const InputSelection& inputs) {
  std::vector<ExampleSet> groups;
  for (const Trajectory& trajectory : set.trajectories) {
    groups.push_back(ExamplesOf({{trajectory}}, inputs));
  }
  return groups.size() == 1 ? OnePerExample(groups.front()) : groups;
}

}  // namespace conav::nhpm
