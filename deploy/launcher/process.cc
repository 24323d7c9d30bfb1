#include "launcher/process.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <utility>

namespace conav::launcher {
namespace {

struct Descriptor {
  int value = -1;
  ~Descriptor() {
    if (value >= 0) close(value);
  }
};

// Only async-signal-safe calls: the parent may have threads. On failure errno goes down the pipe,
// which closes by itself when exec succeeds.
[[noreturn]] void RunChild(char* const* arguments, int log, int report, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  setpgid(0, 0);  // Ctrl-C only reaches the launcher, which then stops its children in order
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  std::signal(SIGPIPE, SIG_DFL);
  execvp(arguments[0], arguments);
  const int error = errno;
  [[maybe_unused]] const auto written = write(report, &error, sizeof error);
  _exit(127);
}

ProcessEnd EndFromStatus(int status) {
  ProcessEnd end;
  if (WIFSIGNALED(status)) {
    end.signal = WTERMSIG(status);
  } else {
    end.exit_code = WEXITSTATUS(status);
  }
  return end;
}

using std::chrono::steady_clock;

}  // namespace

std::string ProcessEnd::Describe() const {
  if (signal != 0) return fmt::format("signal {} ({})", signal, strsignal(signal));
  return fmt::format("exit code {}", exit_code);
}

Process::Process(std::string name, const std::vector<std::string>& arguments,
                 const std::filesystem::path& log)
    : name_(std::move(name)), log_(log) {
  const Descriptor output{open(log.c_str(), O_CREAT | O_APPEND | O_WRONLY | O_CLOEXEC, 0644)};
  if (output.value < 0) {
    throw StartupError(fmt::format("{}: cannot write: {}", log.string(), std::strerror(errno)));
  }
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw StartupError("cannot create a pipe for a new process");
  const Descriptor read_end{ends[0]};
  std::vector<char*> pointers;
  for (const std::string& argument : arguments) {
    pointers.push_back(const_cast<char*>(argument.c_str()));  // execvp does not write to them
  }
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) RunChild(pointers.data(), output.value, ends[1], parent);
  close(ends[1]);
  if (pid_ < 0) throw StartupError(fmt::format("{}: cannot start a process", name_));
  int error = 0;
  if (read(read_end.value, &error, sizeof error) == sizeof error) {
    waitpid(pid_, nullptr, 0);
    end_ = ProcessEnd{127, 0};
    throw StartupError(
        fmt::format("{}: cannot run {}: {}", name_, arguments[0], std::strerror(error)));
  }
}

Process::~Process() {
  if (Poll()) return;
  Signal(SIGKILL);
  waitpid(pid_, nullptr, 0);
}

bool Process::Poll() {
  if (end_) return true;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) == pid_) end_ = EndFromStatus(status);
  return end_.has_value();
}

void Process::Signal(int signal) {
  // The pid is ours until waitpid() has returned it, so it cannot belong to another process.
  // Signalling the group includes the child of a --run-with wrapper; the group is gone if its
  // leader left it.
  if (end_) return;
  if (kill(-pid_, signal) != 0) kill(pid_, signal);
}

std::vector<std::string> LastLines(const std::filesystem::path& file, std::size_t count) {
  std::ifstream stream(file);
  std::deque<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
    if (lines.size() > count) lines.pop_front();
  }
  return {lines.begin(), lines.end()};
}

Result<Clock::TimePoint> RestartPolicy::Ended(const ProcessEnd& end, Clock::TimePoint started,
                                              Clock::TimePoint now) {
  if (end.exit_code != 0 && now - started < kStart) {
    return Fail(ErrorCode::kRefused, "it did not start");
  }
  std::erase_if(ends_, [&](Clock::TimePoint earlier) { return now - earlier > kWindow; });
  ends_.push_back(now);
  if (ends_.size() >= kMostEnds) {
    return Fail(ErrorCode::kRefused,
                fmt::format("{} times in {} s", ends_.size(), kWindow.count()));
  }
  return now + kFirstDelay * (1 << (ends_.size() - 1));
}

ProcessGroup::~ProcessGroup() { StopAll(std::chrono::seconds(2)); }

Process& ProcessGroup::Start(std::string name, const std::vector<std::string>& arguments,
                             const std::filesystem::path& log) {
  processes_.push_back(std::make_unique<Process>(std::move(name), arguments, log));
  return *processes_.back();
}

std::vector<const Process*> ProcessGroup::TakeEnded() {
  std::vector<const Process*> ended;
  for (const auto& process : processes_) {
    if (!process->Poll()) continue;
    if (std::find(reported_.begin(), reported_.end(), process.get()) != reported_.end()) continue;
    reported_.push_back(process.get());
    ended.push_back(process.get());
  }
  return ended;
}

std::vector<const Process*> ProcessGroup::running() const {
  std::vector<const Process*> running;
  for (const auto& process : processes_) {
    if (process->running()) running.push_back(process.get());
  }
  return running;
}

std::vector<std::string> ProcessGroup::StopAll(std::chrono::milliseconds grace) {
  return Stop(grace, [](const Process&) { return true; });
}

std::vector<std::string> ProcessGroup::Stop(std::chrono::milliseconds grace,
                                            const std::function<bool(const Process&)>& meant) {
  std::vector<Process*> running;
  for (const auto& process : processes_) {
    if (meant(*process)) running.push_back(process.get());
  }
  const auto forget_ended = [&] {
    std::erase_if(running, [](Process* process) { return process->Poll(); });
    return running.empty();
  };
  for (Process* process : running) process->Signal(SIGTERM);
  const auto deadline = steady_clock::now() + grace;
  while (!forget_ended() && steady_clock::now() < deadline) poll(nullptr, 0, 10);
  std::vector<std::string> killed;
  for (Process* process : running) {
    process->Signal(SIGKILL);
    killed.push_back(process->name());
  }
  while (!forget_ended()) poll(nullptr, 0, 5);
  return killed;
}

}  // namespace conav::launcher
