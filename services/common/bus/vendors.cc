#include "common/bus/vendors.h"

namespace conav::bus {

std::unique_ptr<Backend> MakeCycloneBackend(const std::string&, const ParticipantOptions&) {
  throw StartupError("Cyclone DDS is not built in yet");
}
std::unique_ptr<Backend> MakeFastBackend(const std::string&, const ParticipantOptions&) {
  throw StartupError("Fast DDS is not built in yet");
}

}  // namespace conav::bus
