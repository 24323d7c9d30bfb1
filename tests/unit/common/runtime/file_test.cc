#include "common/runtime/file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <future>
#include <string>

#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

using Folder = test::TemporaryFolder;

TEST_CASE("A file is read as it was written, zero bytes included", "[file]") {
  const Folder folder;
  const auto write = GENERATE(&WriteFile, &WriteDurableFile, &WriteSecretFile);
  for (const std::string& bytes :
       {std::string("old"), std::string("a\0\r\n\xff", 5), std::string()}) {
    REQUIRE(write(folder / "x", bytes));
    CHECK(ReadFile(folder / "x").value() == bytes);
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("A missing file, a folder and a read that fails give different errors", "[file]") {
  const Folder folder;
  CHECK(ReadFile(folder / "x").error().code == ErrorCode::kNotFound);
  CHECK(ReadFile(folder.path()).error().code == ErrorCode::kIo);
  test::CheckRefusal(ReadFile("/proc/self/mem"), Catch::StartsWith("/proc/self/mem: "),
                     ErrorCode::kIo);
}

// The faults report's S17: "`stats /dev/zero` reads for ever; `--config /dev/zero` says only
// `std::bad_alloc`. ReadFile has no limit."
TEST_CASE("A file without an end, or too large for memory, is refused by name", "[file]") {
  const Folder folder;
  std::ofstream(folder / "sparse").close();
  std::filesystem::resize_file(folder / "sparse", kReadLimit + 1);
  for (const std::filesystem::path& file :
       {folder / "sparse", std::filesystem::path("/dev/zero")}) {
    test::CheckRefusal(ReadFile(file), Catch::Contains(file.string()) && Catch::Contains("MiB"),
                       ErrorCode::kRefused);
  }
}

TEST_CASE("A secret is its owner's only, also where the file was everybody's", "[file]") {
  const Folder folder;
  REQUIRE(WriteFile(folder / "x", "old"));
  REQUIRE(WriteSecretFile(folder / "x", "secret"));
  CHECK(std::filesystem::status(folder / "x").permissions() == std::filesystem::perms{0600});
  CHECK(ReadFile(folder / "x").value() == "secret");
}

TEST_CASE("A file that may not be looked for is not called missing", "[file]") {
  if (::geteuid() == 0) return;  // root may
  const Folder folder;
  const auto closed = folder / "closed";
  REQUIRE(std::filesystem::create_directory(closed));
  REQUIRE(WriteFile(closed / "x", "1"));
  std::filesystem::permissions(closed, std::filesystem::perms::none);
  const auto read = ReadFile(closed / "x");
  std::filesystem::permissions(closed, std::filesystem::perms::owner_all);
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::kIo);
}

TEST_CASE("A new file has the rights that the user's mask gives", "[file]") {
  const Folder folder;
  const ::mode_t mask = ::umask(027);
  const auto written = WriteFile(folder / "x", "1");
  ::umask(mask);
  REQUIRE(written);
  CHECK(static_cast<unsigned>(std::filesystem::status(folder / "x").permissions()) == 0640);
}

TEST_CASE("Writers of one path do not disturb each other", "[file]") {
  const Folder folder;
  const std::string texts[] = {std::string(1U << 20, 'a'), std::string(1U << 19, 'b')};
  const auto write = [&](const std::string& text) {
    for (int i = 0; i < 20; ++i) {
      if (!CheckWritable(folder / "x") || !WriteFile(folder / "x", text)) return false;
    }
    return true;
  };
  auto other = std::async(std::launch::async, write, texts[1]);
  CHECK(write(texts[0]));
  CHECK(other.get());
  const std::string read = ReadFile(folder / "x").value();
  CHECK((read == texts[0] || read == texts[1]));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("A path that cannot be written is known before and after, the check leaves no trace",
          "[file]") {
  const Folder folder;
  REQUIRE(std::filesystem::create_directory(folder / "taken"));
  for (const std::filesystem::path& path :
       {std::filesystem::path("/nonexistent/folder/x"), folder / "taken"}) {
    const auto check = CheckWritable(path);
    REQUIRE_FALSE(check);
    CHECK(check.error().code == ErrorCode::kIo);
    CHECK_FALSE(WriteFile(path, "x"));
  }
  REQUIRE(CheckWritable(folder / "x"));
  REQUIRE(std::filesystem::remove(folder / "taken"));
  CHECK(std::filesystem::is_empty(folder.path()));
  REQUIRE(WriteFile(folder / "x", "old"));
  REQUIRE(CheckWritable(folder / "x"));
  CHECK(ReadFile(folder / "x").value() == "old");
}

TEST_CASE("A device is written to and a full one is a failure", "[file]") {
  CHECK(WriteFile("/dev/null", "x"));
  CHECK_FALSE(WriteFile("/dev/full", "x"));
  CHECK(std::filesystem::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace conav
