#include "launcher/progress.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "unit/deploy/launcher/sample_episode.h"

using namespace conav;
using namespace conav::launcher;

namespace {

/// A FILE that can be read back.
struct Output {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* file = open_memstream(&text, &size);
  ~Output() {
    std::fclose(file);
    std::free(text);
  }
  std::string Read() {
    std::fflush(file);
    return {text, size};
  }
};

long Lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace

TEST_CASE("a robot's line tells cell, goals, moves, pictures and decisions",
          "[launcher][progress]") {
  const std::string line = ProgressLine(SampleEpisode().robots[0]);
  CHECK_THAT(line, Catch::Contains("r1  w1  cell (3,3)") && Catch::Contains("goals 1/1") &&
                       Catch::Contains("moves 2") && Catch::Contains("pictures 1"));
  CHECK_THAT(ProgressLine(MakeEpisode(1, 1).robots[0]), Catch::Contains("waiting"));
}

TEST_CASE("silent progress writes nothing", "[launcher][progress]") {
  Output output;
  const FakeClock clock;
  Progress progress(output.file, Progress::Style::kSilent, clock);
  progress.Say("started");
  progress.Show(SampleEpisode());
  progress.Finish(SampleEpisode());
  CHECK(output.Read().empty());
}

TEST_CASE("plain progress is written every few seconds and at each goal", "[launcher][progress]") {
  Output output;
  FakeClock clock;
  Progress progress(output.file, Progress::Style::kPlain, clock);
  Episode episode = MakeEpisode(1, 1);
  progress.Show(episode);
  progress.Show(episode);
  CHECK(Lines(output.Read()) == 1);
  episode = SampleEpisode();
  progress.Show(episode);
  progress.Show(episode);
  CHECK(Lines(output.Read()) == 2);
  clock.Advance(std::chrono::seconds(5));
  progress.Show(episode);
  CHECK(Lines(output.Read()) == 3);
}

TEST_CASE("a terminal's lines are written over the ones before", "[launcher][progress]") {
  Output output;
  FakeClock clock;
  Progress progress(output.file, Progress::Style::kTerminal, clock);
  const Episode episode = MakeEpisode(2, 1);
  progress.Show(episode);
  clock.Advance(std::chrono::seconds(1));
  progress.Show(episode);
  CHECK_THAT(output.Read(), Catch::Contains("\x1b[2A"));
  progress.Say("sim died");
  progress.Finish(episode);
  const std::string text = output.Read();
  CHECK(text.find("\x1b[2A", text.find("sim died")) == std::string::npos);
}
