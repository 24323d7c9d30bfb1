#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace conav::test {

/// A bus_peer process; ready when the constructor returns, gone when the destructor does.
class PeerProcess {
 public:
  /// Throws std::runtime_error when it does not get ready.
  explicit PeerProcess(const std::vector<std::string>& arguments);
  ~PeerProcess();
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  void Signal(int signal) const;
  /// As a crash: no goodbye on the bus.
  void Kill();
  /// Asks it to end; returns its exit status.
  int Stop();

 private:
  int Reap();

  pid_t pid_ = -1;
  int input_ = -1;
};

}  // namespace conav::test
