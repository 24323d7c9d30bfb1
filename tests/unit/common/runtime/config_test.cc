#include "common/runtime/config.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

namespace fs = std::filesystem;

struct Inner {
  double gain = 0.5;
  std::string token;
  void Visit(ConfigReader& reader) {
    reader.Field("gain", gain, 0.0, 1.0);
    reader.Secret("token", token);
  }
};

struct Outer {
  int count = 3;
  std::string mode = "fast";
  std::vector<std::string> names{"a"};
  bool loud = false;
  Inner inner;

  void Visit(ConfigReader& reader) {
    reader.Field("count", count, 1, 10);
    reader.Choice("mode", mode, {"fast", "slow"});
    reader.Field("names", names);
    reader.Field("loud", loud);
    reader.Section("inner", inner);
  }
};

Outer Read(const std::string& yaml) {
  Outer config;
  ReadConfig(YAML::Load(yaml), "test", config);
  return config;
}

std::string RefusalOf(const std::string& yaml) {
  try {
    Read(yaml);
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

class File {
 public:
  explicit File(const std::string& text)
      : path_(fs::temp_directory_path() / ("conav_config_" + std::to_string(getpid()) + ".yaml")) {
    std::ofstream(path_) << text;
  }
  ~File() { fs::remove(path_); }
  fs::path path() const { return path_; }

 private:
  fs::path path_;
};

TEST_CASE("an empty section keeps every default", "[runtime][config]") {
  const Outer config = Read("");
  CHECK(config.count == 3);
  CHECK(config.mode == "fast");
  CHECK(config.inner.gain == 0.5);
}

TEST_CASE("given values replace defaults, others stay", "[runtime][config]") {
  const Outer config = Read("{count: 10, names: [x, y], loud: true, inner: {gain: 0.25}}");
  CHECK(config.count == 10);
  CHECK(config.names == std::vector<std::string>{"x", "y"});
  CHECK(config.loud);
  CHECK(config.inner.gain == 0.25);
  CHECK(config.mode == "fast");
}

TEST_CASE("the ends of a range are in it, values beyond are refused", "[runtime][config]") {
  CHECK(Read("count: 1").count == 1);
  CHECK(RefusalOf("count: 0") == "test.count = 0 is out of range [1, 10]");
  CHECK(RefusalOf("count: 11") == "test.count = 11 is out of range [1, 10]");
  CHECK(RefusalOf("inner: {gain: .nan}") == "test.inner.gain = .nan is out of range [0, 1]");
}

TEST_CASE("wrong types, choices and shapes are refused by key and value", "[runtime][config]") {
  CHECK(RefusalOf("count: many") == "test.count = many has a value of the wrong type");
  CHECK(RefusalOf("mode: warp") == "test.mode = warp is not one of: fast, slow");
  CHECK(RefusalOf("inner: 5") == "test.inner: expected a mapping of parameters");
  CHECK(RefusalOf("[1, 2]") == "test: expected a mapping of parameters");
}

TEST_CASE("an unknown key is refused with the known ones, also in a section", "[runtime][config]") {
  CHECK(RefusalOf("cuont: 4") ==
        "test: unknown key 'cuont'; known keys: count, inner, loud, mode, names");
  CHECK(RefusalOf("inner: {gian: 0.5}") ==
        "test.inner: unknown key 'gian'; known keys: gain, token");
}

TEST_CASE("the effective config reads back as it was written", "[runtime][config]") {
  Outer config = Read("{count: 7, mode: slow, names: [p, q], loud: true, inner: {gain: 0.75}}");
  const File file(DumpConfig("robot", config));
  Outer copy;
  ReadConfig(LoadParameters(file.path(), "robot"), "robot", copy);
  CHECK(copy.count == 7);
  CHECK(copy.mode == "slow");
  CHECK(copy.names == std::vector<std::string>{"p", "q"});
  CHECK(copy.loud);
  CHECK(copy.inner.gain == 0.75);
}

TEST_CASE("a config that is written for others keeps its secrets", "[runtime][config]") {
  const Outer config = Read("{inner: {token: open-sesame}}");
  CHECK(DumpConfig("robot", config).find("open-sesame") != std::string::npos);
  const std::string shown = DumpConfig("robot", config, ConfigReader::Secrets::kKept);
  CHECK(shown.find("open-sesame") == std::string::npos);
  CHECK(shown.find("token: (not shown)") != std::string::npos);
  const std::string without = DumpConfig("robot", Outer(), ConfigReader::Secrets::kKept);
  CHECK(without.find("not shown") == std::string::npos);
}

TEST_CASE("a missing file, bad YAML and a missing section are named", "[runtime][config]") {
  CHECK_THROWS_WITH(LoadParameters("/none.yaml", "sim"), "/none.yaml: no such file");
  const File bad("a: [1");
  CHECK_THROWS_WITH(LoadParameters(bad.path(), "sim"),
                    Catch::StartsWith(bad.path().string() + ": not valid YAML"));
  const File other("planner: {ros__parameters: {}}\nnhpm: {}\n");
  CHECK_THROWS_WITH(
      LoadParameters(other.path(), "sim"),
      other.path().string() + ": no section 'sim: ros__parameters:'; sections here: planner, nhpm");
  CHECK_THROWS_AS(LoadParameters(other.path(), "nhpm"), StartupError);
}

TEST_CASE("a config file that is no mapping, or a folder, is refused", "[runtime][config]") {
  const std::string no_section = ": no section 'sim: ros__parameters:'; sections here: ";
  for (const char* text : {"hello", "", "[sim]"}) {
    const File file(text);
    CHECK_THROWS_WITH(LoadParameters(file.path(), "sim"), file.path().string() + no_section);
  }
  const File scalar("sim: hello\n[a, b]: 1\n");
  CHECK_THROWS_WITH(LoadParameters(scalar.path(), "sim"), Catch::Contains(no_section + "sim"));
  CHECK_THROWS_AS(LoadParameters("/proc", "sim"), StartupError);
  CHECK_THROWS_WITH(Read("{[a, b]: 1}"), Catch::Contains("unknown key '[a, b]'"));
}

TEST_CASE("a YAML file is read, whatever its document is made of", "[runtime][yaml]") {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    REQUIRE(WriteFile(folder / "a.yaml", text));
    return ReadYamlFile(folder / "a.yaml").value();
  };
  CHECK(read("a: {b: 3}")["a"]["b"].as<int>() == 3);
  CHECK(read("hello").IsScalar());
  CHECK(read("[1, 2]").IsSequence());
  CHECK(read("").IsNull());
}

TEST_CASE("a YAML file that is missing, a folder or malformed is named", "[runtime][yaml]") {
  const test::TemporaryFolder folder;
  CHECK(ReadYamlFile("/none.yaml").error().text == "/none.yaml: no such file");
  const auto of_folder = ReadYamlFile(folder.path());
  REQUIRE_FALSE(of_folder);
  CHECK(of_folder.error().text == folder.path().string() + ": cannot read: Is a directory");
  REQUIRE(WriteFile(folder / "a.yaml", "a: [1"));
  const auto malformed = ReadYamlFile(folder / "a.yaml");
  REQUIRE_FALSE(malformed);
  CHECK(malformed.error().code == ErrorCode::kMalformed);
  CHECK_THAT(malformed.error().text,
             Catch::StartsWith((folder / "a.yaml").string() + ": not valid YAML: "));
}

}  // namespace
}  // namespace conav
