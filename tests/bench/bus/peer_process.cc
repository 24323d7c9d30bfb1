#include "bench/bus/peer_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace conav::bench {

PeerProcess::PeerProcess(const std::string& program, const std::vector<std::string>& arguments,
                         bool quiet) {
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  int input[2];
  if (pipe2(input, O_CLOEXEC) != 0) throw std::runtime_error("no pipe for a peer process");
  pid_ = fork();
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(input[0], STDIN_FILENO);
    if (quiet) dup2(open("/dev/null", O_WRONLY), STDOUT_FILENO);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  close(input[0]);
  input_ = input[1];
}

PeerProcess::~PeerProcess() {
  close(input_);
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
}

void PeerProcess::Terminate() {
  if (pid_ > 0) kill(pid_, SIGTERM);
}

}  // namespace conav::bench
