#include "mapping_task/task_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/runtime/file.h"
#include "common/segments/segment.h"

namespace conav::mapping_task {
namespace {

bool IsValid(const MazeResult& result) {
  return result.mapping_accuracy > kAcceptedMappingAccuracy;
}

std::optional<MazeResult> Parse(const std::string& text) {
  MazeResult result;
  result.document = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!result.document.is_object() || !result.document.contains("mapping_accuracy")) return {};
  const auto& accuracy = result.document["mapping_accuracy"];
  if (!accuracy.is_number()) return std::nullopt;
  result.mapping_accuracy = accuracy.get<double>();
  return result;
}

nlohmann::ordered_json MazeJson(const TaskOptions& options, int number, std::uint64_t seed,
                                const MazeResult& result) {
  nlohmann::ordered_json json = {{"number", number},
                                 {"method", MethodOf(options, number)},
                                 {"seed", seed},
                                 {"valid", IsValid(result)}};
  json.update(result.document);
  json.erase("participant");
  return json;
}

}  // namespace

Result<std::optional<MazeResult>> ReadMazeResult(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return std::nullopt;
  if (!text) return tl::unexpected(text.error());
  auto result = Parse(*text);
  if (result) return result;
  return Fail(ErrorCode::kMalformed, file.string() + " is no result of a maze");
}

nlohmann::ordered_json TaskJson(const TaskOptions& options,
                                const std::vector<MazeResult>& results) {
  const std::vector<std::uint64_t> seeds = SeedsOf(options);
  nlohmann::ordered_json mazes = nlohmann::ordered_json::array();
  double sum = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    mazes.push_back(MazeJson(options, static_cast<int>(i) + 1, seeds.at(i), results[i]));
    sum += results[i].mapping_accuracy;
  }
  const auto count = static_cast<double>(results.size());
  return {{"participant", options.participant},
          {"preset", options.preset},
          {"complete", results.size() == seeds.size()},
          {"mazes_wanted", seeds.size()},
          {"mazes_finished", results.size()},
          {"mazes_valid", std::ranges::count_if(results, IsValid)},
          {"mean_mapping_accuracy", results.empty() ? 0.0 : sum / count},
          {"segments", "segments.pb.zst"},
          {"mazes", std::move(mazes)}};
}

std::string MazeLine(int number, const MazeResult& result) {
  const auto number_of = [&](const char* key) { return result.document.value(key, 0); };
  return fmt::format(
      "maze {}  mapping accuracy {:.1f} %  cells right {:.1f} %  edits {}  pictures {}  {:.0f} s{}",
      number, 100.0 * result.mapping_accuracy, 100.0 * result.document.value("cell_accuracy", 0.0),
      number_of("edits"), number_of("pictures"), result.document.value("duration_s", 0.0),
      IsValid(result)
          ? ""
          : fmt::format("  (not valid: {:.0f} % or less)", 100.0 * kAcceptedMappingAccuracy));
}

}  // namespace conav::mapping_task
