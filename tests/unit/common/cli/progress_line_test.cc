#include "common/cli/progress_line.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <memory>

namespace conav {
namespace {

TEST_CASE(
    "Progress that goes into a file is a line for each call, at most one a second now and then",
    "[train]") {
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
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> other(std::tmpfile(), &std::fclose);
  ProgressLine progress(other.get());
  progress.ShowNowAndThen("one");
  progress.ShowNowAndThen("two");
  CHECK(std::ftell(other.get()) == 0);
}

TEST_CASE("Progress on a terminal is one line that is rewritten and ended", "[train]") {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(terminal >= 0);
  REQUIRE((grantpt(terminal) == 0 && unlockpt(terminal) == 0));
  std::FILE* const line = std::fopen(ptsname(terminal), "w");
  REQUIRE(line != nullptr);
  {
    ProgressLine progress(line);
    progress.Show("one");
    progress.Show("two");
  }
  std::fflush(line);
  // A terminal hands over what was written in as many pieces as it likes.
  std::string text;
  pollfd readable{terminal, POLLIN, 0};
  while (!text.ends_with('\n') && poll(&readable, 1, 10'000) == 1) {
    std::array<char, 100> piece;
    const auto size = read(terminal, piece.data(), piece.size());
    if (size <= 0) break;
    text.append(piece.data(), static_cast<std::size_t>(size));
  }
  std::fclose(line);
  close(terminal);
  CHECK(text == "\rone\x1b[K\rtwo\x1b[K\r\n");
}

TEST_CASE("Durations are written as on a clock", "[train]") {
  CHECK(DurationText(0.0) == "0:00");
  CHECK(DurationText(7.4) == "0:07");
  CHECK(DurationText(59.6) == "1:00");
  CHECK(DurationText(754.0) == "12:34");
  CHECK(DurationText(3723.0) == "1:02:03");
}

}  // namespace
}  // namespace conav
