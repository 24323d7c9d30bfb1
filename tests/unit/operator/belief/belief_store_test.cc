#include "operator/belief/belief_store.h"

#include <sqlite3.h>

#include <catch2/catch.hpp>

#include "common/runtime/random.h"
#include "support/drawn_map.h"
#include "support/temporary_folder.h"

namespace conav::operators {

using test::TemporaryFolder;
namespace {

const BeliefGrid kInitial = DrawnMap({"####", "#  #", "#? #", "####"});

BeliefStoreOptions OptionsFor(const std::filesystem::path& file) { return {{file}, {}}; }

/// A store with world w1 and robot r1.
BeliefStore OpenStore(const std::filesystem::path& file) {
  BeliefStore store(OptionsFor(file));
  REQUIRE(store.AddWorld("w1", kInitial, {1}));
  store.AddRobot("r1", "w1");
  return store;
}

OperatorRequest Edit(std::uint64_t id, std::uint64_t base, Cell cell, bool wall,
                     const std::string& client = "anna") {
  return {{2}, client, id, "w1", EditRequest{base, {{cell, wall}}}};
}

OperatorRequest Guide(std::uint64_t id, std::vector<Cell> path, const std::string& robot = "r1") {
  return {{2}, "anna", id, "w1", GuideRequest{robot, std::move(path), 6, 30.0}};
}

TEST_CASE("A new world starts with its map, a known one keeps its belief and refuses another map",
          "[operator][belief]") {
  const TemporaryFolder folder;
  BeliefStore store(OptionsFor(folder / "operator.db"));
  CHECK(store.FindBelief("w1") == nullptr);
  CHECK(store.AddWorld("w1", kInitial, {7}).value());
  CHECK(*store.FindBelief("w1") == Belief{{7}, "w1", 0, kInitial, ""});
  REQUIRE(store.Handle(Edit(1, 0, {1, 1}, true), {3}).reply.accepted);
  CHECK_FALSE(store.AddWorld("w1", kInitial, {9}).value());
  BeliefGrid edited = kInitial;
  edited[{1, 1}] = 1.0F;  // as the belief is now, which is not how the world began
  for (const BeliefGrid& other : {BeliefGrid(5, 4), edited}) {
    const auto added = store.AddWorld("w1", other, {9});
    REQUIRE_FALSE(added);
    CHECK(added.error().code == ErrorCode::kRefused);
    CHECK_THAT(added.error().text,
               Catch::Contains((folder / "operator.db").string()) && Catch::Contains("w1"));
  }
  CHECK(store.FindBelief("w1")->revision == 1);
}

TEST_CASE("A raster of any size and an edit of thousands of its cells are stored",
          "[operator][belief]") {
  const TemporaryFolder folder;
  const int side = GENERATE(150, 300);  // the larger one is stored compressed
  BeliefGrid initial(side, side);
  Random random(1);
  for (float& value : initial.values()) value = static_cast<float>(random.Unit());
  OperatorRequest edit{{2}, "anna", 1, "w1", EditRequest{}};
  for (int i = 0; i < 4000; ++i) {
    std::get<EditRequest>(edit.body).edits.push_back({{40 + i / 80, 40 + i % 80}, i % 2 == 0});
  }
  Belief belief;
  {
    BeliefStore store(OptionsFor(folder / "operator.db"));
    REQUIRE(store.AddWorld("w1", initial, {1}));
    REQUIRE(store.Handle(edit, {3}).reply.accepted);
    belief = *store.FindBelief("w1");
  }
  BeliefStore store(OptionsFor(folder / "operator.db"));
  CHECK((*store.FindBelief("w1") == belief));
  CHECK((store.InitialMap("w1").value() == initial));
  CHECK_FALSE(store.Handle(edit, {4}).changed);  // a repeat
}

TEST_CASE("Reopening gives back beliefs, guidance, the initial map and the replies to repeats",
          "[operator][belief]") {
  const TemporaryFolder folder;
  const OperatorRequest first_edit = Edit(1, 0, {1, 1}, true);
  const OperatorRequest first_path = Guide(3, {{1, 1}, {1, 2}});
  std::map<std::string, Belief> beliefs;
  std::map<std::string, Guidance> guidance;
  {
    BeliefStore store = OpenStore(folder / "operator.db");
    REQUIRE(store.AddWorld("w2", BeliefGrid(3, 5, 0.25F), {2}));
    REQUIRE(store.Handle(first_edit, {3}).changed);
    REQUIRE(store.Handle(Edit(2, 1, {1, 2}, true), {4}).reply.revision == 2);
    REQUIRE(store.Handle(first_path, {5}).reply.revision == 1);
    REQUIRE(store.Handle(Guide(4, {{1, 1}, {2, 1}}), {6}).reply.revision == 2);
    beliefs = store.beliefs();
    guidance = store.guidance();
    const auto repeat = store.Handle(first_edit, {9});
    CHECK(repeat.reply == OperatorReply{"anna", 1, true, "", 1});
    CHECK_FALSE(repeat.changed);
    CHECK(store.beliefs() == beliefs);
  }
  BeliefStore reopened(OptionsFor(folder / "operator.db"));
  CHECK(reopened.Handle(first_edit, {9}).reply == OperatorReply{"anna", 1, true, "", 1});
  CHECK(reopened.Handle(first_path, {9}).reply == OperatorReply{"anna", 3, true, "", 1});
  CHECK(reopened.beliefs() == beliefs);
  CHECK(reopened.guidance() == guidance);
  CHECK(reopened.FindBelief("w1")->revision == 2);
  CHECK(reopened.FindGuidance("r1")->path == std::vector<Cell>{{1, 1}, {2, 1}});
  CHECK(reopened.InitialMap("w1").value() == kInitial);
  CHECK(reopened.InitialMap("w3").value() == std::nullopt);
  CHECK(reopened.Handle(Edit(5, 2, {2, 1}, true), {7}).reply.revision == 3);
}

TEST_CASE("Nothing new answers a picture", "[operator][belief]") {
  const TemporaryFolder folder;
  BeliefStore store = OpenStore(folder / "operator.db");
  SECTION("Nothing new: the path stays and answers the picture, once") {
    REQUIRE(store.Handle(Guide(1, {{1, 1}, {1, 2}}), {3}).reply.accepted);
    const OperatorRequest nothing_new{{2}, "ben", 1, "w1", AnswerRequest{"r1", 7}};
    REQUIRE(store.Handle(nothing_new, {4}).changed);
    const Guidance& guidance = *store.FindGuidance("r1");
    CHECK(guidance.path == std::vector<Cell>{{1, 1}, {1, 2}});
    CHECK(guidance.answers_snapshot == 7);
    CHECK(guidance.revision == 2);
    CHECK(guidance.given_by == "ben");
    CHECK(guidance.valid_until == SimTime{3} + std::chrono::seconds(30));

    const auto again = store.Handle({{2}, "ben", 2, "w1", AnswerRequest{"r1", 7}}, {5});
    CHECK_FALSE(again.reply.accepted);
    CHECK_THAT(again.reply.reason, Catch::Contains("picture 7 of r1"));
    CHECK_FALSE(store.Handle({{2}, "ben", 3, "w1", AnswerRequest{"r9", 7}}, {5}).reply.accepted);
  }
  SECTION("An answered picture stays answered when the path is redrawn or withdrawn") {
    REQUIRE(store.Handle({{2}, "ben", 1, "w1", AnswerRequest{"r1", 7}}, {4}).changed);
    REQUIRE(store.Handle(Guide(1, {{1, 1}, {1, 2}}), {5}).reply.accepted);
    CHECK(store.FindGuidance("r1")->answers_snapshot == 7);
    REQUIRE(store.Handle(Guide(2, {}), {6}).reply.accepted);
    CHECK(store.FindGuidance("r1")->answers_snapshot == 7);
  }
  SECTION("Nothing new is an answer also where no path was ever drawn") {
    REQUIRE(store.Handle({{2}, "ben", 1, "w1", AnswerRequest{"r1", 1}}, {4}).changed);
    CHECK(store.FindGuidance("r1")->path.empty());
    CHECK(store.FindGuidance("r1")->answers_snapshot == 1);
  }
}

TEST_CASE("A decision made elsewhere is kept with its orders, and its repeat is known",
          "[operator][belief]") {
  const TemporaryFolder folder;
  const OperatorRequest stop{{2}, "anna", 1, "", StopRequest{{"r1"}, "look"}};
  const StopOrder order{{2}, "w1", "r1", 1, true, "anna", "look"};
  {
    BeliefStore store = OpenStore(folder / "operator.db");
    CHECK_FALSE(store.FindRepeat(stop));
    REQUIRE(store.Keep(stop, {order}).changed);
  }
  BeliefStore reopened = OpenStore(folder / "operator.db");
  CHECK(reopened.stops() == std::map<std::string, StopOrder>{{"r1", order}});
  REQUIRE(reopened.FindRepeat(stop));
  CHECK(reopened.FindRepeat(stop)->reply.accepted);
  CHECK_FALSE(reopened.FindRepeat(stop)->changed);
  const OperatorRequest other{{2}, "anna", 1, "", StopRequest{{"r2"}, "look"}};
  CHECK_FALSE(reopened.FindRepeat(other)->reply.accepted);
}

TEST_CASE("Alerts are kept as they are, whether they are true included", "[operator][belief]") {
  const TemporaryFolder folder;
  const Alert active{.id = 3,
                     .condition = {"link/r1", Severity::kAlarm, "r1", "no message", "look"},
                     .raised_s = 1.5,
                     .newest_s = 2.5,
                     .count = 4,
                     .active = true,
                     .acknowledged_by = "anna",
                     .acknowledged_s = 3.5,
                     .shelved_until_s = 4.5};
  Alert over = active;
  over.id = 4;
  over.active = false;
  Alert dropped = over;
  dropped.id = 5;
  {
    BeliefStore store = OpenStore(folder / "operator.db");
    REQUIRE(store.SaveAlerts({active, over, dropped}));
    REQUIRE(store.SaveAlerts({}, {5}));
  }
  CHECK(OpenStore(folder / "operator.db").alerts() == std::vector<Alert>{active, over});
}

TEST_CASE("Goals are kept with the mission that they began with", "[operator][belief]") {
  const TemporaryFolder folder;
  const KeptGoals kept{{.stamp = {7},
                        .world = "w1",
                        .robot = "r1",
                        .left = {{1.5, -2.25}, {0.1, 3.0}},
                        .reached = {{4.0, 5.0}},
                        .total = 3},
                       "1 2\n"};
  const OperatorRequest request{{2}, "anna", 1, "w1", GoalsRequest{"r1", {{1.5, -2.25}}, {}}};
  {
    BeliefStore store = OpenStore(folder / "operator.db");
    REQUIRE(store.SaveGoals({{.robot = "r1"}, ""}));
    REQUIRE(store.Keep(request, {}, {}, {kept}).changed);
  }
  BeliefStore reopened = OpenStore(folder / "operator.db");
  CHECK(reopened.goals() == std::map<std::string, KeptGoals>{{"r1", kept}});
  CHECK(reopened.FindRepeat(request)->reply.accepted);
}

TEST_CASE("A database of an older version goes on with what it holds", "[operator][belief]") {
  const TemporaryFolder folder;
  const int version = GENERATE(1, 2, 3, 4);
  {
    BeliefStore store = OpenStore(folder / "operator.db");
    REQUIRE(store.Handle(Edit(1, 0, {1, 1}, true), {3}).reply.accepted);
  }
  {
    auto database = Database::Open({folder / "operator.db"});
    REQUIRE(database);
    std::vector<std::string> undo{"DROP TABLE goals"};
    if (version < 4) undo.push_back("ALTER TABLE stops RENAME TO holds");
    if (version < 3) {
      undo.insert(undo.end(),
                  {"DROP INDEX requests_by_time", "ALTER TABLE requests DROP COLUMN answered_s",
                   "ALTER TABLE alerts DROP COLUMN active"});
    }
    if (version < 2) undo.insert(undo.end(), {"DROP TABLE holds", "DROP TABLE alerts"});
    for (const std::string& statement : undo) REQUIRE(database->Execute(statement));
    REQUIRE(database->Execute("PRAGMA user_version = " + std::to_string(version)));
  }
  BeliefStore store = OpenStore(folder / "operator.db");
  CHECK(store.FindBelief("w1")->revision == 1);
  CHECK(store.Keep({{2}, "anna", 2, "", ResumeRequest{}}, {}).changed);
  CHECK(store.FindRepeat(Edit(1, 0, {1, 1}, true))->reply.accepted);
  CHECK(store.ForgetRequests(1e9, 10) == 0);  // what was there counts as answered now
}

TEST_CASE("Each request of a client is answered once, refusals change nothing",
          "[operator][belief]") {
  const TemporaryFolder folder;
  BeliefStore store = OpenStore(folder / "operator.db");
  SECTION("A refusal is repeated as it was, even when the request would be right by now") {
    const OperatorReply refused = store.Handle(Guide(1, {}, "r2"), {3}).reply;
    CHECK_FALSE(refused.accepted);
    store.AddRobot("r2", "w1");
    CHECK(store.Handle(Guide(1, {}, "r2"), {3}).reply == refused);
    CHECK(store.Handle(Guide(2, {}, "r2"), {3}).reply.accepted);
  }
  SECTION("Two clients may use the same request id") {
    CHECK(store.Handle(Edit(1, 0, {1, 1}, true, "anna"), {3}).reply.revision == 1);
    CHECK(store.Handle(Edit(1, 1, {1, 2}, true, "bert"), {3}).reply.revision == 2);
    CHECK(store.FindBelief("w1")->edited_by == "bert");
  }
  SECTION("A request id used again for something else is refused") {
    REQUIRE(store.Handle(Edit(1, 0, {1, 1}, true), {3}).reply.accepted);
    const auto other = store.Handle(Edit(1, 1, {1, 2}, true), {3});
    CHECK_FALSE(other.reply.accepted);
    CHECK_THAT(other.reply.reason, Catch::Contains("request 1 of client anna"));
    CHECK(store.FindBelief("w1")->revision == 1);
  }
  SECTION("A refused edit leaves the belief and names the current revision") {
    REQUIRE(store.Handle(Edit(1, 0, {1, 1}, true), {3}).reply.accepted);
    const Belief before = *store.FindBelief("w1");
    const auto stale = store.Handle(Edit(2, 0, {1, 2}, true), {4});
    CHECK_FALSE(stale.reply.accepted);
    CHECK_FALSE(stale.changed);
    CHECK(stale.reply.revision == 1);
    CHECK(*store.FindBelief("w1") == before);
  }
  SECTION("Names that are no UTF-8 do not stop the store") {
    CHECK_FALSE(store.Handle(Guide(1, {}, "r\xff"), {3}).reply.accepted);
    CHECK(store.Handle(Edit(2, 0, {1, 1}, true, "\xc3"), {3}).reply.accepted);
  }
  SECTION("Requests that nobody repeats any more are forgotten, a few at a time") {
    for (std::uint64_t id = 1; id <= 3; ++id) {
      REQUIRE(store.Keep({{2}, "anna", id, "", StopRequest{}}, {}).changed);
    }
    CHECK(store.ForgetRequests(1e9, 10) == 0);  // before 2001
    CHECK(store.ForgetRequests(1e11, 2) == 2);
    CHECK(store.ForgetRequests(1e11, 2) == 1);
    CHECK_FALSE(store.FindRepeat({{2}, "anna", 3, "", StopRequest{}}));
  }
}

TEST_CASE("Requests for unknown worlds and robots, or of nobody, are refused with a reason",
          "[operator][belief]") {
  const TemporaryFolder folder;
  BeliefStore store = OpenStore(folder / "operator.db");
  REQUIRE(store.AddWorld("w2", kInitial, {1}));
  OperatorRequest elsewhere = Edit(1, 0, {1, 1}, true);
  elsewhere.world = "w9";
  OperatorRequest wrong_world = Guide(3, {{1, 1}});
  wrong_world.world = "w2";
  const std::vector<std::pair<OperatorRequest, std::string>> rows{
      {elsewhere, "world 'w9'"},
      {Guide(2, {{1, 1}}, "r9"), "'r9'"},
      {wrong_world, "world w2"},
      {Edit(4, 0, {1, 1}, true, ""), "no client"}};
  for (const auto& [request, named] : rows) {
    CHECK_THAT(store.Handle(request, {3}).reply.reason, Catch::Contains(named));
  }
  CHECK(store.beliefs().size() == 2);
  CHECK(store.guidance().empty());
}

TEST_CASE("Withdrawn guidance is empty, answers nothing and has a revision of its own",
          "[operator][belief]") {
  const TemporaryFolder folder;
  {
    BeliefStore store = OpenStore(folder / "operator.db");
    REQUIRE(store.WithdrawGuidance("r1", {1}));
    CHECK(store.FindGuidance("r1") == nullptr);
    REQUIRE(store.Handle(Guide(1, {{1, 1}}), {5}).reply.accepted);
    REQUIRE(store.WithdrawGuidance("r1", {2}));
  }
  const BeliefStore reopened(OptionsFor(folder / "operator.db"));
  CHECK(*reopened.FindGuidance("r1") == Guidance{{2}, "w1", "r1", 2, {}, "", 0, 0, {2}});
}

TEST_CASE("A database that grows costs no memory", "[operator][belief]") {
  const TemporaryFolder folder;
  auto database = Database::Open({folder / "operator.db"});
  REQUIRE(database);
  REQUIRE(database->Execute("CREATE TABLE notes (text TEXT)"));
  const auto write = [&](int kilobytes) {
    for (int i = 0; i < kilobytes; ++i) {
      REQUIRE(database->Execute("INSERT INTO notes VALUES (?)", {std::string(1024, 'x')}));
    }
    return sqlite3_memory_used();
  };
  const auto before = write(100);
  REQUIRE(before > 0);
  CHECK(write(2000) < before + 300 * 1024);
}

}  // namespace
}  // namespace conav::operators
