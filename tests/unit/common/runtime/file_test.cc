#include "common/runtime/file.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <string>

namespace conav {
namespace {

class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("conav-file-test-" + Pid())) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const char* name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  static std::string Pid() { return std::to_string(::getpid()); }
  std::filesystem::path path_;
};

TEST_CASE("A file is read as it was written, zero bytes included", "[runtime][file]") {
  const Folder folder;
  const std::string bytes("a\0\r\n\xff", 5);
  REQUIRE(WriteFile(folder / "x", "old"));
  REQUIRE(WriteFile(folder / "x", bytes));
  CHECK(ReadFile(folder / "x").value() == bytes);
  CHECK_FALSE(std::filesystem::exists(folder / "x.partial"));
}

TEST_CASE("An empty file is read as no bytes", "[runtime][file]") {
  const Folder folder;
  REQUIRE(WriteFile(folder / "x", ""));
  CHECK(ReadFile(folder / "x").value().empty());
}

TEST_CASE("A missing file and a folder are told apart", "[runtime][file]") {
  const Folder folder;
  const auto missing = ReadFile(folder / "x");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::kNotFound);
  CHECK(missing.error().text == (folder / "x").string() + ": no such file");
  const auto read = ReadFile(folder.path());
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::kIo);
}

TEST_CASE("What cannot be written is known before and after", "[runtime][file]") {
  const Folder folder;
  for (const std::filesystem::path& path :
       {std::filesystem::path("/nonexistent/folder/x"), folder.path()}) {
    const auto check = CheckWritable(path);
    REQUIRE_FALSE(check);
    CHECK(check.error().code == ErrorCode::kIo);
    CHECK_FALSE(WriteFile(path, "x"));
  }
}

TEST_CASE("The check leaves no trace and keeps what is there", "[runtime][file]") {
  const Folder folder;
  REQUIRE(CheckWritable(folder / "x"));
  CHECK(std::filesystem::is_empty(folder.path()));
  REQUIRE(WriteFile(folder / "x", "old"));
  REQUIRE(CheckWritable(folder / "x"));
  CHECK(ReadFile(folder / "x").value() == "old");
}

TEST_CASE("A device is written to and a full one is a failure", "[runtime][file]") {
  CHECK(WriteFile("/dev/null", "x"));
  CHECK_FALSE(WriteFile("/dev/full", "x"));
  CHECK(std::filesystem::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace conav
