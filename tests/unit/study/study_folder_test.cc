#include "study/study_folder.h"

#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "study/study_run.h"
#include "support/temporary_folder.h"
#include "unit/study/sample_study.h"

namespace conav::study {
namespace {

const nlohmann::ordered_json kDesign{{"operators", 14}, {"seed", 1}};

std::string Refusal(const std::filesystem::path& path,
                    const nlohmann::ordered_json& design = kDesign) {
  const auto folder = StudyFolder::Open(path, design);
  return folder ? "" : folder.error().text;
}

TEST_CASE("A record is there again for the same design", "[study]") {
  const test::TemporaryFolder parent;
  const auto record = SampleRecord("s01", SampleMeasures(10.0, 400.0));
  EpisodeRecord failed{.name = "s02", .detail = "planner died", .attempts = 2};
  {
    const auto folder = StudyFolder::Open(parent / "study", kDesign);
    REQUIRE(folder);
    auto store = OpenEpisodes(*folder);
    REQUIRE(store);
    REQUIRE(store->Save("s01", record));
    REQUIRE(store->Save("s02", failed));
  }
  const auto folder = StudyFolder::Open(parent / "study", kDesign);
  REQUIRE(folder);
  const auto store = OpenEpisodes(*folder);
  REQUIRE(store);
  CHECK(store->records() == Records{{"s01", record}, {"s02", failed}});
}

TEST_CASE("What a kill leaves of a file that was being written is no obstacle", "[study]") {
  const test::TemporaryFolder parent;
  std::filesystem::create_directory(parent / "study");
  REQUIRE(WriteFile(parent / "study/study.json.0123456789abcdef.partial", "{\"fing"));
  const auto folder = StudyFolder::Open(parent / "study", kDesign);
  REQUIRE(folder);
  REQUIRE(OpenEpisodes(*folder));
  REQUIRE(WriteFile(parent / "study/episodes/s01.json.0123456789abcdef.partial", "{\"name"));
  const auto store = OpenEpisodes(*folder);
  REQUIRE(store);
  CHECK(store->records().empty());
}

TEST_CASE("A folder of another design, of other files, or in use is refused and left alone",
          "[study]") {
  const test::TemporaryFolder parent;
  const auto study = parent / "study";
  {
    const auto first = StudyFolder::Open(study, kDesign);
    REQUIRE(first);
    CHECK_THAT(Refusal(study), Catch::Contains("in use"));
  }
  nlohmann::ordered_json other = kDesign;
  other["seed"] = 2;
  CHECK_THAT(Refusal(study, other), Catch::Contains("seed is 1 there, 2 here"));
  CHECK(Refusal(study).empty());
  REQUIRE(WriteFile(study / "study.json", "{"));
  CHECK_THAT(Refusal(study), Catch::Contains("study.json"));

  REQUIRE(std::filesystem::create_directory(parent / "mine"));
  REQUIRE(WriteFile(parent / "mine/thesis.txt", "my thesis"));
  CHECK_THAT(Refusal(parent / "mine"), Catch::Contains("contains no study"));
  CHECK(std::distance(std::filesystem::directory_iterator(parent / "mine"), {}) == 1);
  CHECK_THAT(Refusal(parent / "mine/thesis.txt"), Catch::Contains("thesis.txt"));
}

TEST_CASE("A record that cannot be read is named", "[study]") {
  const test::TemporaryFolder parent;
  const auto folder = StudyFolder::Open(parent / "study", kDesign);
  REQUIRE(folder);
  REQUIRE(OpenEpisodes(*folder));
  const auto file = parent / "study/episodes/s01.json";
  for (const char* text : {"{\"name\": \"s01\"", "{}", R"({"name": "s01", "status": "complete",
        "detail": "", "attempts": 1, "wall_s": 1, "run": "", "measures": null})"}) {
    REQUIRE(WriteFile(file, text));
    const auto store = OpenEpisodes(*folder);
    REQUIRE_FALSE(store);
    CHECK_THAT(store.error().text, Catch::StartsWith(file.string() + ": is not a record of") &&
                                       Catch::EndsWith("the same command runs this piece again"));
  }
}

}  // namespace
}  // namespace conav::study
