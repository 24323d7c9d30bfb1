#include <google/protobuf/stubs/logging.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "nhpm/model/weights_file.h"
#include "operator/gateway/access.h"
#include "operator/recording/mcap_file.h"
#include "planner/explain/decision_file.h"
#include "sim/world/world_site.h"
#include "study/statistics/table_reader.h"
#include "unit/common/segments/support/sample_segments.h"
#include "unit/planner/explain/sample_decision.h"

/// Whatever is in a file that somebody opens. CONAV_FUZZ_READER names the reader: one of kReaders. With
/// CONAV_FUZZ_SEEDS=FOLDER the program writes seeds into it and ends.
namespace conav {
namespace {

/// A file in memory, which has a path.
class MemoryFile {
 public:
  MemoryFile() : number_(::memfd_create("fuzz", 0)) { DEMAND(number_ >= 0); }
  ~MemoryFile() { ::close(number_); }

  void Fill(std::string_view bytes) const {
    DEMAND(::ftruncate(number_, 0) == 0);
    DEMAND(::pwrite(number_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  }
  std::string path() const { return "/proc/self/fd/" + std::to_string(number_); }

 private:
  int number_;
};

void ReadMcap(const std::string& file, std::string_view) {
  auto reader = bag::McapReader::Open(file, std::uint64_t{64} << 20);
  if (!reader) return;
  std::uint64_t time = 0;
  for (int errors = 0; errors < 100;) {
    const auto next = reader->Next();
    if (!next) {
      ++errors;
      continue;
    }
    if (!*next) break;
    DEMAND((*next)->topic != nullptr && (*next)->log_time >= time, time);
    time = (*next)->log_time;
  }
  reader->Seek(reader->start_time() + 1);
  static_cast<void>(reader->Next());
}

void ReadWeights(const std::string& file, std::string_view bytes) {
  static_cast<void>(nhpm::ReadWeightsFile(file));
  // Behind the checksum, which nobody hits by chance.
  proto::Weights weights;
  if (!weights.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return;
  const auto architecture = nhpm::ArchitectureFrom(weights.architecture());
  if (!architecture) return;
  static_cast<void>(nhpm::WeightsFrom(weights.width(), *architecture, weights.layers()));
}

void ReadDecisionFile(const std::string& file, std::string_view) {
  static_cast<void>(planner::ReadDecisions(file, [](planner::DecisionRecord&&) {}));
}

void ReadSegments(const std::string& file, std::string_view) {
  static_cast<void>(ReadSegmentFile(file, TornEnd::kDrop));
}

void ReadSegmentsJson(const std::string& file, std::string_view) {
  static_cast<void>(ImportSegmentsFile(file));
}

void ReadYaml(const std::string& file, std::string_view) {
  try {
    operators::GatewayOptions options;
    ReadConfig(LoadParameters(file, "x"), "x", options);
    DEMAND(DumpConfig("x", options).size() > 0);
  } catch (const StartupError&) {
  }
  static_cast<void>(sim::LoadMapFile(file, {}));
}

void ReadTokens(const std::string& file, std::string_view) {
  static_cast<void>(operators::ReadTokens(file));
}

void ReadCsv(const std::string&, std::string_view bytes) {
  static_cast<void>(statistics::ParseTable(bytes, "x"));
}

void ReadMap(const std::string& file, std::string_view) {
  static const MemoryFile header;
  static const bool written = [&] {
    header.Fill("image: " + file + "\nresolution: 1.0\norigin: [0, 0, 0]\nnegate: 0\n" +
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
    return true;
  }();
  DEMAND(written);
  static_cast<void>(sim::LoadMapFile(header.path(), {.cell_size_m = 1.0}));
}

using Reader = void (*)(const std::string& file, std::string_view bytes);
constexpr std::pair<std::string_view, Reader> kReaders[] = {{"mcap", ReadMcap},
                                                            {"weights", ReadWeights},
                                                            {"decisions", ReadDecisionFile},
                                                            {"segments", ReadSegments},
                                                            {"segments_json", ReadSegmentsJson},
                                                            {"yaml", ReadYaml},
                                                            {"tokens", ReadTokens},
                                                            {"csv", ReadCsv},
                                                            {"map", ReadMap}};

Reader NamedReader() {
  const char* name = std::getenv("CONAV_FUZZ_READER");
  for (const auto& [known, reader] : kReaders) {
    if (name != nullptr && known == name) return reader;
  }
  DEMAND(false, "CONAV_FUZZ_READER");
  return nullptr;
}

}  // namespace
}  // namespace conav

namespace conav {
namespace {

void WriteMcap(const std::filesystem::path& file) {
  auto writer = bag::McapWriter::Create(file, {}, {{"conav", {{"version", "1"}}}}).value();
  const auto topic = writer.AddChannel({0, "std_msgs/msg/String", "ros2msg", "string data\n"},
                                       {0, 0, "/a", "cdr", {{"offered_qos_profiles", ""}}});
  for (std::uint64_t i = 0; i < 3; ++i) {
    DEMAND(writer.Write(topic, 10 * i, i, bag::Bytes(20)).has_value());
    DEMAND(writer.Flush().has_value());
  }
  DEMAND(writer.Finish().has_value());
}

/// The seeds that are not text.
void WriteSeeds(const std::filesystem::path& folder) {
  for (const char* reader : {"mcap", "weights", "decisions", "segments", "segments_json"}) {
    std::filesystem::create_directories(folder / reader);
  }
  WriteMcap(folder / "mcap/whole");
  const std::string bytes = ReadFile(folder / "mcap/whole").value();
  DEMAND(WriteFile(folder / "mcap/cut_off", bytes.substr(0, bytes.size() / 2)).has_value());
  proto::Weights weights;
  weights.set_name("nhpm");
  weights.set_width(16);
  weights.add_layers()->add_weights(0.5F);
  DEMAND(WriteFile(folder / "weights/proto", weights.SerializeAsString()).has_value());
  auto log = planner::DecisionLog::Open(folder / "decisions/one").value();
  DEMAND(log.Append(planner::SampleDecision()).has_value());
  SegmentSet set;
  set.trajectories = {tests::SampleTrajectory()};
  DEMAND(WriteSegmentFile(folder / "segments/one", set).has_value());
  DEMAND(ExportSegmentsFile(folder / "segments_json/one", set).has_value());
}

}  // namespace
}  // namespace conav

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);  // it tells of each text that is no UTF-8
  if (const char* seeds = std::getenv("CONAV_FUZZ_SEEDS")) {
    conav::WriteSeeds(seeds);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const conav::MemoryFile file;
  static const conav::Reader reader = conav::NamedReader();
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  file.Fill(bytes);
  reader(file.path(), bytes);
  return 0;
}
