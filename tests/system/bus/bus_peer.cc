// The other process of the bus tests: bus_peer <vendor> <domain> [none|humble|jazzy|<peer address>]
// Echoes what arrives, offers histories and payloads that are no messages, and stays until killed
// or until its standard input ends.
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <optional>

#include "common/bus/cyclone/backend.h"
#include "common/bus/events.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "system/bus/peer_topics.h"

namespace conav::test {
namespace {

bus::ParticipantOptions Options(int argc, char** argv) {
  bus::ParticipantOptions options;
  options.vendor = bus::ParseVendor(argv[1]).value();
  options.domain_id = std::atoi(argv[2]);
  options.lease_s = 2.0;
  options.interface = "lo";
  const std::string extra = argc > 3 ? argv[3] : "jazzy";
  options.ros_distribution = FindNamed(bus::kRosDistributions, extra);
  if (!options.ros_distribution) {
    options.interface.clear();
    options.peers = {extra};
  }
  return options;
}

template <class T>
void Publish(bus::Publisher<T>& publisher, const T& message) {
  const Result<void> result = publisher.Publish(message);
  if (!result) std::cerr << "bus_peer: " << result.error().text << "\n";
}

/// Sends everything back from the receive thread.
template <class T>
class Echo {
 public:
  Echo(bus::Participant& participant, const bus::Topic<T>& ping, const bus::Topic<T>& pong)
      : publisher_(participant, pong),
        subscriber_(participant, ping, {}, [this](T&& message) { Publish(publisher_, message); }) {}

 private:
  bus::Publisher<T> publisher_;
  bus::Subscriber<T> subscriber_;
};

class FloodCounter {
 public:
  explicit FloodCounter(bus::Participant& participant)
      : report_(participant, kFloodReport),
        flood_(participant, kFlood, {}, [this](Blob&& blob) { Count(blob); }) {}

 private:
  void Count(const Blob& blob) {
    if (blob.data().empty()) {
      Publish(report_, MakeBlob(in_order_, 1));
    } else if (blob.id() == in_order_ + 1) {
      ++in_order_;
    }
  }

  std::uint64_t in_order_ = 0;
  bus::Publisher<Blob> report_;
  bus::Subscriber<Blob> flood_;
};

/// A writer whose liveliness lease is shorter than its participant's, as a foreign program may have
/// it.
class ShortLeaseWriter {
 public:
  explicit ShortLeaseWriter(int domain_id)
      : participant_(
            dds_create_participant(static_cast<dds_domainid_t>(domain_id), nullptr, nullptr),
            "a participant"),
        writer_({participant_.handle(), bus::kDefaultSystem, true, 0.5, events_, nullptr},
                {std::string(kShortLease.pattern), bus::TypeSupportOf<Blob>(), kShortLease.qos}) {}

 private:
  bus::EventLog events_;
  bus::CycloneEntity participant_;
  bus::CycloneWriter writer_;
};

void PublishGarbage(bus::Publisher<RawBlob>& garbage, bus::Publisher<Blob>& good) {
  Publish(garbage, {{0, 1, 0, 0, 1, 2, 3}});
  Publish(garbage, {{0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 1, 2, 3, 4}});
  Publish(garbage, {{9, 9, 9, 9, 9, 9, 9, 9}});
  Publish(good, MakeBlob(1, 10));
}

void Run(const bus::ParticipantOptions& options) {
  bus::Participant participant("bus_peer", options);
  bus::Participant raw_participant("bus_peer_raw", options);
  Echo<Blob> echo(participant, kPing, kPong);
  Echo<KeyedBlob> keyed_echo(participant, kKeyedPing, kKeyedPong);
  FloodCounter flood(participant);
  bus::Publisher<Blob> history(participant, kHistory);
  for (std::uint64_t id = 1; id <= kHistoryPublished; ++id) Publish(history, MakeBlob(id, 1000));
  bus::Publisher<RawBlob> garbage(raw_participant, kGarbage);
  bus::Publisher<Blob> good(participant, kAfterGarbage);
  PublishGarbage(garbage, good);
  bus::Publisher<Blob> offer(participant, kBestEffortOffer);
  bus::Subscriber<Blob> request(participant, kReliableRequest);
  std::optional<ShortLeaseWriter> short_lease;
  if (options.vendor == bus::Vendor::kCycloneDds) short_lease.emplace(options.domain_id);
  std::cout << "ready" << std::endl;
  char byte = 0;
  while (read(STDIN_FILENO, &byte, 1) > 0) {
  }
}

}  // namespace
}  // namespace conav::test

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: bus_peer <vendor> <domain> [jazzy|humble|<peer address>]\n";
    return 2;
  }
  try {
    conav::test::Run(conav::test::Options(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "bus_peer: " << error.what() << "\n";
    return 1;
  }
}
