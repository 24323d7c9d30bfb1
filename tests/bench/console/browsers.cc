#include "bench/console/browsers.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace conav::bench {
namespace {

struct Pipe {
  Pipe() {
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe for the browsers");
  }
  std::array<int, 2> ends{};
};

}  // namespace

Browsers::Browsers(const std::filesystem::path& folder) {
  const Pipe input;
  const Pipe output;
  const std::string profiles = folder.string();
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("no process for the browsers");
  if (pid_ == 0) {
    dup2(input.ends[0], STDIN_FILENO);
    dup2(output.ends[1], STDOUT_FILENO);
    execlp(CONAV_NODE, CONAV_NODE, CONAV_BENCH_PAGES, profiles.c_str(), nullptr);
    _exit(127);
  }
  close(input.ends[0]);
  close(output.ends[1]);
  commands_.reset(fdopen(input.ends[1], "w"));
  answers_.reset(fdopen(output.ends[0], "r"));
  signal(SIGPIPE, SIG_IGN);  // that it has ended is told by its missing answer
}

Browsers::~Browsers() {
  commands_.reset();  // the end of its input ends it, and the browsers
  waitpid(pid_, nullptr, 0);
}

nlohmann::json Browsers::Ask(const nlohmann::json& command) {
  const std::string line = command.dump() + "\n";
  std::fwrite(line.data(), 1, line.size(), commands_.get());
  std::fflush(commands_.get());
  char* text = nullptr;
  std::size_t room = 0;
  const auto length = getline(&text, &room, answers_.get());
  const std::unique_ptr<char, decltype(&std::free)> owned(text, &std::free);
  if (length < 0) throw std::runtime_error("the browsers' program has ended: " CONAV_BENCH_PAGES);
  auto answer = nlohmann::json::parse(text);
  if (answer.contains("error")) {
    throw std::runtime_error("browsers: " + answer["error"].get<std::string>());
  }
  return answer;
}

void Browsers::Open(const std::string& url, int pages, const Drive& drive) {
  Ask({{"do", "open"},
       {"url", url},
       {"pages", pages},
       {"drive",
        {{"begin", drive.begin_s},
         {"west", drive.WestM()},
         {"speed", Drive::kSpeedMps},
         {"period", drive.PeriodS()},
         {"cellSize", Drive::kCellSizeM},
         {"rows", drive.side},
         {"columns", drive.side}}}});
}

void Browsers::Begin() { Ask({{"do", "begin"}}); }

Browsers::Measured Browsers::End() {
  const nlohmann::json answer = Ask({{"do", "end"}});
  Measured measured;
  measured.cpu_s = answer["cpu"];
  for (const auto& page : answer["pages"]) {
    const double seconds = page["seconds"];
    PageAges ages{page["shown"], page["drawn"], page["any"], page["frames"].get<double>() / seconds,
                  0.0};
    const int robots = page["robots"];
    if (robots > 0) ages.states_per_s = static_cast<double>(ages.shown.size()) / robots / seconds;
    measured.pages.push_back(std::move(ages));
  }
  return measured;
}

void Browsers::Stop() { Signal("SIGSTOP"); }
void Browsers::Continue() { Signal("SIGCONT"); }

void Browsers::Signal(const char* name) { Ask({{"do", "signal"}, {"name", name}}); }

}  // namespace conav::bench
