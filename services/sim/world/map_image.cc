#include "sim/world/map_image.h"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "common/runtime/yaml_file.h"

namespace conav::sim {
namespace {

/// Reads keys of one file; the first problem is kept, later reads give defaults.
class KeyReader {
 public:
  KeyReader(YAML::Node node, std::string file) : node_(std::move(node)), file_(std::move(file)) {}

  template <class T>
  T Read(const char* key, const char* type) {
    if (error_.has_value()) return T{};
    if (!node_[key]) {
      Refuse(ErrorCode::kMalformed, fmt::format("key \"{}\" is missing", key));
      return T{};
    }
    try {
      return node_[key].as<T>();
    } catch (const YAML::Exception&) {
      Refuse(ErrorCode::kMalformed, fmt::format("{} = {} is not {}", key, Text(key), type));
      return T{};
    }
  }

  double ReadNumber(const char* key, double low, double high) {
    const auto value = Read<double>(key, "a number");
    if (!error_.has_value() && !(value >= low && value <= high)) {
      Refuse(ErrorCode::kOutOfRange,
             fmt::format("{} = {} is not in [{}, {}]", key, Text(key), low, high));
    }
    return value;
  }

  bool ReadFlag(const char* key) {
    if (!node_[key]) return false;
    const std::string text = Text(key);
    if (text == "true" || text == "false") return text == "true";
    return ReadNumber(key, 0, 1) != 0.0;
  }

  bool Has(const char* key) const { return static_cast<bool>(node_[key]); }

  void Refuse(ErrorCode code, const std::string& what) {
    if (!error_.has_value()) error_ = Error{code, file_ + ": " + what};
  }

  const std::optional<Error>& error() const { return error_; }

 private:
  std::string Text(const char* key) const { return YAML::Dump(node_[key]); }

  YAML::Node node_;
  std::string file_;
  std::optional<Error> error_;
};

MapHeader ReadKeys(KeyReader& keys, const std::filesystem::path& folder) {
  constexpr double kLargestM = 1e6;
  MapHeader header;
  const std::filesystem::path image = keys.Read<std::string>("image", "a file name");
  header.image = image.is_absolute() ? image : folder / image;
  header.resolution_m = keys.ReadNumber("resolution", 1e-4, 1e3);
  header.origin = keys.Read<std::array<double, 3>>("origin", "three numbers [x, y, yaw]");
  header.negate = keys.ReadFlag("negate");
  header.occupied_threshold = keys.ReadNumber("occupied_thresh", 0.0, 1.0);
  header.free_threshold = keys.ReadNumber("free_thresh", 0.0, 1.0);
  if (keys.Has("mode") && keys.Read<std::string>("mode", "a text") != "trinary") {
    keys.Refuse(ErrorCode::kInvalidArgument, "mode is not \"trinary\", the one that is understood");
  }
  if (header.free_threshold > header.occupied_threshold) {
    keys.Refuse(ErrorCode::kOutOfRange,
                fmt::format("free_thresh {} is larger than occupied_thresh {}",
                            header.free_threshold, header.occupied_threshold));
  }
  for (const double value : header.origin) {
    if (!(std::abs(value) <= kLargestM)) {
      keys.Refuse(ErrorCode::kOutOfRange,
                  fmt::format("origin holds {}: at most {}", value, kLargestM));
    }
  }
  if (header.origin[2] != 0.0) {
    keys.Refuse(ErrorCode::kInvalidArgument,
                fmt::format("origin is turned by {} rad: only 0 is understood", header.origin[2]));
  }
  return header;
}

}  // namespace

Result<MapHeader> ReadMapHeader(const std::filesystem::path& file) {
  const auto node = ReadYamlFile(file);
  if (!node) return tl::unexpected(node.error());
  if (!node->IsMap()) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: is no map_server file: no keys", file.string()));
  }
  KeyReader keys(*node, file.string());
  const MapHeader header = ReadKeys(keys, file.parent_path());
  if (keys.error().has_value()) return tl::unexpected(*keys.error());
  return header;
}

Result<OccupancyGrid> ReadMapImage(const MapHeader& header) {
  const std::string name = header.image.string();
  if (!std::filesystem::is_regular_file(header.image)) {
    return Fail(ErrorCode::kIo, fmt::format("{}: no such image", name));
  }
  cv::Mat image;
  try {
    image = cv::imread(name, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    return Fail(ErrorCode::kIo, fmt::format("{}: {}", name, error.what()));
  }
  if (image.empty()) return Fail(ErrorCode::kIo, fmt::format("{}: is no image", name));
  OccupancyGrid pixels(image.rows, image.cols);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Cell pixel = pixels.CellAt(i);
    const double light = image.at<std::uint8_t>(pixel.row, pixel.column) / 255.0;
    const double p = header.negate ? light : 1.0 - light;
    if (p > header.occupied_threshold) pixels.values()[i] = Occupancy::kOccupied;
    if (p < header.free_threshold) pixels.values()[i] = Occupancy::kFree;
  }
  return pixels;
}

}  // namespace conav::sim
