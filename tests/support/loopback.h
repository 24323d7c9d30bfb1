#pragma once

#include <string>

#include "common/bus/participant.h"
#include "support/test_domain.h"

namespace conav::test {

/// A DDS vendor on this machine alone, in that domain.
inline bus::ParticipantOptions OnLoopback(const std::string& vendor, int domain_id) {
  bus::ParticipantOptions options;
  options.vendor = bus::ParseVendor(vendor);
  options.domain_id = domain_id;
  options.interface = "lo";
  return options;
}

/// The same in the domain of this test process; deaths are noticed soon.
inline bus::ParticipantOptions OnLoopback(const std::string& vendor) {
  bus::ParticipantOptions options = OnLoopback(vendor, TestDomain());
  options.lease_s = 2.0;
  return options;
}

}  // namespace conav::test
