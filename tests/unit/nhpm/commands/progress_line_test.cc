#include "nhpm/commands/progress_line.h"

#include <catch2/catch.hpp>
#include <memory>

namespace conav::nhpm {
namespace {

TEST_CASE("Progress that goes into a file is a line for each call", "[nhpm][train]") {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  {
    ProgressLine progress(file.get());
    progress.Show("one");
    progress.Show("two");
  }
  std::rewind(file.get());
  std::string text(100, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  CHECK(text == "one\ntwo\n");
}

TEST_CASE("Durations are written as on a clock", "[nhpm][train]") {
  CHECK(DurationText(0.0) == "0:00");
  CHECK(DurationText(7.4) == "0:07");
  CHECK(DurationText(59.6) == "1:00");
  CHECK(DurationText(754.0) == "12:34");
  CHECK(DurationText(3723.0) == "1:02:03");
}

}  // namespace
}  // namespace conav::nhpm
