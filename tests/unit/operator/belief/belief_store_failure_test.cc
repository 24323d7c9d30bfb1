// What the store does when the disk, the file or the process fails.
#include <fmt/core.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "operator/belief/belief_store.h"
#include "support/drawn_map.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"

namespace conav::operators {

using test::TemporaryFolder;
namespace {

const BeliefGrid kFreeMap(41, 41, 0.0F);

OperatorRequest EditNext(std::uint64_t id, std::uint64_t base) {
  const int cell = static_cast<int>(base);
  return {{2}, "anna", id, "w1", EditRequest{base, {{{1 + cell / 39 % 39, 1 + cell % 39}, true}}}};
}

void FillWorld(BeliefStore& store) {
  REQUIRE(store.AddWorld("w1", kFreeMap, {1}));
  store.AddRobot("r1", "w1");
}

std::string StartupFailure(const std::filesystem::path& file) {
  try {
    const BeliefStore store({{file}, {}});
    return "";
  } catch (const StartupError& error) {
    return error.what();
  }
}

/// Accepts edits without an end and writes one byte to `acknowledgements` after each.
[[noreturn]] void EditForever(const std::filesystem::path& file, int acknowledgements) {
  BeliefStore store({{file}, {}});
  if (!store.AddWorld("w1", kFreeMap, {1})) _exit(3);
  for (std::uint64_t i = 0;; ++i) {
    if (!store.Handle(EditNext(i + 1, i), {3}).reply.accepted) _exit(4);
    if (write(acknowledgements, "a", 1) != 1) _exit(5);
  }
}

TEST_CASE("Acknowledged requests are there after kill -9", "[operator][belief]") {
  const TemporaryFolder folder;
  const auto file = folder / "operator.db";
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) EditForever(file, ends[1]);
  close(ends[1]);

  std::uint64_t acknowledged = 0;
  char byte = 0;
  while (acknowledged < 25 && read(ends[0], &byte, 1) == 1) ++acknowledged;
  kill(child, SIGKILL);
  while (read(ends[0], &byte, 1) == 1) ++acknowledged;  // those that were under way
  int status = 0;
  waitpid(child, &status, 0);
  close(ends[0]);
  REQUIRE(WIFSIGNALED(status));
  REQUIRE(acknowledged >= 25);

