#include "common/runtime/stop_token.h"

#include <csignal>

namespace conav {
namespace {

// A signal handler can reach only what is global.
StopToken process_stop_token;

void HandleSignal(int) { process_stop_token.RequestStop(); }

}  // namespace

StopToken& ProcessStopToken() { return process_stop_token; }

void InstallStopSignals() {
  std::signal(SIGINT, HandleSignal);
  std::signal(SIGTERM, HandleSignal);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace conav
