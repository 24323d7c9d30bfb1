#include "unit/nhpm/training/train_program.h"

namespace conav::nhpm {
namespace {

TEST_CASE("conav-train adapts to one participant and keeps where the weights come from",
          "[adapt]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("base") + "--epochs 20").exit_code == 0);
  const std::string flags = "--data " + folder.data + " --adapt --base " + (folder / "base");
  const Outcome outcome = Run(flags + " --participant anna --out " + (folder / "anna"));
  INFO(outcome.text);
  REQUIRE(outcome.exit_code == 0);
  const NetworkModel base = ReadWeightsFile(folder / "base").value();
  const NetworkModel anna = ReadWeightsFile(folder / "anna").value();
  CHECK(anna.training.at("base_checksum") == ChecksumOf(base));
  CHECK(anna.training.at("adapt_participant") == "anna");
  CHECK(anna.training.at("adapt_segments") == "25");
  CHECK((anna.weights.weights[1] == base.weights.weights[1]));
  CHECK_FALSE((anna.weights.weights[3] == base.weights.weights[3]));
  CHECK(std::stod(anna.training.at("adapt_held_out_mbce")) <
        std::stod(anna.training.at("adapt_base_mbce")));
}

TEST_CASE("adapted weights name what their base learned from, and the person's trajectories",
          "[adapt]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("base") + "--epochs 1").exit_code == 0);
  const std::string flags = "--data " + folder.data + " --adapt --participant bert --out ";
  REQUIRE(Run(flags + (folder / "bert") + " --base " + (folder / "base")).exit_code == 0);
  const Fingerprints base = ReadWeightsFile(folder / "base").value().learned_from;
  const Fingerprints bert = ReadWeightsFile(folder / "bert").value().learned_from;
  CHECK(base.size() == 9);
  CHECK(bert.size() == 10);  // with the one that the base was tested on
  CHECK(Union(base, bert) == bert);
  NetworkModel unknown = ReadWeightsFile(folder / "base").value();
  unknown.learned_from.clear();
  REQUIRE(WriteWeightsFile(folder / "unknown", unknown));
  const std::string again = flags + (folder / "bert") + " --base " + (folder / "unknown");
  REQUIRE(Run(again + " --overwrite").exit_code == 0);
  CHECK(ReadWeightsFile(folder / "bert").value().learned_from.empty());
}

TEST_CASE("conav-train measures what adapting gains for each participant, and what it forgets",
          "[adapt]") {
  const DataFolder folder;
  REQUIRE(Run(folder.Flags("base") + "--epochs 20").exit_code == 0);
  const std::string flags = " --adapt --each --base " + (folder / "base");
  const Outcome seen = Run("--data " + folder.data + flags);
  CHECK(seen.exit_code == 1);
  CHECK_THAT(seen.text, Catch::Contains("base: learned from 2 of the 2"));
  REQUIRE(WriteSegmentFile(folder / "new.pb.zst", SmallSet(10, 7, 4)));
  const std::string run = "--data " + (folder / "new.pb.zst") + flags + " --json " + (folder / "j");
  const Outcome outcome = Run(run);
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.text, !Catch::Contains("warning"));
  CHECK_THAT(outcome.text, Catch::Contains("anna") && Catch::Contains("bert"));
  const auto json = nlohmann::json::parse(ReadFile(folder / "j").value());
  REQUIRE(json["people"].size() == 2);
  CHECK(json["people"][0]["learned_from_segments"] == 15);
  CHECK(json["people"][0]["tested_on_segments"] == 10);
  CHECK(json["people"][1]["adapted_mbce"].get<double>() > 0.0);
  CHECK_FALSE(json["people"][1].contains("base_general_mbce"));

  REQUIRE(WriteSegmentFile(folder / "general.pb.zst", SmallSet(10, 7, 5)));
  REQUIRE(Run(run + " --general " + (folder / "general.pb.zst")).exit_code == 0);
  const auto people = nlohmann::json::parse(ReadFile(folder / "j").value())["people"];
  CHECK(people[0]["base_general_mbce"].get<double>() > 0.0);
  CHECK(people[0]["base_general_mbce"] == people[1]["base_general_mbce"]);
  CHECK(people[0]["adapted_general_mbce"].get<double>() > 0.0);
  CHECK_THAT(Run(run + " --general " + folder.data).text,
             Catch::Contains("learned from 9 of the 10 trajectories"));
}

TEST_CASE("conav-train names what it cannot adapt", "[adapt]") {
  const DataFolder folder;
  const auto text_of = [&](const std::string& flags) {
    const Outcome outcome =
        Run("--data " + folder.data + " --out " + (folder / "w") + " --adapt " + flags);
    CHECK(outcome.exit_code == 1);
    return outcome.text;
  };
  CHECK_THAT(text_of("--base " + folder.data), Catch::Contains("data.pb.zst: no weights file"));
  NetworkModel model;
  model.weights = InitialWeights({16}, 1);
  REQUIRE(WriteWeightsFile(folder / "base", model));
  const std::string base = "--base " + (folder / "base");
  CHECK_THAT(text_of(base), Catch::Contains("--participant"));
  CHECK_THAT(text_of(base + " --participant carl"), Catch::Contains("'carl'"));
  model.rows = 13;
  model.columns = 13;
  REQUIRE(WriteWeightsFile(folder / "base", model));
  CHECK_THAT(text_of(base + " --participant anna"),
             Catch::Contains("has maps of 7 x 7 cells; the base is for 13 x 13"));
}

}  // namespace
}  // namespace conav::nhpm
