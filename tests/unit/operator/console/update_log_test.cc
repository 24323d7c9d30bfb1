#include "operator/console/update_log.h"

#include <catch2/catch.hpp>
#include <random>
#include <thread>

#include "unit/operator/support/updates.h"

namespace conav::operators {
namespace {

/// "a=1 b=2", oldest first.
std::string Text(const std::vector<console::Update>& updates) {
  std::string text;
  for (const console::Update& update : updates) {
    if (!text.empty()) text += ' ';
    text += update.service().name() + '=' + update.service().message();
  }
  return text;
}

void Put(UpdateLog& log, const std::string& key, const std::string& message) {
  log.Put(key, Said(key, message));
}

/// A page that reads on from what it has, in messages of up to `size_limit` bytes.
struct Reader {
  std::uint64_t generation = 0;
  std::uint64_t sequence = 0;
  std::map<std::string, std::string> known;
  int repeated = 0;  // updates that it had already

  bool Read(const UpdateLog& log, std::size_t size_limit) {
    const UpdateLog::Batch batch = log.After(generation, sequence, size_limit);
    if (batch.generation != generation) {
      known.clear();
      sequence = 0;
    }
    for (const console::Update& update : Parsed(batch)) {
      if (update.sequence() <= sequence) ++repeated;
      sequence = update.sequence();
      known[update.service().name()] = update.service().message();
    }
    CHECK(batch.sequence == sequence);
    generation = batch.generation;
    return batch.more;
  }

