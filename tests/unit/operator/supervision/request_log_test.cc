#include <catch2/catch.hpp>

#include "operator/supervision/supervision_topics.h"

namespace conav::operators {
namespace {

OperatorRequest Edit(std::uint64_t id) { return {{}, "anna", id, "w1", EditRequest{}}; }
OperatorRequest Drive(std::uint64_t id) { return {{}, "anna", id, "w1", DriveRequest{"r1"}}; }

BeliefStore::Answer Refused(const OperatorRequest& request) {
  return {{request.client, request.request_id, false, "no", 0}};
}

TEST_CASE("Requests that changed something, or were refused, are for the command log",
          "[operator]") {
  RequestLog log;
  CHECK(log.Note(Edit(1), {{"anna", 1, true, "", 1}, true}, {}));
  CHECK_FALSE(log.Note(Edit(2), {{"anna", 2, true, "", 1}, false}, {}));
  CHECK(log.Note(Edit(3), Refused(Edit(3)), {}));
  CHECK(log.accepted() == 2);
  CHECK(log.refused() == 1);
}

TEST_CASE("A refusal is reported and counted once, until many others came", "[operator]") {
  RequestLog log;
  CHECK(log.Note(Edit(1), Refused(Edit(1)), {}));
  CHECK_FALSE(log.Note(Edit(1), Refused(Edit(1)), {}));
  CHECK(log.refused() == 1);
  for (std::uint64_t id = 2; id < 2 + RequestLog::kRefusalsRemembered; ++id) {
    log.Note(Edit(id), Refused(Edit(id)), {});
  }
  CHECK(log.Note(Edit(1), Refused(Edit(1)), {}));
}

TEST_CASE("Low-level actions are counted, and not for the command log", "[operator]") {
  RequestLog log;
  CHECK_FALSE(log.Note(Drive(1), {{"anna", 1, true, "", 1}}, {}));
  CHECK_FALSE(log.Note(Drive(2), Refused(Drive(2)), {}));
  CHECK(log.accepted() == 1);
  CHECK(log.refused() == 1);
}

}  // namespace
}  // namespace conav::operators
