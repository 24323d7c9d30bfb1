#pragma once

#include <catch2/catch.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "operator/console/update_log.h"

/// Reading what the console's service says, as a page does.
namespace conav::operators {

/// An update of which a test sees name and content.
inline console::Update Said(const std::string& name, const std::string& message) {
  console::Update update;
  update.mutable_service()->set_name(name);
  update.mutable_service()->set_message(message);
  return update;
}

inline std::vector<console::Update> Parsed(const UpdateLog::Batch& batch) {
  console::Updates updates;
  REQUIRE(updates.ParseFromString(batch.updates));
  return {updates.update().begin(), updates.update().end()};
}

/// All updates that a page without any would get.
inline std::vector<console::Update> AllOf(const UpdateLog& log) {
  return Parsed(log.After(log.generation(), 0, SIZE_MAX));
}

/// The updates of one kind, oldest first.
inline std::vector<console::Update> AllOf(const UpdateLog& log, console::Update::BodyCase kind) {
  std::vector<console::Update> of_kind;
  for (const console::Update& update : AllOf(log)) {
    if (update.body_case() == kind) of_kind.push_back(update);
  }
  return of_kind;
}

/// The only one of its kind.
inline console::Update OnlyOf(const UpdateLog& log, console::Update::BodyCase kind) {
  const auto all = AllOf(log, kind);
  REQUIRE(all.size() == 1);
  return all.front();
}

}  // namespace conav::operators
