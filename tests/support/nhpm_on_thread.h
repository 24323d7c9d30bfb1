#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "common/bus/in_memory_bus.h"
#include "nhpm/nhpm_service.h"

namespace conav::test {

/// How a test makes participants: all of one kind on one bus.
using MakeParticipant = std::function<std::unique_ptr<bus::Participant>(const std::string& node)>;

inline MakeParticipant InMemory() {
  return [bus = std::make_shared<bus::InMemoryBus>()](const std::string& node) {
    return std::make_unique<bus::Participant>(node, bus);
  };
}

/// The config of a service that serves the GLPF.
inline nhpm::NhpmConfig ServedGlpf(const std::string& name = "nhpm") {
  nhpm::NhpmConfig config;
  config.name = name;
  config.model = PerceptionModelKind::kGlpf;
  return config;
}

/// The real nhpm service, running on a thread from construction to destruction.
class NhpmOnThread {
 public:
  explicit NhpmOnThread(const MakeParticipant& make, const nhpm::NhpmConfig& config = ServedGlpf())
      : participant_(make(config.name)),
        service_(*participant_, config, clock_),
        thread_([this] { service_.Run(stop_); }) {}
  ~NhpmOnThread() {
    stop_.RequestStop();
    participant_->Wake();
    thread_.join();
  }
  NhpmOnThread(const NhpmOnThread&) = delete;
  NhpmOnThread& operator=(const NhpmOnThread&) = delete;

 private:
  SteadyClock clock_;
  StopToken stop_;
  std::unique_ptr<bus::Participant> participant_;
  nhpm::NhpmService service_;
  std::thread thread_;
};

}  // namespace conav::test