  void ReadAll(const UpdateLog& log, std::size_t size_limit) {
    while (Read(log, size_limit)) {
    }
  }
};

}  // namespace

TEST_CASE("updates that are put together come together, an empty log has none",
          "[operator][console]") {
  const UpdateLog empty;
  const auto batch = empty.After(empty.generation(), 0, 1000);
  CHECK(batch.updates.empty());
  CHECK_FALSE(batch.more);
  CHECK(empty.bytes() == 0);
  UpdateLog log;
  Put(log, "a", "1");
  Reader page;
  page.ReadAll(log, 1000);
  {
    const UpdateLog::Together together(log);
    log.Clear();
    Put(log, "b", "1");
    Put(log, "b", "2");
    page.ReadAll(log, 1000);
    CHECK(page.known == std::map<std::string, std::string>{{"a", "1"}});
  }
  page.ReadAll(log, 1000);
  CHECK(page.known == std::map<std::string, std::string>{{"b", "2"}});
  CHECK(page.repeated == 0);
}

TEST_CASE("a log holds the newest update of each key", "[operator][console]") {
  UpdateLog log;
  SECTION("a newer update of a key takes the place of the older one") {
    Put(log, "a", "1");
    const std::size_t bytes_of_one = log.bytes();
    Put(log, "b", "1");
    Put(log, "a", "2");
    CHECK(Text(AllOf(log)) == "b=1 a=2");
    CHECK(log.sequence() == 3);
    CHECK(log.bytes() == 2 * bytes_of_one);
  }
  SECTION("a batch holds what fits, and at least one update") {
    for (const char* key : {"a", "b", "c"}) Put(log, key, "1");
    const std::size_t one = log.bytes() / 3;
    const auto size = GENERATE(std::size_t{0}, std::size_t{1}, std::size_t{2});
    const auto batch = log.After(log.generation(), 0, size * one);
    CHECK(Parsed(batch).size() == std::max<std::size_t>(size, 1));
    CHECK(batch.more);
    CHECK_FALSE(log.After(log.generation(), 0, 3 * one).more);
  }
  SECTION("forgetting an update begins a generation of the others") {
    Put(log, "a/1", "1");
    Put(log, "b/1", "1");
    const std::uint64_t before = log.generation();
    log.Forget([](std::string_view key) { return key.starts_with("a/"); });
    CHECK(log.generation() == before + 1);
    CHECK(Text(AllOf(log)) == "b/1=1");
    CHECK(Text(Parsed(log.After(before, 2, 1000))) == "b/1=1");  // from the beginning
    CHECK(log.sequence() == 2);
  }
  SECTION("after Clear nothing is left but the count") {
    log.Put("g1", Said("g1", "1"), "g", 3);
    Put(log, "a", "1");
    log.Clear();
    CHECK(AllOf(log).empty());
    CHECK(log.bytes() == 0);
    Put(log, "a", "2");
    CHECK(log.sequence() == 3);
  }
}

TEST_CASE("of a group the newest updates are kept", "[operator][console]") {
  UpdateLog log;
  SECTION("of a group the newest are kept") {
    for (const char* key : {"g1", "g2", "g3"}) log.Put(key, Said(key, "1"), "g", 2);
    log.Put("h1", Said("h1", "1"), "h", 2);
    CHECK(Text(AllOf(log)) == "g2=1 g3=1 h1=1");
    log.Put("g2", Said("g2", "2"), "g", 2);  // changed, and no newer than it was
    log.Put("g4", Said("g4", "1"), "g", 2);
    CHECK(Text(AllOf(log)) == "g3=1 h1=1 g4=1");
  }
  SECTION("an older update belongs to a group from the moment when it is put there") {
    for (const char* key : {"a1", "a2", "a3"}) log.Put(key, Said(key, "1"));
    for (const char* key : {"a2", "a3"}) log.Put(key, Said(key, "2"), "a", 1);
    CHECK(Text(AllOf(log)) == "a1=1 a3=2");
  }
  SECTION("a group goes on after some of it was forgotten") {
    for (const char* key : {"g1", "g2", "g3"}) log.Put(key, Said(key, "1"), "g", 3);
    log.Forget([](std::string_view key) { return key == "g2"; });
    for (const char* key : {"g4", "g5"}) log.Put(key, Said(key, "1"), "g", 3);
    CHECK(Text(AllOf(log)) == "g3=1 g4=1 g5=1");
  }
}

TEST_CASE("resumed anywhere, a page ends where a fresh one does, and gets nothing twice",
          "[operator][console]") {
  std::mt19937 random(GENERATE(range(1U, 21U)));
  const auto up_to = [&](int n) { return std::uniform_int_distribution<int>(0, n)(random); };
  UpdateLog log;
  std::vector<Reader> readers(8);
  for (int step = 0; step < 400; ++step) {
    const std::string key = std::string(1, static_cast<char>(97 + up_to(9)));
    if (up_to(60) == 0) log.Forget([&](std::string_view known) { return known == key; });
    Put(log, key, std::to_string(step));
    const auto reader = static_cast<std::size_t>(up_to(7));
    if (up_to(3) == 0) readers[reader].Read(log, static_cast<std::size_t>(up_to(60)));
  }
  Reader fresh;
  fresh.ReadAll(log, 1000);
  for (Reader& reader : readers) {
    reader.ReadAll(log, 30);
    CHECK(reader.known == fresh.known);
    CHECK(reader.repeated == 0);
  }
}

TEST_CASE("what an experimenter writes about a participant goes to experimenters only",
          "[operator][console]") {
  UpdateLog log;
  console::Update notes;
  notes.mutable_study_log();
  Put(log, "a", "1");
  log.Put("notes", notes);
  CHECK(AllOf(log).size() == 1);
  const auto all = log.After(0, 0, SIZE_MAX, UpdateLog::Reader::kExperimenter);
  CHECK(Parsed(all).size() == 2);
  CHECK(log.After(log.generation(), 1, SIZE_MAX).updates.empty());
}

TEST_CASE("pages read while others write", "[operator][console]") {
  UpdateLog log;
  constexpr int kRounds = 3000;
  const auto write = [&log](const std::string& key) {
    for (int i = 0; i < kRounds; ++i) {
      Put(log, key, std::to_string(i));
      log.Put(key + std::to_string(i), Said(key + std::to_string(i), ""), key, 5);
    }
  };
  std::thread first(write, "a");
  std::thread second(write, "b");
  Reader reader;
  while (log.sequence() < 4 * kRounds) reader.Read(log, 100);
  first.join();
  second.join();
  reader.ReadAll(log, 100);
  CHECK(reader.repeated == 0);
  CHECK(reader.known["a"] == std::to_string(kRounds - 1));
  CHECK(reader.known["b"] == std::to_string(kRounds - 1));
  CHECK(AllOf(log).size() == 12);
}

}  // namespace conav::operators
