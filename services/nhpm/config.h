#pragma once

#include <string>

#include "common/bus/participant.h"
#include "common/runtime/config.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// Section `nhpm:` of a config file.
struct NhpmConfig {
  bus::ParticipantOptions bus;
  /// Node name; give each replica its own.
  std::string name = "nhpm";
  /// Which model is served.
  std::string model = "glpf";
  GlpfParameters glpf;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("name", name);
    reader.Choice("model", model, {"glpf"});
    reader.Section("glpf", glpf);
  }
};

}  // namespace conav::nhpm
