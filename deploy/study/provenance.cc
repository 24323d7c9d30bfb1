#include "study/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

namespace conav::study {
namespace {

constexpr std::size_t kMostText = 80;

/// For a shell.
std::string Quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=,./:+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string inner;
  for (const char c : word) {
    if (c == '\'') inner += "'\\'";
    inner += c;
  }
  return fmt::format("'{}'", inner);
}

std::string Processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace

Provenance DescribeRun(int argc, const char* const* argv) {
  Provenance provenance{.command = "conav study"};
  for (int i = 1; i < argc; ++i) provenance.command += fmt::format(" {}", Quoted(argv[i]));
  const char* commit = std::getenv("CONAV_COMMIT");
  provenance.commit = commit != nullptr ? commit : "unknown";
  provenance.date = fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
  provenance.machine =
      fmt::format("{}, {} cores", Processor(), std::thread::hardware_concurrency());
  return provenance;
}

statistics::ReportSection ProvenanceSection(const Provenance& provenance,
                                            const nlohmann::ordered_json& design) {
  statistics::ReportSection section{.title = "How it was made", .header = {"", ""}};
  section.rows = {{"command", provenance.command},
                  {"commit", provenance.commit},
                  {"report written", provenance.date},
                  {"on", provenance.machine}};
  for (const auto& [key, value] : design.items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!text.empty() && text.size() <= kMostText) section.rows.push_back({key, text});
  }
  return section;
}

}  // namespace conav::study
