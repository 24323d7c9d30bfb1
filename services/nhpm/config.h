#pragma once

#include <filesystem>
#include <string>

#include "common/bus/participant.h"
#include "common/runtime/config.h"
#include "nhpm/model/glpf.h"
#include "nhpm/model/load_model.h"

namespace conav::nhpm {

/// Section `nhpm:` of a config file.
struct NhpmConfig {
  bus::ParticipantOptions bus;
  /// Node name; give each replica its own.
  std::string name = "nhpm";
  /// The served model.
  PerceptionModelKind model = PerceptionModelKind::kNhpm;
  /// Weights file of the network; empty = the one that comes with conav. Checked once a second: the
  /// service switches to a new file without dropping a request; it logs a bad file and keeps the
  /// old model.
  std::string weights;
  /// Folder with <person>.nhpm for operators with a model of their own; empty = none. Checked like
  /// `weights`; a request for a person without a file gets the model above.
  std::string person_weights;
  GlpfParameters glpf;
  /// Threads that compute answers.
  int threads = 1;
  /// Limit on waiting and computing requests together; further ones get the answer "busy".
  int max_open = 64;

  std::filesystem::path WeightsFile() const { return WeightsOrShipped(weights, model); }

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("name", name);
    reader.Choice("model", model, kPerceptionModels);
    reader.Field("weights", weights);
    reader.Field("person_weights", person_weights);
    reader.Section("glpf", glpf);
    reader.Field("threads", threads, 1, 64);
    reader.Field("max_open", max_open, 1, 4096);
  }
};

}  // namespace conav::nhpm
