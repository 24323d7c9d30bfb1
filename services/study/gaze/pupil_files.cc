#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/runtime/file.h"
#include "study/gaze/csv_rows.h"
#include "study/gaze/eye_recording.h"

namespace conav::gaze {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A file that does not exist has no rows. Errors: kIo, kMalformed.
Result<void> ReadRows(const fs::path& file, const std::function<void(CsvRow&)>& take) {
  return fs::exists(file) ? ReadCsvRows(file, take) : Result<void>();
}

Fixation FixationOf(CsvRow& row, const char* id) {
  return {static_cast<std::int64_t>(row.Number(id)), row.Number("start_timestamp"),
          row.Number("duration") / 1000.0, row.Number("norm_pos_x"), row.Number("norm_pos_y")};
}

Mark MarkOf(CsvRow& row) {
  Mark mark{row.Number("timestamp"), row.Text("label"), {}};
  for (const auto& [column, index] : row.columns()) {
    const bool is_own = column == "index" || column == "timestamp" || column == "label" ||
                        column == "duration" || column == "added_in_capture";
    if (!is_own && row.Has(column)) mark.keys[column] = row.Text(column);
  }
  return mark;
}

/// surfaces/gaze_positions_on_surface_<name>.csv and fixations_on_surface_<name>.csv.
Result<void> ReadSurfaces(const fs::path& folder, EyeCollector& collector) {
  static constexpr std::string_view kGaze = "gaze_positions_on_surface_";
  static constexpr std::string_view kFixations = "fixations_on_surface_";
  std::error_code none;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / "surfaces", none)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    const std::string name = file.stem().string();
    const auto surface = [&](std::string_view prefix) -> SurfaceGaze& {
      return collector.recording().surfaces[name.substr(prefix.size())];
    };
    Result<void> read;
    if (name.starts_with(kGaze)) {
      SurfaceGaze& here = surface(kGaze);
      read = ReadRows(file, [&](CsvRow& row) {
        if (!row.IsTrue("on_surf")) return;
        here.gaze.push_back({row.Number("gaze_timestamp"), row.Number("confidence"),
                             row.Number("x_norm"), row.Number("y_norm")});
      });
    } else if (name.starts_with(kFixations)) {
      SurfaceGaze& here = surface(kFixations);
      read = ReadRows(file, [&](CsvRow& row) {
        if (row.IsTrue("on_surf"))
          collector.AddFixation(here.fixations, FixationOf(row, "fixation_id"));
      });
    }
    if (!read) return read;
  }
  return {};
}

/// `folder` empty: there is none.
Result<void> ReadExport(const fs::path& folder, EyeCollector& collector) {
  if (folder.empty()) return {};
  EyeRecording& recording = collector.recording();
  const auto pupils = [&](CsvRow& row) {
    const bool is_3d = row.Has("diameter_3d");
    collector.AddPupil({row.Number("pupil_timestamp"), static_cast<int>(row.Number("eye_id")),
                        row.Number("confidence"), row.Number(is_3d ? "diameter_3d" : "diameter")},
                       is_3d);
  };
  const auto gaze = [&](CsvRow& row) {
    recording.gaze.push_back({row.Number("gaze_timestamp"), row.Number("confidence"),
                              row.Number("norm_pos_x"), row.Number("norm_pos_y")});
  };
  const auto blinks = [&](CsvRow& row) {
    const double begin = row.Number("start_timestamp");
    recording.blinks.push_back({begin, begin + row.Number("duration")});
  };
  return ReadRows(folder / "pupil_positions.csv", pupils)
      .and_then([&] { return ReadRows(folder / "gaze_positions.csv", gaze); })
      .and_then([&] { return ReadRows(folder / "blinks.csv", blinks); })
      .and_then([&] {
        return ReadRows(folder / "fixations.csv", [&](CsvRow& row) {
          collector.AddFixation(recording.fixations, FixationOf(row, "id"));
        });
      })
      .and_then([&] {
        return ReadRows(folder / "annotations.csv",
                        [&](CsvRow& row) { recording.marks.push_back(MarkOf(row)); });
      })
      .and_then([&] { return ReadSurfaces(folder, collector); });
}

