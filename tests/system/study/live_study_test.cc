// A participant's way through a protocol: real processes, a page of our own instead of a browser.
#include <catch2/catch.hpp>
#include <csignal>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "support/program_runner.h"
#include "system/console_page.h"
#include "system/launcher/demo_run.h"
#include "system/study/pupil_standin.h"

using conav::testing::TestDomain;
using conav::testing::WaitUntil;

namespace conav::live_study {
namespace {

namespace fs = std::filesystem;
using operators::PageClient;

constexpr const char* kProtocol = R"(name: short
language: de
completion_code: random
maze: {camera: none, speed: 1000}
parts:
  - form: forms/consent.json
  - rest: 0.2
    id: baseline
  - maze: ig-mcts
    training: true
    layouts: [1, 2]
    criterion: {attempts: 2, mapping_accuracy: 1.0}
  - methods: [ig-mcts, instruction]
    layouts: [7, 9]
    after:
      - form: forms/tlx.json
  - text: Danke.
    id: end
)";

/// The folder of a researcher, with a protocol and its forms.
class Desk : public test::TemporaryFolder {
 public:
  Desk() {
    fs::create_directories(path() / "forms");
    Write("forms/consent.json", R"({"version": "1", "elements": [
      {"type": "radiogroup", "name": "consent", "choices": ["yes"], "isRequired": true}]})");
    Write("forms/tlx.json", R"({"version": "2", "elements": [
      {"type": "rating", "name": "effort"}, {"type": "rating", "name": "check", "attention": 3}]})");
    Write("study.yaml", kProtocol);
  }
  std::string Options(const std::string& participant) const {
    return fmt::format("--participant {} --protocol {} --out {}", participant,
                       (path() / "study.yaml").string(), study().string());
  }
  fs::path study() const { return path() / "study"; }
  nlohmann::json Json(const fs::path& file) const {
    return nlohmann::json::parse(ReadFile(study() / file).value_or("null"));
  }
};

class Session : public test::RunningProgram {
 public:
  Session(const Desk& desk, const std::string& participant, int number = 1)
      : RunningProgram(
            "conav-live-study",
            fmt::format("--domain {} --port 0 {}", TestDomain(), desk.Options(participant)),
            desk / fmt::format("{}-{}.txt", participant, number)) {}
  /// In a domain of its own.
  Session(const Desk& desk, const std::string& participant, const std::string& eye_tracker)
      : RunningProgram(
            "conav-live-study",
            fmt::format("--port 0 --eye-tracker {} {}", eye_tracker, desk.Options(participant)),
            desk / (participant + ".txt")) {}

  /// Of the page of step `id`, once it is there.
  int Port(const std::string& id) {
    if (!Opens(id)) FAIL(Output());
    const std::string text = Output();
    const auto line = std::min(text.find("  " + id + ": http"), text.find("  " + id + " (method"));
    return std::stoi(text.substr(text.find("127.0.0.1:", line) + 10));
  }
  int Wait() { return RunningProgram::Wait().exit_code; }

 private:
  bool Opens(const std::string& id) {
    return WaitUntil(
        [&] {
          const std::string text = Output();
          return text.find("  " + id + ": http") != std::string::npos ||
                 text.find("  " + id + " (method") != std::string::npos || Ends({});
        },
        std::chrono::minutes(1));
  }
};

/// A participant at the page of one step.
class Participant : public operators::ConsolePage {
 public:
  Participant(int port, const std::string& step) : ConsolePage(port) {
    ReadUntil([&] { return task.number() > 0; });
    CHECK(task.step() == step);
  }

  void AnswerForm(const std::string& json) {
    ReadUntil([&] { return task.phase() == console::PHASE_RUNNING; });
    CHECK(Ask([&](auto& request) { request.mutable_answers()->set_json(json); }).accepted());
  }
  void Rest() {
    CHECK(Ask([](auto& request) { request.mutable_begin(); }).accepted());
  }
  void Begin() {
    ReadUntil([&] { return belief.walls().size() > 0; });
    CHECK(Ask([](auto& request) { request.mutable_resume(); }).accepted());
    ReadUntil([&] { return task.phase() == console::PHASE_RUNNING; });
  }
  void ReachAllGoals() {
    ReadUntil([&] { return task.may_finish(); });
    CHECK(Ask([](auto& request) { request.mutable_finish(); }).accepted());
  }
};

/// The process that was started with this file; 0 = there is none.
pid_t PidWith(const fs::path& config) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const auto command = ReadFile(entry.path() / "cmdline");
    if (!command || command->find(config.string() + '\0') == std::string::npos) continue;
    return std::stoi(entry.path().filename());
  }
  return 0;
}

