#pragma once

#include <memory>
#include <string>

#include "support/loopback.h"
#include "support/nhpm_on_thread.h"

namespace conav::test {

/// Participants of a DDS vendor on this machine, in the domain of this test process.
inline MakeParticipant OverDds(const std::string& vendor) {
  return [vendor](const std::string& node) {
    return std::make_unique<bus::Participant>(node, OnLoopback(vendor));
  };
}

}  // namespace conav::test
