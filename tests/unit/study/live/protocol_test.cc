#include "study/live/protocol.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace conav::live_study {
namespace {

namespace fs = std::filesystem;

class ProtocolFolder : public test::TemporaryFolder {
 public:
  ProtocolFolder() {
    fs::create_directories(path() / "forms");
    Write("forms/consent.json", R"({"version": "1", "elements": []})");
  }
  Protocol Read(const std::string& yaml) const { return ReadProtocol(Write("study.yaml", yaml)); }
  std::string Refusal(const std::string& yaml) const {
    try {
      Read(yaml);
    } catch (const StartupError& error) {
      return error.what();
    }
    return "";
  }
};

constexpr const char* kParts = R"(name: colours
language: de
completion_code: random
maze: {robots: 2, speed: 3.0}
parts:
  - form: forms/consent.json
  - text: "Schön, dass Sie da sind."
    id: hello
  - rest: 45
    text: Ruhe
  - maze: teleop
    training: true
    speed: 1.5
    criterion: {attempts: 3, mapping_accuracy: 0.5}
  - methods: [ig-mcts, teleop]
    layouts: [7, 9]
    title: "Teil {part} von {parts}"
    introductions: {teleop: Fahren Sie.}
    before:
      - rest: 5
    after:
      - form: forms/consent.json
        id: again
  - form: forms/consent.json
    id: end
)";

TEST_CASE("a protocol is read in its order, and parts have the protocol's options of mazes",
          "[live_study]") {
  const Protocol protocol = ProtocolFolder().Read(kParts);
  CHECK(protocol.name == "colours");
  CHECK(protocol.language == "de");
  REQUIRE(protocol.parts.size() == 6);
  CHECK(protocol.parts[0].id == "consent");
  CHECK(protocol.parts[1].kind == Part::Kind::kText);
  CHECK(protocol.parts[1].text == "Schön, dass Sie da sind.");
  CHECK(protocol.parts[2].kind == Part::Kind::kRest);
  CHECK(protocol.parts[2].rest_s == 45.0);
  const Part& training = protocol.parts[3];
  CHECK(training.id == "training");
  CHECK(training.method == MethodKind::kTeleop);
  CHECK(training.criterion.attempts == 3);
  CHECK(training.maze.robots == 2);
  CHECK(training.maze.speed == 1.5);
  const Part& methods = protocol.parts[4];
  CHECK(methods.maze.speed == 3.0);
  CHECK(methods.introductions.at("teleop") == "Fahren Sie.");
  REQUIRE(methods.before.size() == 1);
  CHECK(methods.before[0].rest_s == 5.0);
  REQUIRE(methods.after.size() == 1);
  CHECK(methods.after[0].id == "again");
  CHECK(protocol.forms.size() == 1);
}

TEST_CASE("a wrong protocol is refused by file, line, key and value", "[live_study]") {
  const ProtocolFolder folder;
  const auto [yaml, line, named] = GENERATE(table<std::string, int, std::string>({
      {"nam: x", 1, "nam"},
      {"name: a/b\nparts: []", 1, "name"},
      {"parts: {}", 1, "parts"},
      {"name: x\nparts:\n  - forms: a.json", 3, "parts[1]"},
      {"parts:\n  - form: a.json\n    idd: x", 3, "idd"},
      {"parts:\n  - form: a.json\n    id: x_y", 3, "id"},
      {"parts:\n  - rest: 60\n  - rest: never", 3, "rest"},
      {"parts:\n  - maze: mapping", 2, "maze"},
      {"parts:\n  - maze: teleop\n    speed: -1", 3, "speed"},
      {"parts:\n  - maze: teleop\n    rotation_deg: 45", 3, "rotation_deg"},
      {"parts:\n  - maze: teleop\n    training: true\n    criterion: {attempts: 0}", 4, "attempts"},
      {"parts:\n  - methods: [teleop, teleop]", 2, "methods"},
      {"parts:\n  - methods: [teleop, ig-mcts]\n    layouts: [7]", 3, "layouts"},
      {"parts:\n  - methods: [teleop]\n    introductions: {ig-mcts: x}", 3, "introductions"},
      {"parts:\n  - methods: [teleop]\n    after:\n      - maze: teleop", 4, "after[1]"},
  }));
  const std::string refusal = folder.Refusal(yaml);
  INFO(yaml);
  CHECK_THAT(refusal, Catch::Contains("study.yaml") && Catch::Contains(named) &&
                          Catch::Contains(fmt::format("line {}", line)));
}

