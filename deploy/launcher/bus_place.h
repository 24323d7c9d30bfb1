#pragma once

#include <memory>
#include <string>

#include "common/bus/participant.h"
#include "launcher/demo_options.h"
#include "launcher/domain_lease.h"
#include "launcher/episode.h"
#include "launcher/recorder.h"

namespace conav::launcher {

/// The launcher's own place on the bus, in a domain where no other conav publishes its robots.
struct BusPlace {
  DomainLease lease;
  std::unique_ptr<bus::Participant> participant;
  std::unique_ptr<Recorder> recorder;
};

/// The arguments do not fit what is there; main prints it and exits with 2.
class UsageError : public StartupError {
  using StartupError::StartupError;
};

/// How a process of this demo takes part in DDS: with what the environment says where `vendor` or
/// the interface is empty, so that a written configuration means the same everywhere. Throws
/// StartupError when the environment names no DDS vendor.
bus::ParticipantOptions BusOptions(const DemoOptions& options, int domain,
                                   const std::string& vendor);

/// Takes the domain of the options or of the environment (CONAV_DOMAIN); without these the first
/// free one. Listens for a moment for robots of the same name before it is content with a domain.
/// Throws UsageError when the wanted domain is taken (by which robot), StartupError from the bus.
BusPlace JoinFreeDomain(const DemoOptions& options, Episode& episode);

/// The same in a domain that is ours already; nobody is listened for. Throws StartupError from the
/// bus.
BusPlace JoinKeptDomain(const DemoOptions& options, DomainLease lease, Episode& episode);

}  // namespace conav::launcher
