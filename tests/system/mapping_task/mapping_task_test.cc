// Participants of the mapping task: their mazes, their data, and what goes wrong.
#include <catch2/catch.hpp>
#include <csignal>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "common/grid/map_accuracy.h"
#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "sim/world/world_spec.h"
#include "support/packed_grid.h"
#include "support/program_runner.h"
#include "system/console_page.h"
#include "system/launcher/demo_run.h"

using conav::testing::TestDomain;
using conav::testing::WaitUntil;

namespace conav::mapping_task {
namespace {

namespace fs = std::filesystem;
using operators::PageClient;

/// `conav mapping-task` without pixels and as fast as it goes.
class Task : public test::RunningProgram {
 public:
  Task(const fs::path& folder, const std::string& options, int port = 0)
      : RunningProgram("conav-mapping-task",
                       fmt::format("--camera none --speed 1000 --domain {} --out {} --port {} {}",
                                   TestDomain(), folder.string(), port, options),
                       NewOutput(folder)) {}

  /// Of maze `number`, once it is there.
  int Port(int number) {
    const std::string begin = fmt::format(" maze-{} (", number);
    if (!Prints(begin)) FAIL(Output());
    const std::string text = Output();
    return std::stoi(text.substr(text.find("127.0.0.1:", text.find(begin)) + 10));
  }
  int Wait() { return RunningProgram::Wait().exit_code; }

 private:
  /// A file next to the folder; an earlier task's stays as it is.
  static fs::path NewOutput(const fs::path& folder) {
    for (int number = 1;; ++number) {
      fs::path file = fmt::format("{}-{}.txt", folder.string(), number);
      if (!fs::exists(file)) return file;
    }
  }
};

/// A participant at the page of one maze, who knows the maze.
class Participant : public operators::ConsolePage {
 public:
  Participant(int port, std::uint64_t maze_seed) : ConsolePage(port) {
    sim::WorldOptions options;
    options.seed = maze_seed;
    spec_ = *sim::MakeWorldSpec(options);
    ReadUntil([&] { return task.number() > 0 && belief.walls().size() > 0; });
    CHECK(welcome.mode() == console::MODE_MAPPING_TASK);
  }

  void Begin() {
    CHECK(task.phase() == console::PHASE_WAITING);
    CHECK(Ask([](auto& request) { request.mutable_resume(); }).accepted());
    ReadUntil([&] { return task.phase() == console::PHASE_RUNNING; });
  }
  /// Waits for the next picture, which is then the newest.
  const console::Snapshot& NextSnapshot() {
    ReadUntil([&] { return Newest() > answered_; });
    return snapshots.rbegin()->second;
  }
  /// Sets `count` wrong cells right.
  void Correct(int count) {
    const auto reply = Ask([&](auto& request) {
      request.mutable_edit()->set_base_revision(belief.revision());
      const std::string walls = test::UnpackedCells(belief.walls());
      for (std::size_t i = 0; i < spec_.truth.size() && count > 0; ++i) {
        const bool wall = spec_.truth.values()[i] == Occupancy::kOccupied;
        if (wall == (static_cast<unsigned char>(walls[i]) >= 128)) continue;
        const Cell cell = spec_.truth.CellAt(i);
        auto* edit = request.mutable_edit()->add_cells();
        edit->mutable_cell()->set_row(cell.row);
        edit->mutable_cell()->set_column(cell.column);
        edit->set_wall(wall);
        --count;
      }
    });
    CHECK(reply.accepted());
    ReadUntil([&] { return belief.revision() >= reply.revision(); });
  }
  void Answer() {
    answered_ = Newest();
    CHECK(Ask([&](auto& request) {
            request.mutable_answer()->set_robot("r1");
            request.mutable_answer()->set_snapshot(answered_);
          }).accepted());
  }
  console::Reply Finish() {
    return Ask([](auto& request) { request.mutable_finish(); });
  }
  /// Reads on until all goals are reached and a picture waits.
  void GoOnToTheEnd() {
    while (!task.may_finish()) {
      NextSnapshot();
      if (!task.may_finish()) Answer();
    }
    NextSnapshot();
  }
  int mistakes() const {
    return CompareMaps(spec_.truth, spec_.human_map, ToBelief(spec_.human_map)).wrong_at_first;
  }

