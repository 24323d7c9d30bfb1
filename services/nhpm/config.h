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
  /// Which of kPerceptionModels is served.
  std::string model = kDefaultPerceptionModel;
  /// Weights file of the network; empty = the one that comes with conav. Looked at once a second: a
  /// new file is taken without dropping a request, a bad one is logged and the old model stays.
  std::string weights;
  /// Folder with <person>.nhpm for operators who have a model of their own; empty = none. Watched
  /// like `weights`; a request for somebody who is not in it gets the model above.
  std::string person_weights;
  GlpfParameters glpf;
  /// Threads that compute answers.
  int threads = 1;
  /// Requests that may wait or be computed at a time; one more is answered "busy".
  int max_open = 64;

  std::filesystem::path WeightsFile() const { return WeightsOrShipped(weights); }

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("name", name);
    reader.Choice("model", model, {kPerceptionModels.begin(), kPerceptionModels.end()});
    reader.Field("weights", weights);
    reader.Field("person_weights", person_weights);
    reader.Section("glpf", glpf);
    reader.Field("threads", threads, 1, 64);
    reader.Field("max_open", max_open, 1, 4096);
  }
};

}  // namespace conav::nhpm
