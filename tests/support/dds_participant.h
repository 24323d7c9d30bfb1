#pragma once

#include <memory>
#include <string>

#include "support/nhpm_on_thread.h"
#include "support/test_domain.h"

namespace conav::test {

/// Participants of a DDS vendor on this machine, in the domain of this test process.
inline MakeParticipant OverDds(const std::string& vendor) {
  return [vendor](const std::string& node) {
    bus::ParticipantOptions options;
    options.vendor = vendor;
    options.domain_id = TestDomain();
    options.interface = "lo";
    options.lease_s = 2.0;  // deaths are noticed soon
    return std::make_unique<bus::Participant>(node, options);
  };
}

}  // namespace conav::test
