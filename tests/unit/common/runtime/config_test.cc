#include "common/runtime/config.h"

#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

namespace fs = std::filesystem;

struct Inner {
  double gain = 0.5;
  std::string token;
  bool operator==(const Inner&) const = default;
  void Visit(ConfigReader& reader) {
    reader.Field("gain", gain, 0.0, 1.0);
    reader.Field("token", token);
  }
};

struct Outer {
  int count = 3;
  std::string mode = "fast";
  std::vector<std::string> names{"a"};
  bool loud = false;
  Inner inner;

  bool operator==(const Outer&) const = default;
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

class File {
 public:
  explicit File(const std::string& text) { REQUIRE(WriteFile(path(), text)); }
  fs::path path() const { return folder_ / "config.yaml"; }

 private:
  test::TemporaryFolder folder_;
};

TEST_CASE("given values replace defaults, others stay", "[config]") {
  CHECK(Read("") == Outer());
  CHECK(Read("{count: 10, names: [x, y], loud: true, inner: {gain: 0.25}}") ==
        Outer{10, "fast", {"x", "y"}, true, {0.25, ""}});
}

TEST_CASE("values out of range, of the wrong type and unknown keys are refused by key and value",
          "[config]") {
  CHECK(Read("count: 1").count == 1);
  CHECK(Read("count: 10").count == 10);
  for (const auto& [yaml, refusal] : std::vector<std::pair<const char*, const char*>>{
           {"count: 0", "test.count = 0 is out of range [1, 10]"},
           {"count: 11", "test.count = 11 is out of range [1, 10]"},
           {"inner: {gain: .nan}", "test.inner.gain = .nan"},
           {"count: many", "test.count = many"},
           {"mode: warp", "test.mode = warp is not one of: fast, slow"},
           {"inner: 5", "test.inner: expected a mapping"},
           {"[1, 2]", "test: expected a mapping"},
           {"cuont: 4", "test: unknown key 'cuont'; known keys: count, inner, loud, mode, names"},
           {"inner: {gian: 0.5}", "test.inner: unknown key 'gian'; known keys: gain, token"},
           {"{[a, b]: 1}", "test: unknown key '[a, b]'"},
       }) {
    CHECK_THROWS_WITH(Read(yaml), Catch::StartsWith(refusal));
  }
}

TEST_CASE("the effective config reads back as it was written", "[config]") {
  Outer config = Read("{count: 7, mode: slow, names: [p, q], loud: true, inner: {gain: 0.75}}");
  const File file(DumpConfig("robot", config));
  Outer copy;
  ReadConfig(LoadParameters(file.path(), "robot"), "robot", copy);
  CHECK(copy == Outer{7, "slow", {"p", "q"}, true, {0.75, ""}});
}

TEST_CASE("a dump says which values are from the file and which from elsewhere", "[config]") {
  const char* file = "{count: 3, inner: {gain: 0.75}}";
  Outer config = Read(file);
  const YAML::Node read = Emitted(config);
  config.mode = "slow";
  config.count = 4;
  const std::string dump = DumpConfig("robot", config, {YAML::Load(file), read, "command line"});
  for (const char* line :
       {"count: 4  # command line\n", "mode: slow  # command line\n", "gain: 0.75  # file\n",
        "loud: false\n", "# Values without a comment are defaults.\nrobot:\n"}) {
    CHECK_THAT(dump, Catch::Contains(line));
  }
}

TEST_CASE("a missing file, bad YAML, a missing section and other documents are named", "[config]") {
  CHECK_THROWS_WITH(LoadParameters("/none.yaml", "sim"), Catch::StartsWith("/none.yaml: "));
  CHECK_THROWS_AS(LoadParameters("/proc", "sim"), StartupError);
  const std::string no_section = ": no section 'sim: ros__parameters:'; sections here: ";
  for (const auto& [text, refusal] : std::vector<std::pair<std::string, std::string>>{
           {"a: [1", ": not valid YAML"},
           {"planner: {ros__parameters: {}}\nnhpm: {}\n", no_section + "planner, nhpm"},
           {"hello", no_section},
           {"", no_section},
           {"[sim]", no_section},
           {"sim: hello\n[a, b]: 1\n", no_section + "sim"},
       }) {
    const File file(text);
    CHECK_THROWS_WITH(LoadParameters(file.path(), "sim"),
                      Catch::StartsWith(file.path().string() + refusal));
  }
  CHECK_THROWS_AS(LoadParameters(File("nhpm: {}").path(), "nhpm"), StartupError);
}

TEST_CASE("a YAML file is read or named", "[yaml]") {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    REQUIRE(WriteFile(folder / "a.yaml", text));
    return ReadYamlFile(folder / "a.yaml");
  };
  CHECK((*read("a: {b: 3}"))["a"]["b"].as<int>() == 3);
  CHECK(read("a: [1").error().code == ErrorCode::kMalformed);
  CHECK_THAT(read("a: [1").error().text, Catch::StartsWith((folder / "a.yaml: ").string()));
  CHECK(ReadYamlFile("/none.yaml").error().code == ErrorCode::kNotFound);
}

/// A preset sets both values.
struct Tuned {
  std::string preset = "slow";
  int rounds = 1;
  Inner inner;

  void StartFrom(std::string name) {
    *this = {};
    preset = name;
    if (name == "fast") rounds = 9;
  }
  void Visit(ConfigReader& reader) {
    reader.Choice("preset", preset, {"slow", "fast"});
    if (reader.reading()) StartFrom(preset);
    reader.Field("rounds", rounds);
    reader.Section("inner", inner);
    if (reader.is_base()) return;
    Tuned base;
    base.StartFrom(preset);
    reader.FromPreset(base);
  }
};

TEST_CASE("a dump says which values the preset set, and another preset in a copy of it counts",
          "[config]") {
  Tuned config;
  config.StartFrom("fast");
  config.inner.gain = 0.25;
  const YAML::Node dump = YAML::Load(DumpConfig("robot", config))["robot"]["ros__parameters"];
  CHECK(dump["from_preset"]["rounds"].as<int>() == 9);
  CHECK(dump["from_preset"]["inner"]["token"].IsDefined());
  CHECK(dump["inner"]["gain"].as<double>() == 0.25);
  CHECK_FALSE(dump["rounds"].IsDefined());
  Tuned read;
  ReadConfig(dump, "file", read);
  CHECK(read.rounds == 9);
  CHECK(read.inner == config.inner);
  YAML::Node copy = YAML::Clone(dump);
  copy["preset"] = "slow";
  ReadConfig(copy, "file", read);
  CHECK(read.rounds == 1);
  CHECK(read.inner == config.inner);
}

}  // namespace
}  // namespace conav
