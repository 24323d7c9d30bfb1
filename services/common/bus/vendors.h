#pragma once

#include <memory>
#include <string>

#include "common/bus/backend.h"
#include "common/bus/participant.h"

namespace conav::bus {

inline constexpr const char* kCycloneDds = "cyclonedds";
inline constexpr const char* kFastDds = "fastdds";
/// The vendor that measures better (conav-bench-bus).
inline constexpr const char* kDefaultVendor = kCycloneDds;

/// Fills what was left open from the environment (CONAV_DDS, CONAV_DOMAIN then ROS_DOMAIN_ID,
/// CONAV_INTERFACE) and the defaults. Throws StartupError for values that are not allowed.
ParticipantOptions Resolve(ParticipantOptions options);

/// `options` are resolved. Throw StartupError when the participant cannot be made.
std::unique_ptr<Backend> MakeCycloneBackend(const std::string& node_name,
                                            const ParticipantOptions& options);
std::unique_ptr<Backend> MakeFastBackend(const std::string& node_name,
                                         const ParticipantOptions& options);

}  // namespace conav::bus
