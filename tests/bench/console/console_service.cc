#include "bench/console/console_service.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "common/runtime/file.h"
#include "integration/operator/page_client.h"
#include "operator/config.h"

namespace conav::bench {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

launcher::Process Start(const fs::path& folder, const Drive& drive, int domain) {
  operators::OperatorConfig config;
  config.bus.domain_id = domain;
  config.bus.interface = "lo";
  config.robots.clear();
  for (int i = 0; i < drive.robots; ++i) config.robots.push_back("w1/" + RobotName(i));
  config.database = (folder / "operator.db").string();
  config.console.port = 0;
  config.console.url_file = (folder / "url").string();
  const fs::path file = folder / "operator.yaml";
  if (const auto written = WriteFile(file, DumpConfig("operator", config)); !written) {
    throw StartupError(written.error().text);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav-operator";
  return {"conav-operator", {program.string(), "--config", file.string()}, folder / "operator.log"};
}

}  // namespace

ConsoleService::ConsoleService(const fs::path& folder, const Drive& drive, int domain)
    : process_(Start(folder, drive, domain)), url_(WaitForUrl(folder / "url")) {
  port_ = std::stoi(url_.substr(url_.rfind(':') + 1));
}

std::string ConsoleService::WaitForUrl(const fs::path& file) {
  const auto deadline = std::chrono::steady_clock::now() + 20s;
  while (std::chrono::steady_clock::now() < deadline && !process_.Poll()) {
    const auto text = ReadFile(file);
    if (text && text->ends_with('\n')) return text->substr(0, text->size() - 1);
    std::this_thread::sleep_for(20ms);
  }
  throw StartupError(WithLog("conav-operator does not serve its page:"));
}

std::string ConsoleService::WithLog(std::string what) const {
  for (const std::string& line : launcher::LastLines(process_.log(), 5)) what += "\n" + line;
  return what;
}

Usage ConsoleService::Used() {
  if (process_.Poll()) throw StartupError(WithLog("conav-operator has died:"));
  Usage usage;
  std::string text;
  std::getline(std::ifstream(fmt::format("/proc/{}/stat", process_.pid())), text);
  std::istringstream words(text.substr(text.rfind(") ") + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) words >> skipped;  // utime and stime are the 14th and 15th of all
  double user = 0.0;
  double system = 0.0;
  words >> user >> system;
  usage.cpu_s = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  std::ifstream status(fmt::format("/proc/{}/status", process_.pid()));
  for (std::string word; status >> word;) {
    if (word == "RssAnon:") status >> usage.memory_mb;  // kB
  }
  usage.memory_mb /= 1024.0;
  return usage;
}

double ConsoleService::Metric(const std::string& name) const {
  if (const auto value = operators::MetricOf(port_, name)) return *value;
  throw StartupError("the service has no figure " + name);
}

}  // namespace conav::bench
