#include "common/bus/fast/entities.h"
#include "common/bus/vendors.h"

namespace conav::bus {
namespace {

class FastBackend final : public Backend {
 public:
  FastBackend(const std::string& node_name, const ParticipantOptions& options)
      : participant_(options.domain_id,
                     FastParticipantQos(node_name, ResolveNetwork(options), options.lease_s)),
        lease_s_(options.lease_s),
        graph_(node_name, options.ros_distribution, participant_.guid()) {
    graph_.Start(std::make_unique<FastWriter>(Context(nullptr), graph_.endpoint()));
  }

  std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) override {
    return std::make_unique<FastWriter>(Context(&graph_), options);
  }
  std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) override {
    return std::make_unique<FastReader>(Context(&graph_), options, std::move(sink));
  }
  std::vector<Event> TakeEvents() override { return events_.Take(); }

 private:
  FastContext Context(RosGraph* graph) { return {participant_, lease_s_, events_, graph}; }

  FastParticipant participant_;
  double lease_s_;
  EventLog events_;
  RosGraph graph_;
};

}  // namespace

std::unique_ptr<Backend> MakeFastBackend(const std::string& node_name,
                                         const ParticipantOptions& options) {
  return std::make_unique<FastBackend>(node_name, options);
}

}  // namespace conav::bus
