#include "bench/bus/traffic.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace conav::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kPatience{10'000};

double Quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

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

Traffic::Traffic(const StackOptions& options, const std::string& own_program)
    : name_(options.name()) {
  std::vector<std::string> arguments = {"--peer", options.vendor, "--domain",
                                        std::to_string(options.domain_id)};
  if (options.raw) arguments.push_back("--raw");
  peer_ = std::make_unique<PeerProcess>(own_program, arguments, false);
  pinger_ = MakePinger(options, [this](std::uint64_t id) { OnPong(id); });
  Connect();
}

Traffic::~Traffic() = default;

void Traffic::OnPong(std::uint64_t id) {
  if (id == next_id_ && id < last_id_) {
    const auto now = steady_clock::now();
    times_us_.push_back(std::chrono::duration<double, std::micro>(now - sent_at_).count());
    sent_at_ = now;
    pinger_->SendPing(++next_id_);
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    answered_ = id;
  }
  answer_.notify_one();
}

bool Traffic::WaitFor(std::uint64_t id, milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return answer_.wait_for(lock, timeout, [&] { return answered_ == id; });
}

void Traffic::Connect() {
  const auto start = steady_clock::now();
  const auto settled = milliseconds(500);
  steady_clock::time_point first_answer{};
  pinger_->Prepare(64);
  for (;;) {
    const std::uint64_t id = ++next_id_;
    pinger_->SendPing(id);
    const bool answered = WaitFor(id, milliseconds(20));
    const auto now = steady_clock::now();
    if (answered && first_answer == steady_clock::time_point{}) first_answer = now;
    if (answered && now - first_answer > settled) return;
    if (now - start > kPatience) throw std::runtime_error(name_ + ": the peer does not answer");
  }
}

RoundTrips Traffic::MeasureRoundTrips(std::size_t size, std::uint64_t count) {
  pinger_->Prepare(size);
  times_us_.clear();
  times_us_.reserve(count);
  last_id_ = next_id_ + count + 1;
  const std::uint64_t last = last_id_;
  sent_at_ = steady_clock::now();
  pinger_->SendPing(++next_id_);
  if (!WaitFor(last, kPatience)) throw std::runtime_error(name_ + ": a message was lost");
  last_id_ = 0;
  std::sort(times_us_.begin(), times_us_.end());
  return {Quantile(times_us_, 0.5), Quantile(times_us_, 0.99)};
}

double Traffic::MeasureRate(std::size_t size, std::uint64_t count) {
  pinger_->Prepare(size);
  const auto start = steady_clock::now();
  for (std::uint64_t i = 1; i < count; ++i) {
    while (!pinger_->SendFlood(i)) {
      if (steady_clock::now() - start > kPatience) throw std::runtime_error(name_ + ": stuck");
    }
  }
  while (!pinger_->SendFlood(kEndOfFlood)) {
    if (steady_clock::now() - start > kPatience) throw std::runtime_error(name_ + ": stuck");
  }
  if (!WaitFor(kEndOfFlood, kPatience))
    throw std::runtime_error(name_ + ": the flood's end is lost");
  const std::chrono::duration<double> elapsed = steady_clock::now() - start;
  {
    const std::lock_guard lock(mutex_);
    answered_ = 0;
  }
  return static_cast<double>(count) / elapsed.count();
}

}  // namespace conav::bench