void Kill(const fs::path& config) {
  const pid_t pid = PidWith(config);
  REQUIRE(pid > 0);
  REQUIRE(kill(pid, SIGKILL) == 0);
}

void PlayMaze(Session& session, const std::string& id) {
  Participant person(session.Port(id), id);
  person.Begin();
  person.ReachAllGoals();
}

}  // namespace

TEST_CASE(
    "a participant goes from consent to the last page, over the death of a service and of the "
    "session",
    "[live_study]") {
  const Desk desk;
  std::uint64_t picture = 0;
  {
    Session session(desk, "P01");
    {
      Participant person(session.Port("consent"), "consent");
      CHECK(person.task.language() == "de");
      CHECK(
          person
              .Ask([](auto& request) { request.mutable_draft()->set_json(R"({"consent":"yes"})"); })
              .accepted());
    }
    Kill(desk.study() / "P01/01-consent/config/operator.yaml");
    REQUIRE(session.Prints("restarted operator"));
    const int port = session.Port("consent");
    REQUIRE(WaitUntil([&] { return PageClient({.port = port}).refused() == 0; },
                      std::chrono::seconds(30)));
    Participant(port, "consent").AnswerForm(R"({"consent":"yes"})");
    Participant(session.Port("baseline"), "baseline").Rest();
    PlayMaze(session, "training");
    PlayMaze(session, "training-2");  // nothing was corrected
    Participant person(session.Port("ig-mcts"), "ig-mcts");
    person.Begin();
    person.ReadUntil([&] { return !person.snapshots.empty(); });
    picture = person.snapshots.rbegin()->first;
    session.Signal(SIGKILL);
    session.Wait();
  }
  REQUIRE(
      WaitUntil([&] { return PidWith(desk.study() / "P01/05-ig-mcts/config/operator.yaml") == 0; },
                std::chrono::seconds(30)));
  Session session(desk, "P01", 2);
  {
    Participant person(session.Port("ig-mcts"), "ig-mcts");
    person.ReadUntil([&] { return person.task.phase() == console::PHASE_RUNNING; });
    CHECK(person.task.title() == "Part 1 of 2");
    person.ReadUntil([&] { return person.snapshots.contains(picture); });  // it waits for an answer
    person.ReachAllGoals();
  }
  Participant(session.Port("ig-mcts-tlx"), "ig-mcts-tlx").AnswerForm(R"({"effort":4,"check":3})");
  {
    Participant person(session.Port("instruction"), "instruction");
    person.Begin();
  }
  const auto second = test::RunProgram("conav-live-study", desk.Options("P01") + " --port 0");
  CHECK(second.exit_code == 2);
  CHECK_THAT(second.error, Catch::Contains("in use"));
  session.Signal(SIGTERM);
  CHECK(session.Wait() == 1);
  const auto json = desk.Json("P01/result.json");
  CHECK(json["complete"] == false);
  REQUIRE(json["steps"].size() == 6);
  CHECK(json["steps"][0]["answers"]["consent"] == "yes");
  CHECK(json["steps"][2]["criterion_reached"] == false);
  CHECK(json["steps"][4]["low_level_steps"] > 0);
  CHECK(json["steps"][5]["attention_passed"] == true);
  CHECK_THAT(ReadFile(desk.study() / "P01/log.jsonl").value(),
             Catch::Contains("process_died") && Catch::Contains(R"("resumed":true)"));
}

