#include "common/bus/participant.h"

#include "common/bus/backend.h"
#include "common/bus/in_memory_bus.h"
#include "common/bus/notifier.h"
#include "common/bus/vendors.h"
#include "common/runtime/log.h"

namespace conav::bus {

Participant::Participant(const std::string& node_name, const ParticipantOptions& options)
    : node_name_(node_name), notifier_(std::make_unique<Notifier>()) {
  const ParticipantOptions resolved = Resolve(options);
  vendor_ = resolved.vendor;
  backend_ = vendor_ == kFastDds ? MakeFastBackend(node_name, resolved)
                                 : MakeCycloneBackend(node_name, resolved);
  LOG_INFO("on the bus", "node", node_name, "dds", vendor_, "domain", resolved.domain_id,
           "interface", resolved.interface.empty() ? "default" : resolved.interface);
}

Participant::Participant(const std::string& node_name, std::shared_ptr<InMemoryBus> bus)
    : node_name_(node_name),
      vendor_("in-memory"),
      notifier_(std::make_unique<Notifier>()),
      backend_(MakeInMemoryBackend(std::move(bus))) {}

Participant::~Participant() = default;

bool Participant::Wait(std::chrono::nanoseconds timeout) { return notifier_->Wait(timeout); }

void Participant::Wake() { notifier_->Notify(); }

std::vector<Event> Participant::TakeEvents() { return backend_->TakeEvents(); }

}  // namespace conav::bus
