#pragma once

#include <string>

#include "common/bus/participant.h"
#include "support/test_domain.h"

namespace conav::test {

/// A DDS vendor on this machine, in the domain of this test process.
inline bus::ParticipantOptions OnLoopback(const std::string& vendor) {
  bus::ParticipantOptions options;
  options.vendor = bus::ParseVendor(vendor).value();
  options.domain_id = TestDomain();
  options.interface = "lo";
  options.lease_s = 2.0;  // deaths are noticed soon
  return options;
}

}  // namespace conav::test
