#include "launcher/process_group.h"

#include <poll.h>

#include <algorithm>
#include <csignal>
#include <utility>

namespace conav::launcher {
namespace {

using std::chrono::steady_clock;

}  // namespace

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

int ProcessGroup::CountRunning(const std::function<bool(const Process&)>& meant) const {
  return static_cast<int>(
      std::count_if(processes_.begin(), processes_.end(),
                    [&](const auto& process) { return process->running() && meant(*process); }));
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
