#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>

#include "common/bus/network.h"

namespace conav::bus {

/// Configuration of a Cyclone DDS domain: network, discovery, lease and what interoperation with
/// Fast DDS needs. Ignores the environment variable CYCLONEDDS_URI.
std::string CycloneConfiguration(const Network& network, double lease_s);

/// A Cyclone DDS domain. There is one per process and domain number, shared by its participants.
class CycloneDomain {
 public:
  /// Opens the domain or returns the open one. Throws StartupError when Cyclone rejects the
  /// configuration, or when the domain is open with a different one.
  static std::shared_ptr<CycloneDomain> Open(int domain_id, const std::string& configuration);

  CycloneDomain(int domain_id, std::string configuration);
  ~CycloneDomain();
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

 private:
  std::string configuration_;
  dds_entity_t domain_;
};

}  // namespace conav::bus
