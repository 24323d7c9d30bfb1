#include "bench/bus/stack.h"

#include "common/bus/backend.h"

namespace conav::bench {

bus::ParticipantOptions BusOptions(const StackOptions& options) {
  bus::ParticipantOptions result;
  result.vendor = options.vendor;
  result.domain_id = options.domain_id;
  result.interface = "lo";
  return result;
}

std::unique_ptr<Pinger> MakePinger(const StackOptions& options, Pinger::OnPong on_pong) {
  if (!options.raw) return MakeBusPinger(options, std::move(on_pong));
  return options.vendor == bus::kFastDds ? MakeRawFastPinger(options, std::move(on_pong))
                                         : MakeRawCyclonePinger(options, std::move(on_pong));
}

std::unique_ptr<Echo> MakeEcho(const StackOptions& options) {
  if (!options.raw) return MakeBusEcho(options);
  return options.vendor == bus::kFastDds ? MakeRawFastEcho(options) : MakeRawCycloneEcho(options);
}

}  // namespace conav::bench