 private:
  std::uint64_t Newest() const { return snapshots.empty() ? 0 : snapshots.rbegin()->first; }

  sim::WorldSpec spec_;
  std::uint64_t answered_ = 0;
};

nlohmann::json Json(const fs::path& file) {
  return nlohmann::json::parse(ReadFile(file).value_or("null"));
}

/// The exit code of a task that ends by itself.
int Ended(const fs::path& folder, const std::string& options) {
  return Task(folder, options).Wait();
}

std::string Options(const std::string& participant, const std::string& seeds = "7") {
  return "--participant " + participant + " --maze-seed " + seeds;
}

/// The process that was started with this file; 0 = there is none.
pid_t PidWith(const fs::path& config) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const auto command = ReadFile(entry.path() / "cmdline");
    if (!command || command->find(config.string() + '\0') == std::string::npos) continue;
    return std::stoi(entry.path().filename());
  }
  return 0;
}

}  // namespace

TEST_CASE("a participant corrects two mazes, and their segments are there to learn from",
          "[mapping_task]") {
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary / "P07";
  Task task(folder, Options("P07", "7,9"));

  {
    Participant person(task.Port(1), 7);
    CHECK(person.task.participant() == "P07");
    CHECK(person.task.count() == 2);
    person.Begin();
    CHECK_FALSE(person.Finish().accepted());
    const auto guided = person.Ask([](auto& request) {
      request.mutable_guide()->set_robot("r1");
      request.mutable_guide()->set_valid_for(60.0);
    });
    CHECK_THAT(guided.reason(), Catch::Contains("mapping task"));
    // What it shows is for people to see.
    CHECK(person.NextSnapshot().free_cells().row_size() == 0);
    person.Correct(person.mistakes());
    person.Answer();
    person.GoOnToTheEnd();
    CHECK(person.Finish().accepted());
    person.ReadUntil([&] { return person.task.phase() == console::PHASE_FINISHED; });
    CHECK(person.task.mapping_accuracy() == 1.0);
    for (const int secret :
         {console::Update::kSeen, console::Update::kPlan, console::Update::kSearch,
          console::Update::kPrediction, console::Update::kTruth}) {
      CHECK_FALSE(person.kinds.contains(secret));
    }
  }
  {
    Participant person(task.Port(2), 9);
    CHECK(person.task.number() == 2);
    CHECK(person.task.earlier_size() == 1);
    person.Begin();
    person.GoOnToTheEnd();
    person.Correct(1);
    CHECK(person.Finish().accepted());
  }
  CHECK(task.Wait() == 0);
  INFO(task.Output());

  const auto result = Json(folder / "result.json");
  REQUIRE(result.is_object());
  CHECK(result["complete"] == true);
  CHECK(result["mazes_valid"] == 1);
  CHECK(result["steps"][0]["mapping_accuracy"] == 1.0);
  CHECK(result["steps"][0]["seed"] == 7);
  CHECK(result["steps"][0]["edits"] == 1);
  CHECK(result["steps"][1]["valid"] == false);
  for (const auto* maze : {"01-maze-1", "02-maze-2"}) {
    const auto bag = test::RunProgram("conav-bag", (folder / maze).string() + " --json -");
    CHECK_THAT(bag.out, Catch::Contains("/w1/truth"));
  }

  const auto segments = ReadSegmentFile(folder / "segments.pb.zst", TornEnd::kRefuse);
  REQUIRE(segments);
  REQUIRE(segments->trajectories.size() == 2);
  const Trajectory& first = segments->trajectories[0];
  CHECK(first.origin == SegmentOrigin::kPerson);
  CHECK(first.participant == "P07");
  CHECK(first.final_mapping_accuracy == 1.0);
  CHECK(first.segments.size() == result["steps"][0]["pictures"]);
  CHECK(EditCount(first.segments.front()) > 1);
  CHECK(segments->trajectories[1].final_mapping_accuracy ==
        Approx(result["steps"][1]["mapping_accuracy"].get<double>()));
  CHECK(EditCount(segments->trajectories[1].segments.back()) == 1);  // answered by the finish
}