  BeliefStore store({{file}, {}});
  const Belief* belief = store.FindBelief("w1");
  REQUIRE(belief != nullptr);
  // The last edit may have reached the disk without its acknowledgement.
  CHECK(belief->revision >= acknowledged);
  CHECK(belief->revision <= acknowledged + 1);
  double walls = 0;
  for (const float probability : belief->wall_probability.values()) {
    walls += static_cast<double>(probability);
  }
  CHECK(walls == static_cast<double>(belief->revision));
  for (std::uint64_t id = 1; id <= acknowledged; ++id) {
    const auto repeated = store.Handle(EditNext(id, id - 1), {9});
    CHECK(repeated.reply == OperatorReply{"anna", id, true, "", id});
    CHECK_FALSE(repeated.changed);
  }
}

TEST_CASE("On a full database requests are refused, nothing is lost and the store goes on",
          "[operator][belief]") {
  const TemporaryFolder folder;
  BeliefStore store({{folder / "operator.db", 100 * 1024}, {}});
  FillWorld(store);
  std::uint64_t id = 0;
  BeliefStore::Answer answer;
  do {
    ++id;
    REQUIRE(id < 10000);
    answer = store.Handle(EditNext(id, id - 1), {3});
  } while (answer.reply.accepted);
  CHECK_FALSE(answer.storage_failure.empty());
  CHECK_THAT(answer.reply.reason, Catch::Contains("full") && Catch::Contains("operator.db"));
  CHECK(store.FindBelief("w1")->revision == id - 1);
  CHECK(store.Handle(EditNext(1, 0), {3}).reply.accepted);  // of the first time
  CHECK_FALSE(store.Handle(EditNext(id + 1, id - 1), {3}).reply.accepted);
}

TEST_CASE("A write that fails refuses the request, a repeat succeeds when the disk is well again",
          "[operator][belief]") {
  const TemporaryFolder folder;
  const auto file = folder / "operator.db";
  {
    BeliefStore store({{file}, {}});
    FillWorld(store);
    REQUIRE(store.Handle(EditNext(1, 0), {3}).reply.accepted);
    BeliefStore::Answer failed;
    {
      const test::FullDisk full(4096);
      failed = store.Handle(EditNext(2, 1), {3});
    }
    CHECK_FALSE(failed.reply.accepted);
    CHECK_FALSE(failed.storage_failure.empty());
    CHECK_FALSE(failed.written);
    CHECK(failed.reply.reason.find("not stored") != std::string::npos);
    CHECK(store.FindBelief("w1")->revision == 1);

    const auto repeated = store.Handle(EditNext(2, 1), {3});
    CHECK(repeated.reply.accepted);
    CHECK(repeated.reply.revision == 2);
  }
  CHECK(BeliefStore({{file}, {}}).FindBelief("w1")->revision == 2);
}

TEST_CASE("A file that is no database of ours, or cannot be, stops the start by name",
          "[operator][belief]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "operator.db") << std::string(8192, 'x');
  REQUIRE(Database::Open({folder / "other.db"})->Execute("CREATE TABLE songs (title TEXT)"));
  const auto [name, named] = GENERATE(table<std::string, std::string>(
      {{"operator.db", ""}, {"nowhere/operator.db", ""}, {"other.db", "another program"}}));
  CHECK_THAT(StartupFailure(folder / name),
             Catch::Contains((folder / name).string()) && Catch::Contains(named));
}

TEST_CASE("A damaged database stops the start and names the file or the table",
          "[operator][belief]") {
  const TemporaryFolder folder;
  const auto file = folder / "operator.db";
  {
    BeliefStore store({{file}, {}});
    FillWorld(store);
  }
  REQUIRE(StartupFailure(file).empty());
  // The faults report's S15: "Stored belief with NaN or random floats is loaded (sizes are checked,
  // values not)."
  const std::string damage =
      GENERATE("", "UPDATE beliefs SET cells = x'00'", "UPDATE beliefs SET rows = 'many'",
               "UPDATE beliefs SET rows = -41, columns = -41", "0000C07F", "00000040", "000080BF");
  CAPTURE(damage);
  if (damage.empty()) {
    const std::string zs(std::filesystem::file_size(file) - 4096, 'Z');
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(4096) << zs;
  } else if (damage.starts_with("UPDATE")) {
    REQUIRE(Database::Open({file})->Execute(damage));
  } else {  // NaN, 2 and -1
    const std::string floats = fmt::format("{:0>{}}", damage, 8 * kFreeMap.size());
    REQUIRE(
        Database::Open({file})->Execute(fmt::format("UPDATE beliefs SET cells = x'{}'", floats)));
  }
  CHECK_THAT(StartupFailure(file), Catch::Contains(damage.empty() ? file.string() : "belief"));
}

// The faults report's S16: "operator.db, its WAL, run config 0644: world-readable".
TEST_CASE("A database and its log are for their owner, also one that was not",
          "[operator][belief]") {
  const TemporaryFolder folder;
  const auto file = folder / "operator.db";
  if (GENERATE(false, true)) {
    std::ofstream(file).close();
    std::filesystem::permissions(file, std::filesystem::perms{0644});
  }
  BeliefStore store({{file}, {}});
  FillWorld(store);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    CAPTURE(entry.path());
    CHECK(entry.status().permissions() == std::filesystem::perms{0600});
    ++files;
  }
  CHECK(files == 2);
}

TEST_CASE("A second process cannot open a store that is in use", "[operator][belief]") {
  const TemporaryFolder folder;
  const auto file = folder / "operator.db";
  const BeliefStore store({{file}, {}});
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) _exit(StartupFailure(file).find("another process") != std::string::npos ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace conav::operators
