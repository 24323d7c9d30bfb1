#pragma once

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "common/bus/participant.h"
#include "common/runtime/config.h"
#include "common/service/parameters.h"

namespace conav {

/// What ROS 2 tools ask of any node: its parameters (`ros2 param`), with /parameter_events, and whether
/// it is ready (`ros2 lifecycle get`: "inactive" until it runs, then "active"). Answers on a thread of
/// its own, so that a service that starts or computes for long answers too.
///
/// Tools find a node by its name in the ROS graph, so this is only for processes that publish one.
class NodeServices {
 public:
  NodeServices(bus::Participant& participant, std::vector<ConfigParameter> parameters);
  ~NodeServices();
  NodeServices(const NodeServices&) = delete;
  NodeServices& operator=(const NodeServices&) = delete;

  /// While it lives, the service runs. `apply` (may be null) sets its live parameters, called on the
  /// thread of the NodeServices, which live longer.
  class Running {
   public:
    Running(NodeServices& services, Parameters::Apply apply);
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

   private:
    NodeServices& services_;
  };

 private:
  class Servers;

  void Run();

  std::unique_ptr<Servers> servers_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace conav