TEST_CASE("a protocol without what it names is refused", "[live_study]") {
  const ProtocolFolder folder;
  folder.Write("forms/broken.json", "[");
  const auto [yaml, named] = GENERATE(table<std::string, std::string>({
      {"", "parts"},
      {"parts: []", "parts"},
      {"parts:\n  - form: forms/none.json", "forms/none.json"},
      {"parts:\n  - form: forms/broken.json", "forms/broken.json"},
      {"parts:\n  - form: consent.json", "consent.json"},
      {"parts:\n  - form: forms/../../consent.json", "consent.json"},
      {"completion_code: random\nparts:\n  - rest: 1", "completion_code"},
      {"words: forms/none.json\nparts:\n  - rest: 1", "forms/none.json"},
      {"words: forms/consent.json\nparts:\n  - rest: 1", "'elements': is no text"},
  }));
  INFO(yaml);
  CHECK_THAT(folder.Refusal(yaml), Catch::Contains(named));
}

TEST_CASE("the page's words go with the protocol, and German ones come with conav",
          "[live_study]") {
  const Protocol protocol =
      ProtocolFolder().Read("words: forms/words-de.json\nparts:\n  - rest: 1");
  CHECK_THAT(protocol.forms.at("forms/words-de.json"), Catch::Contains("Beginnen"));
  const auto plan = PlanParticipant(protocol, "P01", 0);
  REQUIRE(plan);
  CHECK(plan->words == "forms/words-de.json");
}

TEST_CASE("a form that is not next to the protocol is one of conav's", "[live_study]") {
  const Protocol protocol = ProtocolFolder().Read("parts:\n  - form: forms/sus.json");
  CHECK_THAT(protocol.forms.at("forms/sus.json"), Catch::Contains("Brooke"));
}

TEST_CASE("the protocol that comes with conav is right", "[live_study]") {
  const Protocol protocol = ReadProtocol(ShippedProtocol());
  CHECK(protocol.name == "methods");
  CHECK(protocol.forms.size() == 6);
  CHECK(GapsOf(protocol) ==
        std::vector<std::string>{"forms/consent.json: [name, institution, e-mail]",
                                 "forms/consent.json: [ethics board, number]"});
}

TEST_CASE("a study's folder keeps protocol and forms, and refuses others", "[live_study]") {
  const ProtocolFolder folder;
  const fs::path study = folder / "study";
  fs::create_directories(study);
  REQUIRE(KeepProtocol(folder.Read(kParts), study));
  CHECK(ReadProtocol(study / "protocol.yaml").forms.size() == 1);
  CHECK(KeepProtocol(folder.Read(std::string("# another comment\n") + kParts), study));
  CHECK(FingerprintOf(folder.Read(kParts)) == FingerprintOf(ReadProtocol(study / "protocol.yaml")));

  std::string other = kParts;
  other.replace(other.find("rest: 45"), 8, "rest: 46");
  test::CheckRefusal(KeepProtocol(folder.Read(other), study),
                     Catch::Contains("parts/2/rest is \"45\" there, \"46\" here"),
                     ErrorCode::kRefused);
  folder.Write("forms/consent.json", R"({"version": "2", "elements": []})");
  test::CheckRefusal(KeepProtocol(folder.Read(kParts), study),
                     Catch::Contains("forms/consent.json"), ErrorCode::kRefused);
}

TEST_CASE("a text becomes a form with a paragraph for each block of lines", "[live_study]") {
  const auto form = nlohmann::json::parse(TextForm("Titel", "a <b>\nc\n\n\nd & e\n"));
  CHECK(form["title"] == "Titel");
  CHECK(form["elements"][0]["html"] == "<p>a &lt;b&gt;\nc</p><p>d &amp; e</p>");
}

}  // namespace
}  // namespace conav::live_study