std::span<const std::uint8_t> BytesOf(const json& value) {
  if (value.is_binary()) return value.get_binary();
  const auto& text = value.get_ref<const std::string&>();
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// MessagePack: pairs of a topic and the bytes of a message, which are MessagePack again.
Result<void> ReadMessages(const fs::path& path, EyeCollector& collector) {
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) return Fail(ErrorCode::kIo, path.string() + ": cannot be read");
  while (file.rdbuf()->sgetc() != std::char_traits<char>::eof()) {
    const auto byte = static_cast<long long>(file.tellg());
    const auto refuse = [&](const std::string& reason) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("{}, byte {}: {}", path.string(), byte, reason));
    };
    const json pair = json::from_msgpack(file, false, false);
    if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() ||
        !(pair[1].is_binary() || pair[1].is_string())) {
      return refuse("is not a topic and a message");
    }
    const auto message = ParseMessage(BytesOf(pair[1]));
    if (!message) return refuse(message.error().text);
    if (auto added = collector.Add(pair[0].get<std::string>(), *message); !added) {
      return refuse(added.error().text);
    }
  }
  return {};
}

/// A part of a recording: Capture's file and Player's.
struct Part {
  const char* captured;
  const char* exported;
};

/// The files of Pupil Capture, but for what `exported` (may be empty) has.
Result<void> ReadCapture(const fs::path& folder, const fs::path& exported,
                         EyeCollector& collector) {
  static constexpr std::array kParts{
      Part{"pupil.pldata", "pupil_positions.csv"}, Part{"gaze.pldata", "gaze_positions.csv"},
      Part{"blinks.pldata", "blinks.csv"},         Part{"fixations.pldata", "fixations.csv"},
      Part{"surfaces.pldata", "surfaces"},         Part{"annotation.pldata", "annotations.csv"}};
  for (const Part& part : kParts) {
    const fs::path file = folder / part.captured;
    const bool is_exported = !exported.empty() && fs::exists(exported / part.exported);
    if (is_exported || !fs::exists(file)) continue;
    if (auto read = ReadMessages(file, collector); !read) return read;
  }
  return {};
}

/// The export with the highest number; empty = none.
fs::path NewestExport(const fs::path& recording) {
  std::error_code none;
  fs::path newest;
  for (const auto& entry : fs::directory_iterator(recording / "exports", none)) {
    const bool is_export = fs::exists(entry.path() / "pupil_positions.csv");
    if (is_export && entry.path().filename() > newest.filename()) newest = entry.path();
  }
  return newest;
}

/// What info.player.json says: the recording's name, and UTC less its clock. Errors: kMalformed.
Result<void> ReadInfo(const fs::path& file, EyeRecording& recording) {
  const auto text = ReadFile(file);
  if (!text && text.error().code == ErrorCode::kNotFound) return {};
  if (!text) return tl::unexpected(text.error());
  const json info = json::parse(*text, nullptr, false);
  if (!info.is_object()) return Fail(ErrorCode::kMalformed, file.string() + ": is not JSON");
  if (info.contains("recording_name") && info["recording_name"].is_string()) {
    recording.name = info["recording_name"].get<std::string>();
  }
  const auto number = [&](const char* key) {
    return info.contains(key) && info[key].is_number() ? std::optional(info[key].get<double>())
                                                       : std::nullopt;
  };
  const auto system = number("start_time_system_s");
  const auto synced = number("start_time_synced_s");
  if (system && synced) recording.utc_offset_s = *system - *synced;
  return {};
}

/// The recording's folder of an export: exports/NNN is two levels below it.
fs::path RecordingOf(const fs::path& exported) {
  return fs::absolute(exported / "").lexically_normal().parent_path().parent_path().parent_path();
}

}  // namespace

Result<EyeRecording> ReadEyeRecording(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    return Fail(ErrorCode::kNotFound, folder.string() + ": no such folder");
  }
  const bool is_export = fs::exists(folder / "pupil_positions.csv");
  const fs::path exported = is_export ? folder : NewestExport(folder);
  const fs::path captured = is_export ? RecordingOf(folder) : folder;
  EyeCollector collector;
  collector.recording().name =
      fs::absolute(folder / "").lexically_normal().parent_path().filename().string();
  const auto read = ReadInfo(captured / "info.player.json", collector.recording())
                        .and_then([&] { return ReadExport(exported, collector); })
                        .and_then([&] { return ReadCapture(captured, exported, collector); });
  if (!read) return tl::unexpected(read.error());
  EyeRecording recording = std::move(collector).Finish();
  constexpr double kLongestS = 24.0 * 3600.0;  // more is a broken time
  if (!recording.pupils.empty()) {
    const double length_s = recording.pupils.back().time_s - recording.pupils.front().time_s;
    if (length_s <= kLongestS) return recording;
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: its pupils are {:.0f} h apart; a day is the limit",
                            folder.string(), length_s / 3600.0));
  }
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: has no pupils; expected pupil.pldata of Pupil Capture, or "
                          "pupil_positions.csv in itself or in exports/",
                          folder.string()));
}

}  // namespace conav::gaze