TEST_CASE("the report of four participants with a synthetic eye tracker has no gap",
          "[live_study]") {
  const Desk desk;
  // Mazes end by their time limit, so that none needs a person who drives.
  desk.Write("study.yaml", R"(name: eyes
maze: {camera: none, speed: 20, time_limit_s: 7}
parts:
  - form: forms/consent.json
  - methods: [ig-mcts, instruction, teleop]
    layouts: [7, 9, 11]
    before:
      - rest: 8
        id: baseline
    after:
      - form: forms/tlx.json
)");
  desk.Write("forms/tlx.json", R"({"version": "2", "scoring": {"tlx": {"kind": "mean", "of":
      ["effort"]}}, "elements": [{"type": "rating", "name": "effort", "rateMax": 7}]})");
  const testing::Standin tracker("");
  const std::vector<std::string> names{"P01", "P02", "P03", "P04"};
  std::vector<std::unique_ptr<Session>> sessions;
  for (const std::string& name : names) {
    sessions.push_back(std::make_unique<Session>(desk, name, tracker.address()));
    sessions.back()->Port("consent");  // a domain is taken once a session is there
  }
  const auto steps = [&](const std::string& name) {
    return desk.Json(name + "/participant.json")["parts"];
  };
  for (std::size_t step = 0; step < steps("P01").size(); ++step) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      const nlohmann::json part = steps(names[i])[step];
      CAPTURE(names[i], part.dump());
      const std::string id = part["step"];
      Participant person(sessions[i]->Port(id), id);
      // On a busy machine the tracker is later than the page.
      const std::string log =
          fmt::format("{}/{:02}-{}/logs/eye-tracker.log", names[i], step + 1, id);
      REQUIRE(WaitUntil(
          [&] {
            const auto said = ReadFile(desk.study() / log);
            return said && said->find("eye tracker connected") != std::string::npos;
          },
          std::chrono::minutes(1)));
      if (part["kind"] == "form") person.AnswerForm(fmt::format(R"({{"effort":{}}})", 1 + i));
      if (part["kind"] == "rest") person.Rest();
      if (part.contains("seed")) person.Begin();
    }
  }
  for (const auto& session : sessions) CHECK(session->Wait() == 0);

  const auto report =
      test::RunProgram("conav-study-report", fmt::format("'{}' --json '{}'", desk.study().string(),
                                                         (desk.study() / "report.json").string()));
  INFO(report.error);
  REQUIRE(report.exit_code == 0);
  const nlohmann::json numbers = desk.Json("report.json");
  REQUIRE(numbers["participants"].size() == names.size());
  for (const auto& participant : numbers["participants"]) CHECK(participant["state"] == "complete");
  for (const char* measure : {"low_level_steps", "pictures", "guidance", "mapping_accuracy",
                              "duration_s", "tlx", "pcpd_mean", "blinks_per_min"}) {
    for (const char* method : {"ig-mcts", "instruction", "teleop"}) {
      CAPTURE(measure, method);
      CHECK(numbers["measures"][measure]["methods"][method]["trials"] == 4);
    }
  }
}

TEST_CASE("a short protocol is completed with a code that is the participant's", "[live_study]") {
  const Desk desk;
  desk.Write("study.yaml",
             "name: short\ncompletion_code: random\nparts:\n  - form: forms/consent.json\n"
             "  - text: Bye.\n    id: end\n");
  const auto play = [&](const std::string& participant) {
    Session session(desk, participant);
    Participant(session.Port("consent"), "consent").AnswerForm(R"({"consent":"yes"})");
    {
      Participant person(session.Port("end"), "end");
      person.AnswerForm("{}");
      person.ReadUntil([&] { return !person.task.completion_code().empty(); });
      CHECK(session.Wait() == 0);
      CHECK_THAT(session.Output(), Catch::Contains(person.task.completion_code()));
    }
    const auto json = desk.Json(participant + "/result.json");
    CHECK(json["complete"] == true);
    return json["completion_code"].get<std::string>();
  };
  CHECK(play("P01") != play("P02"));

  // As after a kill between the last result and its line in the log.
  const fs::path log = desk.study() / "P02/log.jsonl";
  REQUIRE(WriteFile(log, "").has_value());
  CHECK(test::RunProgram("conav-live-study", desk.Options("P02") + " --port 0").exit_code == 0);
  CHECK_THAT(ReadFile(log).value(), Catch::Contains(R"("step_finished","step":"end")"));

  {
    Session session(desk, "P03", "tcp://127.0.0.1:1");
    CHECK(session.Prints("no eye tracker"));
    session.Signal(SIGTERM);
    session.Wait();
  }

  desk.Write("forms/consent.json", R"({"version": "3", "elements": []})");
  const auto other = test::RunProgram("conav-live-study", desk.Options("P04"));
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.error, Catch::Contains("forms/consent.json"));
}

TEST_CASE("with --check-protocol it prints the steps of a participant, and what is wrong",
          "[live_study]") {
  const Desk desk;
  const auto right =
      test::RunProgram("conav-live-study", desk.Options("P02") + " --check-protocol");
  CHECK(right.exit_code == 0);
  CHECK_THAT(right.out, Catch::Contains("instruction-tlx") && Catch::Contains("order 2"));
  CHECK_FALSE(fs::exists(desk.study()));
  desk.Write("study.yaml", "parts:\n  - rest: never\n");
  const auto wrong =
      test::RunProgram("conav-live-study", desk.Options("P02") + " --check-protocol");
  CHECK(wrong.exit_code == 2);
  CHECK_THAT(wrong.error, Catch::Contains("line 2"));
}

}  // namespace conav::live_study