TEST_CASE("after a kill the same command begins the same maze again, and keeps its segments",
          "[mapping_task]") {
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary / "P08";
  const auto options = Options("P08");
  {
    Task task(folder, options);
    Participant person(task.Port(1), 7);
    person.Begin();
    person.NextSnapshot();
    person.Correct(2);
    person.Answer();
    person.NextSnapshot();
    task.Signal(SIGKILL);
    const int port = task.Port(1);
    REQUIRE(WaitUntil([&] { return PageClient({.port = port}).refused() != 0; },
                      std::chrono::seconds(30)));
  }
  const auto segments = ReadSegmentFile(folder / "segments.pb.zst", TornEnd::kDrop);
  REQUIRE(segments);
  REQUIRE(segments->trajectories.size() == 1);
  CHECK(segments->trajectories[0].segments.size() == 1);

  Task again(folder, options);
  Participant person(again.Port(1), 7);
  CHECK(person.belief.revision() == 0);
  person.Begin();
  person.GoOnToTheEnd();
  CHECK(person.Finish().accepted());
  CHECK(again.Wait() == 0);
  const auto result = Json(folder / "result.json");
  CHECK(result["steps"][0]["edits"] == 0);
  CHECK_THAT(ReadFile(folder / "log.jsonl").value(), Catch::Contains(R"("resumed":true)"));

  CHECK(Ended(folder, options) == 0);  // nothing is left to do
}

TEST_CASE("a participant's folder takes one task at a time, of one participant and design",
          "[mapping_task]") {
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary / "P09";
  const auto options = Options("P09");
  {
    Task task(folder, options);
    const int port = task.Port(1);
    CHECK(Ended(folder, options) == 2);
    Task second(temporary / "P12", Options("P12"), port);
    CHECK(second.Wait() == 1);
    CHECK_THAT(second.Output(), Catch::Contains(fmt::format("--port {}", port)));
    task.Signal(SIGTERM);
    CHECK(task.Wait() == 1);
  }
  CHECK(Ended(folder, Options("P10")) == 2);
}

TEST_CASE("a service that dies is started again, and the maze goes on", "[mapping_task]") {
  const std::string service = GENERATE("operator", "sim", "planner");
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary / "P13";
  Task task(folder, Options("P13"));
  const int port = task.Port(1);
  {
    Participant person(port, 7);
    person.Begin();
    person.NextSnapshot();
    person.Correct(2);
    const pid_t pid = PidWith(folder / fmt::format("01-maze-1/config/{}.yaml", service));
    REQUIRE(pid > 0);
    REQUIRE(kill(pid, SIGKILL) == 0);
    REQUIRE(task.Prints("restarted " + service));
  }
  REQUIRE(WaitUntil([&] { return PageClient({.port = port}).refused() == 0; },
                    std::chrono::seconds(30)));
  Participant person(port, 7);
  CHECK(person.belief.revision() == 1);
  person.GoOnToTheEnd();
  CHECK(person.Finish().accepted());
  CHECK(task.Wait() == 0);
  CHECK(Json(folder / "result.json")["steps"][0]["edits"] == 1);
  CHECK_THAT(ReadFile(folder / "log.jsonl").value(), Catch::Contains("process_died"));
}

}  // namespace conav::mapping_task
