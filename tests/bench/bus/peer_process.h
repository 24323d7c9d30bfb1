#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace conav::bench {

/// A child process whose standard input ends with this object; it is then waited for.
class PeerProcess {
 public:
  /// `program` is looked up in PATH. With `quiet` its output goes nowhere.
  PeerProcess(const std::string& program, const std::vector<std::string>& arguments, bool quiet);
  ~PeerProcess();
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  /// SIGTERM.
  void Terminate();

 private:
  pid_t pid_ = -1;
  int input_ = -1;
};

}  // namespace conav::bench
