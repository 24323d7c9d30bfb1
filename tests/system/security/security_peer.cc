// security_peer NAME VENDOR DOMAIN KEYSTORE|- ENCLAVE ROBOT: reads and writes the commands to that robot, under
// that name. A process of its own, since Cyclone DDS has one identity a process. Prints "ready", or "refused" where
// it may not write, and obeys the lines "write COUNT" and "read", which prints how many genuine commands came.

#include <iostream>
#include <optional>
#include <sstream>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/result.h"
#include "support/loopback.h"

namespace conav::test {
namespace {

using conav_msgs::msg::RobotCommand;

bus::ParticipantOptions Options(char** argv) {
  bus::ParticipantOptions options = OnLoopback(argv[2], std::atoi(argv[3]));
  options.lease_s = 2.0;
  if (const std::string keystore = argv[4]; keystore != "-") options.keystore = keystore;
  options.enclave = argv[5];
  return options;
}

struct Peer {
  explicit Peer(char** argv) {
    Try([&] { participant.emplace("security_peer", Options(argv)); });
    if (!participant) return;
    Try([&] { reader.emplace(*participant, bus::kRobotCommand, argv[6]); });
    Try([&] { writer.emplace(*participant, bus::kRobotCommand, argv[6]); });
  }

  template <class Make>
  static void Try(Make make) try {
    make();
  } catch (const StartupError& error) {
    std::cerr << error.what() << "\n";
  }

  std::optional<bus::Participant> participant;
  std::optional<bus::Subscriber<RobotCommand>> reader;
  std::optional<bus::Publisher<RobotCommand>> writer;
};

}  // namespace
}  // namespace conav::test

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  conav::test::Peer peer(argv);
  std::cout << (peer.writer ? "ready" : "refused") << std::endl;
  conav::test::RobotCommand command;
  command.robot(argv[1]);
  command.sequence_number(1);
  int read = 0;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string verb;
    int count = 0;
    words >> verb >> count;
    for (int i = 0; i < count && peer.writer; ++i) {
      static_cast<void>(peer.writer->Publish(command));
    }
    if (verb != "read") continue;
    if (peer.reader) {
      for (const auto& taken : peer.reader->Take()) read += taken.robot().starts_with("genuine");
    }
    std::cout << "read " << read << std::endl;
  }
}
