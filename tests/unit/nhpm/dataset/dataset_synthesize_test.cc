// `conav dataset synthesize`: options, file, summary, exit codes.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "nhpm/dataset/dataset_commands.h"
#include "nhpm/dataset/synthesize.h"
#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

using test::TemporaryFolder;

/// The exit code that `conav dataset synthesize OPTIONS` ends with.
int Synthesize(std::vector<std::string> options) {
  CLI::App app;
  int exit_code = -1;
  AddSynthesizeCommand(app, exit_code);
  options.insert(options.begin(), "synthesize");
  std::reverse(options.begin(), options.end());  // as CLI11 takes them
  try {
    app.parse(options);
  } catch (const CLI::ParseError&) {
    return 2;
  }
  return exit_code;
}

SegmentSet Read(const std::filesystem::path& file) {
  auto set = ReadSegmentFile(file);
  REQUIRE(set.has_value());
  return *std::move(set);
}

TEST_CASE("The file holds the trajectories of the library, in folders that may be new",
          "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  const auto file = folder / "very" / "new" / "set.pb.zst";
  REQUIRE(Synthesize({"--trajectories", "7", "--seed", "5", "--preset", "9x9", "--per-person", "2",
                      "--threads", "2", "--out", file.string()}) == 0);
  SynthesisOptions options;
  options.trajectories = 7;
  options.seed = 5;
  options.task.preset = "9x9";
  options.trajectories_per_person = 2;
  const auto expected = SynthesizeSegments(options);
  REQUIRE(expected.has_value());
  CHECK(Read(file) == expected->set);
}

TEST_CASE("Equal seeds give equal files, whatever the number of threads", "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  const auto bytes_of = [&](const std::string& seed, const std::string& threads) {
    const auto file = folder / ("set-" + seed + "-" + threads);
    REQUIRE(Synthesize({"--trajectories", "9", "--seed", seed, "--threads", threads, "--out",
                        file.string()}) == 0);
    const auto bytes = ReadFile(file);
    REQUIRE(bytes.has_value());
    return *bytes;
  };
  CHECK(bytes_of("3", "1") == bytes_of("3", "4"));
  CHECK(bytes_of("3", "1") != bytes_of("4", "1"));
}

TEST_CASE("The summary counts what is in the file and calls it synthetic", "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  const auto file = folder / "set.pb.zst";
  REQUIRE(Synthesize({"--trajectories", "12", "--out", file.string(), "--json",
                      (folder / "summary.json").string()}) == 0);
  const auto summary = nlohmann::json::parse(std::ifstream(folder / "summary.json"));
  const SegmentSet set = Read(file);
  int edits = 0;
  std::size_t segments = 0;
  for (const Trajectory& trajectory : set.trajectories) {
    segments += trajectory.segments.size();
    for (const Segment& segment : trajectory.segments) edits += EditCount(segment);
  }
  CHECK(summary["origin"] == "synthetic");
  CHECK(summary["accepted"] == 12);
  CHECK(summary["segments"] == segments);
  CHECK(summary["edits"] == edits);
  CHECK(summary["edits_per_segment"].get<double>() ==
        Approx(edits / static_cast<double>(segments)));
  const double excluded = summary["excluded"].get<double>();
  CHECK(summary["excluded_share"].get<double>() == Approx(excluded / (excluded + 12.0)));
}

TEST_CASE("Another population makes other people", "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "people.yaml")
      << "annotators: {ros__parameters: {careless_share: 0.0, careful: {near_cells: {mean: 1.5}}}}";
  const auto file = folder / "set.pb.zst";
  REQUIRE(Synthesize({"--trajectories", "3", "--population", (folder / "people.yaml").string(),
                      "--out", file.string()}) == 0);
  for (const Trajectory& trajectory : Read(file).trajectories) {
    CHECK(trajectory.annotator.at("near_cells") == 1.5);
  }
}

TEST_CASE("Wrong use has exit code 2, a bad input 1, both make no file", "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  const std::string file = (folder / "set.pb.zst").string();
  std::ofstream(folder / "people.yaml") << "annotators: {ros__parameters: {cautious: {}}}";
  CHECK(Synthesize({"--trajectories", "0", "--out", file}) == 2);
  CHECK(Synthesize({"--seed", "-1", "--out", file}) == 2);
  CHECK(Synthesize({"--threads", "0", "--out", file}) == 2);
  CHECK(Synthesize({"--per-person", "0", "--out", file}) == 2);
  CHECK(Synthesize({"--colour", "red", "--out", file}) == 2);
  CHECK(Synthesize({"--preset", "9x8", "--out", file}) == 2);
  CHECK(Synthesize({"--population", (folder / "none.yaml").string(), "--out", file}) == 1);
  CHECK(Synthesize({"--population", (folder / "people.yaml").string(), "--out", file}) == 1);
  CHECK_FALSE(std::filesystem::exists(file));
}

TEST_CASE("An output that cannot be written is wrong use, a full disk is not",
          "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  const std::string file = (folder / "set.pb.zst").string();
  REQUIRE(WriteFile(folder / "file", ""));
  const std::string below = (folder / "file/set").string();
  CHECK(Synthesize({"--trajectories", "1", "--out", below}) == 2);
  CHECK(Synthesize({"--trajectories", "1", "--out", file, "--json", below}) == 2);
  CHECK_FALSE(std::filesystem::exists(file));
  CHECK(Synthesize({"--trajectories", "1", "--out", "/dev/full"}) == 1);
  CHECK(Synthesize({"--trajectories", "1", "--out", file, "--json", "/dev/full"}) == 1);
}

TEST_CASE("People who all fail the filter have exit code 1", "[nhpm][synthesis]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "people.yaml")
      << "annotators: {ros__parameters: {careless_share: 0.0,"
         " careful: {lapse_probability: {mean: 1.0, deviation: 0.0}}}}";
  const std::string file = (folder / "set.pb.zst").string();
  CHECK(Synthesize({"--trajectories", "1", "--population", (folder / "people.yaml").string(),
                    "--out", file}) == 1);
  CHECK_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace conav::nhpm
