#include "system/bus/peer_process.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace conav::test {
namespace {

[[noreturn]] void Execute(int input, int output, const std::vector<std::string>& arguments) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  std::string program = CONAV_BIN_DIR "/bus_peer";
  std::vector<char*> argv = {program.data()};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.data()));
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  _exit(127);
}

}  // namespace

PeerProcess::PeerProcess(const std::vector<std::string>& arguments) {
  int input[2];
  int output[2];
  if (pipe(input) != 0 || pipe(output) != 0) throw std::runtime_error("no pipe");
  pid_ = fork();
  if (pid_ == 0) {
    close(input[1]);
    close(output[0]);
    Execute(input[0], output[1], arguments);
  }
  close(input[0]);
  close(output[1]);
  input_ = input[1];
  char text[6] = {};
  const ssize_t count = read(output[0], text, sizeof text);
  close(output[0]);
  if (count <= 0) {
    Kill();
    throw std::runtime_error("bus_peer did not get ready");
  }
}

PeerProcess::~PeerProcess() { Kill(); }

void PeerProcess::Signal(int signal) const { kill(pid_, signal); }

void PeerProcess::Kill() {
  if (pid_ > 0) kill(pid_, SIGKILL);
  Reap();
}

int PeerProcess::Stop() {
  close(input_);
  input_ = -1;
  return Reap();
}

int PeerProcess::Reap() {
  if (input_ >= 0) close(input_);
  input_ = -1;
  if (pid_ <= 0) return -1;
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace conav::test
