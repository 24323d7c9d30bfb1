#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "common/runtime/file.h"
#include "launcher/process.h"
#include "support/program_runner.h"
#include "support/scoped_variable.h"
#include "support/test_domain.h"
#include "system/launcher/demo_run.h"

namespace conav::test {

/// A desk for conav-study, whose programs keep to the test's domain and whose study is in `study`.
class StudyFixture {
 public:
  ProgramOutcome Run(const std::string& arguments) const { return desk_.Run(arguments); }

  std::filesystem::path operator/(const std::string& name) const { return desk_ / name; }
  std::filesystem::path log() const { return desk_ / "study.log"; }
  nlohmann::json Json(const std::string& name) const {
    return nlohmann::json::parse(ReadFile(desk_ / name).value());
  }
  /// Of episodes or trials.
  std::size_t Records(const std::string& kind) const {
    std::error_code none;
    const std::filesystem::directory_iterator files(desk_ / "study" / kind, none);
    return none ? 0 : static_cast<std::size_t>(std::count_if(begin(files), end(files), [](auto& e) {
      return e.path().extension() == ".json";
    }));
  }

 private:
  ScopedVariable domain_{"CONAV_DOMAIN", std::to_string(TestDomain()).c_str()};
  ProgramRunner desk_{"conav-study"};
};

/// conav-study in the background; it says what it has to say into desk.log().
class RunningStudy {
 public:
  /// `arguments` are words with spaces between; --out is added.
  RunningStudy(const StudyFixture& desk, const std::string& arguments)
      : process_("conav-study", Words(arguments, desk), desk.log()) {}

  pid_t pid() const { return process_.pid(); }
  /// Fails the test when it has not ended within `limit`; else its end.
  launcher::ProcessEnd Wait(std::chrono::seconds limit) {
    REQUIRE(conav::testing::WaitUntil([&] { return process_.Poll(); }, limit));
    return *process_.end();
  }
  launcher::ProcessEnd End(int signal) {
    process_.Signal(signal);
    return Wait(std::chrono::seconds(30));
  }

 private:
  static std::vector<std::string> Words(const std::string& arguments, const StudyFixture& desk) {
    std::vector<std::string> words{std::string(CONAV_BIN_DIR) + "/conav-study"};
    std::istringstream text(arguments);
    for (std::string word; text >> word;) words.push_back(word);
    words.insert(words.end(), {"--out", (desk / "study").string()});
    return words;
  }

  launcher::Process process_;
};

/// Waits until one of its episodes or trials is on disk.
inline void WaitForRecord(const StudyFixture& desk, const std::string& kind) {
  REQUIRE(
      conav::testing::WaitUntil([&] { return desk.Records(kind) > 0; }, std::chrono::seconds(90)));
}

}  // namespace conav::test
