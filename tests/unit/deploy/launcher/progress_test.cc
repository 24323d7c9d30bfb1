#include "launcher/progress.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "support/text.h"
#include "unit/deploy/launcher/sample_episode.h"

namespace conav::launcher {
namespace {

/// A FILE that can be read back.
struct Output {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* file = open_memstream(&text, &size);
  FakeClock clock;

  ~Output() {
    std::fclose(file);
    std::free(text);
  }
  std::string Read() {
    std::fflush(file);
    return {text, size};
  }
};

TEST_CASE("a robot's line has cell, goals, moves, pictures and decisions", "[launcher]") {
  const std::string line = ProgressLine(SampleEpisode().robots[0]);
  CHECK_THAT(line, Catch::Contains("r1  w1  cell (3,3)") && Catch::Contains("goals 1/1") &&
                       Catch::Contains("moves 2") && Catch::Contains("pictures 1"));
  CHECK_THAT(ProgressLine(MakeEpisode(1, 1).robots[0]), Catch::Contains("waiting"));
}

TEST_CASE("silent progress writes nothing", "[launcher]") {
  Output output;
  Progress progress(output.file, Progress::Style::kSilent, output.clock);
  progress.Say("started");
  progress.Show(SampleEpisode());
  progress.Finish(SampleEpisode());
  CHECK(output.Read().empty());
}

TEST_CASE("plain progress is written every few seconds and at each goal", "[launcher]") {
  Output output;
  Progress progress(output.file, Progress::Style::kPlain, output.clock);
  Episode episode = MakeEpisode(1, 1);
  progress.Show(episode);
  progress.Show(episode);
  CHECK(test::CountOf(output.Read(), "\n") == 1);
  episode = SampleEpisode();
  progress.Show(episode);
  progress.Show(episode);
  CHECK(test::CountOf(output.Read(), "\n") == 2);
  output.clock.Advance(std::chrono::seconds(5));
  progress.Show(episode);
  CHECK(test::CountOf(output.Read(), "\n") == 3);
}

TEST_CASE("a terminal's lines are written over the ones before", "[launcher]") {
  Output output;
  Progress progress(output.file, Progress::Style::kTerminal, output.clock);
  const Episode episode = MakeEpisode(2, 1);
  progress.Show(episode);
  output.clock.Advance(std::chrono::seconds(1));
  progress.Show(episode);
  CHECK_THAT(output.Read(), Catch::Contains("\x1b[2A"));
  progress.Say("sim died");
  progress.Finish(episode);
  const std::string text = output.Read();
  CHECK(text.find("\x1b[2A", text.find("sim died")) == std::string::npos);
}

TEST_CASE("the table tells what a robot did and whether all was reached, bytes are shortened",
          "[launcher]") {
  const std::string table = ResultTable(Measure(SampleEpisode()));
  CHECK_THAT(table, Catch::Contains("r1    w1         1/1       2      17         1    12.3 kB"));
  CHECK_THAT(table, Catch::Contains(": yes"));
  CHECK(ShortBytes(999) == "999 B");
  CHECK(ShortBytes(1000) == "1.0 kB");
  CHECK(ShortBytes(2500000) == "2.5 MB");
}

}  // namespace
}  // namespace conav::launcher
