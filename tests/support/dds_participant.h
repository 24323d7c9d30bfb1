#pragma once

#include <unistd.h>

#include <memory>
#include <string>

#include "support/nhpm_on_thread.h"

namespace conav::test {

/// Participants of a DDS vendor on this machine, in a domain that other test processes hardly use.
inline MakeParticipant OverDds(const std::string& vendor) {
  return [vendor](const std::string& node) {
    bus::ParticipantOptions options;
    options.vendor = vendor;
    options.domain_id = 20 + static_cast<int>(getpid()) % 200;
    options.interface = "lo";
    return std::make_unique<bus::Participant>(node, options);
  };
}

}  // namespace conav::test
