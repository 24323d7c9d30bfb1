#include "planner/explain/decision_file.h"

#include <decisions.pb.h>

#include <catch2/catch.hpp>
#include <vector>

#include "common/runtime/file.h"
#include "common/segments/record_stream.h"
#include "support/full_disk.h"
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

TEST_CASE("a file that is damaged is refused with its name", "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  Write(file, {SampleDecision(), SampleSnapshot(13)});
  std::string bytes = ReadFile(file).value();
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  REQUIRE(WriteFile(file, bytes));
  CHECK_THAT(Read(file).error, Catch::StartsWith(file.string() + ": "));
}

TEST_CASE("what is no decision file is refused, by the reader and by the writer",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  const auto refusal = [&](const std::string& bytes) {
    REQUIRE(WriteFile(file, bytes));
    return Read(file).error.substr(file.string().size() + 2);
  };
  CHECK_THAT(Read(folder / "none").error, Catch::Contains("none"));
  CHECK(refusal("") == "it is empty");
  CHECK(refusal("no zstd") == "it is not compressed with zstd");
  ZstdFrame other;
  other.Add("some text of another kind");
  const std::string text = other.Finish();
  CHECK(refusal(text) != "");
  const auto opened = DecisionLog::Open(file);
  REQUIRE_FALSE(opened);
  CHECK_THAT(opened.error().text, Catch::StartsWith(file.string() + ": "));
  CHECK(ReadFile(file).value() == text);  // as it was

  decisions::Record header = HeaderRecord();
  header.mutable_header()->set_schema_version(2);
  ZstdFrame frame;
  frame.Add(Delimited(header));
  CHECK(refusal(frame.Finish()) == "schema version 2; this program reads 1");
}

TEST_CASE("one planner at a time records to a file, into a folder that is there",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto first = DecisionLog::Open(folder / "decisions.pb.zst");
  REQUIRE(first);
  const auto second = DecisionLog::Open(folder / "decisions.pb.zst");
  REQUIRE_FALSE(second);
  CHECK(second.error().code == ErrorCode::kUnavailable);
  const auto nowhere = DecisionLog::Open(folder / "none/decisions.pb.zst");
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ErrorCode::kIo);
}

TEST_CASE("a decision that finds the disk full is told, and leaves the file as it was",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  auto log = DecisionLog::Open(file);
  REQUIRE(log);
  REQUIRE(log->Append(SampleDecision()));
  {
    const test::FullDisk full(std::filesystem::file_size(file) + 10);
    const auto written = log->Append(SampleSnapshot(13));
    REQUIRE_FALSE(written);
    CHECK(written.error().code == ErrorCode::kIo);
    CHECK_THAT(written.error().text, Catch::StartsWith(file.string() + ": cannot write"));
  }
  CHECK(Read(file).decisions == std::vector{SampleDecision()});
  CHECK_FALSE(Read(file).torn);
  REQUIRE(log->Append(SampleSnapshot(13)));
  CHECK(Read(file).decisions.size() == 2);
}

TEST_CASE("a device cannot be recorded to", "[planner][record]") {
  const auto log = DecisionLog::Open("/dev/full");
  REQUIRE_FALSE(log);
  CHECK(log.error().text == "/dev/full: cannot record: it is not a regular file");
}

}  // namespace
}  // namespace conav::planner
