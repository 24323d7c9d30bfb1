#include "planner/explain/decision_file.h"

#include <decisions.pb.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "common/runtime/file.h"
#include "common/segments/record_stream.h"
#include "support/temporary_folder.h"
#include "unit/planner/explain/sample_decision.h"

namespace conav::planner {
namespace {

struct Contents {
  std::vector<DecisionRecord> decisions;
  bool torn = false;
  std::string error;
};

Contents Read(const std::filesystem::path& file) {
  Contents contents;
  const auto torn = ReadDecisions(
      file, [&](DecisionRecord&& decision) { contents.decisions.push_back(std::move(decision)); });
  contents.torn = torn.value_or(false);
  if (!torn) contents.error = torn.error().text;
  return contents;
}

void Write(const std::filesystem::path& file, const std::vector<DecisionRecord>& decisions) {
  auto log = DecisionLog::Open(file);
  REQUIRE(log);
  for (const DecisionRecord& decision : decisions) REQUIRE(log->Append(decision));
}

TEST_CASE("decisions are read as they were written, also while the file grows",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  auto log = DecisionLog::Open(file);
  REQUIRE(log);
  CHECK(Read(file).decisions.empty());
  REQUIRE(log->Append(SampleDecision()));
  CHECK(Read(file).decisions == std::vector{SampleDecision()});
  REQUIRE(log->Append(SampleSnapshot(13)));
  CHECK(Read(file).decisions == std::vector{SampleDecision(), SampleSnapshot(13)});
  CHECK_FALSE(Read(file).torn);
}

TEST_CASE("a file that a kill cut off loses its last decision only, and is continued",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  Write(file, {SampleDecision()});
  const auto complete = std::filesystem::file_size(file);
  Write(file, {SampleSnapshot(13)});
  const auto size = std::filesystem::file_size(file);
  for (auto cut = complete + 1; cut < size; cut += 64) {
    std::filesystem::resize_file(file, cut);
    const Contents contents = Read(file);
    CHECK(contents.torn);
    CHECK(contents.decisions == std::vector{SampleDecision()});
    Write(file, {SampleSnapshot(13)});
    CHECK(Read(file).decisions == std::vector{SampleDecision(), SampleSnapshot(13)});
  }
}

TEST_CASE("a file of another kind is refused, by the reader and by the writer",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  Write(file, {SampleDecision(), SampleSnapshot(13)});
  std::string damaged = ReadFile(file).value();
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 0x55);
  ZstdFrame text;
  text.Add("some text of another kind");
  decisions::Record header = HeaderRecord();
  header.mutable_header()->set_schema_version(2);
  ZstdFrame newer;
  newer.Add(Delimited(header));
  CHECK_THAT(Read(folder / "none").error, Catch::Contains("none"));
  for (const auto& [bytes, named] :
       std::vector<std::pair<std::string, const char*>>{{damaged, ""},
                                                        {"", ""},
                                                        {"no zstd", "zstd"},
                                                        {newer.Finish(), "2"},
                                                        {text.Finish(), ""}}) {
    REQUIRE(WriteFile(file, bytes));
    const std::string error = Read(file).error;
    REQUIRE_THAT(error, Catch::StartsWith(file.string() + ": "));
    CHECK_THAT(error.substr(file.string().size()), Catch::Contains(named));
  }
  const std::string before = ReadFile(file).value();
  const auto opened = DecisionLog::Open(file);
  REQUIRE_FALSE(opened);
  CHECK_THAT(opened.error().text, Catch::StartsWith(file.string() + ": "));
  CHECK(ReadFile(file).value() == before);
}

TEST_CASE("one planner at a time records, to a regular file in a folder that is there",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto first = DecisionLog::Open(folder / "decisions.pb.zst");
  REQUIRE(first);
  const auto second = DecisionLog::Open(folder / "decisions.pb.zst");
  REQUIRE_FALSE(second);
  CHECK(second.error().code == ErrorCode::kUnavailable);
  CHECK(DecisionLog::Open(folder / "none/decisions.pb.zst").error().code == ErrorCode::kIo);
  CHECK_THAT(DecisionLog::Open("/dev/full").error().text, Catch::StartsWith("/dev/full: "));
}

TEST_CASE("decisions come back from their records, without cells that the map does not have",
          "[planner][record]") {
  for (const DecisionRecord& decision :
       {SampleDecision(), SampleSnapshot(3), SampleWithoutSearch(), SampleLowLevelAction()}) {
    const auto back = FromRecord(ToRecord(decision).decision());
    REQUIRE(back);
    CHECK(*back == decision);
  }
  DecisionRecord decision = SampleDecision();
  decision.guidance.push_back({7, 7});
  CHECK(FromRecord(ToRecord(decision).decision()).value() == SampleDecision());
}

TEST_CASE("records that no decision can have are refused by field and value", "[planner][record]") {
  using R = decisions::Decision;
  struct Row {
    const char* field;
    const char* value;
    void (*spoil)(R&);
  };
  for (const auto& [field, value, spoil] : std::vector<Row>{
           {"map", "0 x 5", [](R& r) { r.set_rows(0); }},
           {"map", "5 x 1025", [](R& r) { r.set_columns(1025); }},
           {"25 cells of the robot's map", "4 x 5", [](R& r) { r.set_rows(4); }},
           {"map", "value 3", [](R& r) { (*r.mutable_map())[3] = '\3'; }},
           {"24 of the operator's", "5 x 5", [](R& r) { r.mutable_belief()->RemoveLast(); }},
           {"belief", "1.5", [](R& r) { r.set_belief(2, 1.5F); }},
           {"belief", "nan", [](R& r) { r.set_belief(2, NAN); }},
           {"robot", "cell 25", [](R& r) { r.set_cell(25); }},
           {"path", "cell 99", [](R& r) { r.set_path(0, 99); }},
           {"chosen", "action 4", [](R& r) { r.set_chosen(4); }},
           {"taken", "kind 0", [](R& r) { r.mutable_taken()->set_kind(0); }},
           {"taken", "kind 4", [](R& r) { r.mutable_taken()->set_kind(4); }},
           {"action", "kind 3", [](R& r) { r.mutable_actions(1)->set_kind(3); }},
           {"action", "nan", [](R& r) { r.mutable_actions(1)->set_mean_value(NAN); }},
           {"action", "8 terms", [](R& r) { r.mutable_actions(1)->add_terms(1.0); }},
           {"tree", "6 and 5 nodes", [](R& r) { r.mutable_tree()->add_parent(0); }},
           {"tree", "parent 2", [](R& r) { r.mutable_tree()->set_parent(2, 2); }},
           {"tree", "parent -1", [](R& r) { r.mutable_tree()->set_parent(1, -1); }},
           {"views", "columns", [](R& r) { r.mutable_views()->add_cell(1); }}}) {
    R record = ToRecord(SampleDecision()).decision();
    spoil(record);
    const auto result = FromRecord(record);
    CAPTURE(field, value);
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::kMalformed);
    CHECK_THAT(result.error().text, Catch::Contains(field) && Catch::Contains(value));
  }
}

}  // namespace
}  // namespace conav::planner
