// conav-operator and conav-simulated-operator as real processes on real DDS, beside a hand-made
// simulator.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <functional>

#include "integration/operator/hand_made_sim.h"
#include "operator/simulated_operator/config.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> kMap = {"######", "#    #", "# ## #", "#    #", "######"};

/// A program of ours with a config file; killed when this object goes.
class Program {
 public:
  Program(const std::string& name, const std::filesystem::path& config) {
    const std::string path = std::string(CONAV_BIN_DIR) + "/" + name;
    pid_ = fork();
    REQUIRE(pid_ >= 0);
    if (pid_ == 0) {
      execl(path.c_str(), name.c_str(), "--config", config.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Program() { End(SIGKILL); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Sends `signal` and returns the exit status as waitpid gives it.
  int End(int signal) {
    if (pid_ == 0) return 0;
    kill(pid_, signal);
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = 0;
    return status;
  }

 private:
  pid_t pid_ = 0;
};

bus::ParticipantOptions Options(const std::string& vendor) {
  bus::ParticipantOptions options;
  options.vendor = vendor;
  options.domain_id = 20 + getpid() % 200;
  options.interface = "lo";
  return options;
}

/// Guidance for r1 that `wanted` accepts, or a failure after 20 s.
Guidance WaitForGuidance(HandMadeSim& sim, const std::function<bool(const Guidance&)>& wanted) {
  const SteadyClock clock;
  const auto deadline = clock.Now() + 20s;
  while (clock.Now() < deadline) {
    sim.participant.Wait(100ms);
    for (const auto& message : sim.guidance.Take()) {
      const auto guidance = ToDomain(message);
      REQUIRE(guidance.has_value());
      if (wanted(*guidance)) return *guidance;
    }
  }
  FAIL("no guidance within 20 s");
  return {};
}

std::filesystem::path WriteConfig(const std::filesystem::path& file, const std::string& yaml) {
  std::ofstream(file) << yaml;
  return file;
}

TEST_CASE("Killed between two pictures, the operator service goes on where it was",
          "[operator][integration]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const TemporaryFolder folder;
  OperatorConfig service_config = ConfigFor(folder / "operator.db");
  service_config.bus = Options(vendor);
  SimulatedOperatorConfig person_config;
  person_config.bus = Options(vendor);
  const auto service_file =
      WriteConfig(folder / "operator.yaml", DumpConfig("operator", service_config));
  const auto person_file =
      WriteConfig(folder / "person.yaml", DumpConfig("simulated_operator", person_config));

  HandMadeSim sim(Options(vendor));
  sim.PublishInitialMap(kMap);
  sim.PublishState({1, 1}, 5);
  Program service("conav-operator", service_file);
  Program person("conav-simulated-operator", person_file);
  const Guidance first = WaitForGuidance(sim, [](const Guidance&) { return true; });
  CHECK(first.path.size() == 4);
  CHECK(WTERMSIG(service.End(SIGKILL)) == SIGKILL);

  Picture picture;
  picture.stamp = {10};
  picture.world = "w1";
  picture.robot = "r1";
  picture.sequence_number = 1;
  picture.cell = {1, 1};
  picture.horizontal_fov_rad = 1.4;
  picture.visible = {{{1, 1}, {1, 2}}, {}};
  picture.path = {{1, 1}};
  picture.goals_left = {{1, 4}};
  REQUIRE(sim.snapshot.Publish(ToMessage(picture)));  // nobody there to store an answer

  Program again("conav-operator", service_file);
  const Guidance answer =
      WaitForGuidance(sim, [](const Guidance& g) { return g.answers_snapshot == 1; });
  CHECK(answer.revision == first.revision + 1);
  CHECK(WEXITSTATUS(again.End(SIGTERM)) == 0);
  CHECK(WEXITSTATUS(person.End(SIGINT)) == 0);
}

TEST_CASE("A program that is used wrongly, or cannot start, says so by its exit status",
          "[operator][integration]") {
  const TemporaryFolder folder;
  const auto unknown_key =
      WriteConfig(folder / "a.yaml", "operator:\n  ros__parameters:\n    databse: x\n");
  Program misspelt("conav-operator", unknown_key);
  CHECK(WEXITSTATUS(misspelt.End(0)) == 1);
  std::ofstream(folder / "broken.db") << std::string(9000, 'x');
  OperatorConfig config = ConfigFor(folder / "broken.db");
  config.bus = Options("cyclonedds");
  Program corrupt("conav-operator", WriteConfig(folder / "b.yaml", DumpConfig("operator", config)));
  CHECK(WEXITSTATUS(corrupt.End(0)) == 1);
}

}  // namespace
}  // namespace conav::operators
