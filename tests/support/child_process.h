#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

namespace conav::test {

/// A command of the shell as a process of its own, with its standard input and output as pipes to
/// us. Killed with this object, and when we are killed.
class ChildProcess {
 public:
  /// `pipe_bytes`: of what it printed and nobody read, at most; 0 = the system's. "exec PROGRAM ..."
  /// makes signals reach the program and not its shell.
  explicit ChildProcess(const std::string& command, int pipe_bytes = 0) {
    int input[2];
    int output[2];
    if (pipe2(input, O_CLOEXEC) != 0 || pipe2(output, O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe for " + command);
    }
    if (pipe_bytes > 0) fcntl(output[1], F_SETPIPE_SZ, pipe_bytes);
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      dup2(input[0], STDIN_FILENO);
      dup2(output[1], STDOUT_FILENO);
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    close(input[0]);
    close(output[1]);
    input_ = fdopen(input[1], "w");
    output_ = fdopen(output[0], "r");
  }
  ~ChildProcess() {
    Signal(SIGKILL);
    Wait();
    std::fclose(output_);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void Send(const std::string& line) {
    std::fputs((line + "\n").c_str(), input_);
    std::fflush(input_);
  }
  /// Reads on until `part` was printed; false when the program ends first.
  bool ReadUntil(const std::string& part) {
    for (int c = std::fgetc(output_); c != EOF; c = std::fgetc(output_)) {
      text_ += static_cast<char>(c);
      if (text_.ends_with(part)) return true;
    }
    return false;
  }
  /// What was read, since the last TakeText().
  const std::string& text() const { return text_; }
  std::string TakeText() { return std::exchange(text_, {}); }

  void Signal(int signal) const {
    if (pid_ > 0) kill(pid_, signal);
  }
  /// As a crash.
  void Kill() {
    Signal(SIGKILL);
    Wait();
  }
  /// Ends its input and reads the rest of its output. Exit code, or 128 + the signal that ended it;
  /// -1 when it was waited for before.
  int Wait() {
    if (pid_ <= 0) return -1;
    std::fclose(input_);
    while (ReadUntil("\n")) {
    }
    int status = 0;
    waitpid(std::exchange(pid_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
  std::FILE* input_ = nullptr;
  std::FILE* output_ = nullptr;
  std::string text_;
};

}  // namespace conav::test
