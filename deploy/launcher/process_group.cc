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

bool ProcessGroup::AllEnded() {
  bool all = true;
  for (const auto& process : processes_) all = process->Poll() && all;
  return all;
}

std::vector<std::string> ProcessGroup::StopAll(std::chrono::milliseconds grace) {
  for (const auto& process : processes_) process->Signal(SIGTERM);
  const auto deadline = steady_clock::now() + grace;
  while (!AllEnded() && steady_clock::now() < deadline) poll(nullptr, 0, 10);
  std::vector<std::string> killed;
  for (const auto& process : processes_) {
    if (process->Poll()) continue;
    process->Signal(SIGKILL);
    killed.push_back(process->name());
  }
  while (!AllEnded()) poll(nullptr, 0, 5);
  return killed;
}

}  // namespace conav::launcher
