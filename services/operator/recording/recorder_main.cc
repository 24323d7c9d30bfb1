#include "common/service/service_main.h"
#include "operator/recording/recorder_service.h"

/// conav-recorder: keeps what was said on the bus.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::recorder::RecorderConfig, conav::recorder::RecorderService>(
      "recorder",
      "Records the topics of robots, worlds and system into an MCAP file, which Foxglove and "
      "conav bag read.",
      argc, argv);
}
