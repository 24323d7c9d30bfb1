#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "sim/world/world_site.h"

namespace conav::sim {
namespace {

/// The keys of a map_server .yaml file, checked.
struct MapHeader {
  std::filesystem::path image;  // absolute, or relative to the working directory
  double resolution_m = 0.05;
  std::array<double, 3> origin{};  // x, y in metres, yaw (0)
  bool negate = false;
  double occupied_threshold = 0.65;
  double free_threshold = 0.196;
};

/// Reads keys of one file; keeps the first problem, later reads give defaults.
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
    keys.Refuse(ErrorCode::kInvalidArgument, "mode is not \"trinary\", the only supported mode");
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
                fmt::format("origin is turned by {} rad; only 0 is supported", header.origin[2]));
  }
  return header;
}

/// Errors as LoadMapFile.
Result<MapHeader> ReadMapHeader(const std::filesystem::path& file) {
  const auto node = ReadYamlFile(file);
  if (!node) return tl::unexpected(node.error());
  if (!node->IsMap()) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: is not a map_server file: no keys", file.string()));
  }
  KeyReader keys(*node, file.string());
  const MapHeader header = ReadKeys(keys, file.parent_path());
  if (keys.error().has_value()) return tl::unexpected(*keys.error());
  return header;
}

/// Reads numbers of the header of an image; beyond its end they are 0.
struct HeaderReader {
  std::string_view bytes;
  bool big_endian = true;

  std::uint64_t Number(std::uint64_t at, std::size_t size) const {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint64_t place = at + (big_endian ? i : size - 1 - i);
      const auto byte = place < bytes.size() ? static_cast<std::uint8_t>(bytes[place]) : 0U;
      number = number << 8U | byte;
    }
    return number;
  }
};

/// Width times height of the first directory of a TIFF.
std::uint64_t PixelsOfTiff(std::string_view bytes) {
  constexpr std::uint64_t kEntry = 12;
  const HeaderReader reader{bytes, bytes.starts_with("MM")};
  const std::uint64_t directory = reader.Number(4, 4);
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  for (std::uint64_t i = 0; i < reader.Number(directory, 2); ++i) {
    const std::uint64_t entry = directory + 2 + i * kEntry;
    const std::uint64_t value = reader.Number(entry + 8, reader.Number(entry + 2, 2) == 3 ? 2 : 4);
    if (reader.Number(entry, 2) == 256) width = value;
    if (reader.Number(entry, 2) == 257) height = value;
  }
  return width * height;
}

/// "P5 640 480 255", with comments.
std::uint64_t PixelsOfPnm(std::string_view bytes) {
  std::array<std::uint64_t, 2> sides{};
  std::size_t at = 2;
  for (std::uint64_t& side : sides) {
    while (at < bytes.size() &&
           (std::isspace(static_cast<unsigned char>(bytes[at])) != 0 || bytes[at] == '#')) {
      at = bytes[at] == '#' ? std::min(bytes.find('\n', at), bytes.size()) : at + 1;
    }
    const auto [end, error] = std::from_chars(bytes.data() + at, bytes.data() + bytes.size(), side);
    if (error != std::errc() || side > std::numeric_limits<std::uint32_t>::max()) return 0;
    at = static_cast<std::size_t>(end - bytes.data());
  }
  return sides[0] * sides[1];
}

/// How many pixels an image says that it has, before it is decoded. Nothing for other kinds of
/// files, by OpenCV's own signatures: what it takes for DICOM would go to GDCM, which aborts on bad
/// ones.
std::optional<std::uint64_t> PixelsOf(std::string_view bytes) {
  const HeaderReader big{bytes, true};
  const HeaderReader little{bytes, false};
  if (bytes.starts_with("\x89PNG\r\n\x1A\n")) return big.Number(16, 4) * big.Number(20, 4);
  if (bytes.starts_with(std::string_view("II*\0", 4)) ||
      bytes.starts_with(std::string_view("MM\0*", 4))) {
    return PixelsOfTiff(bytes);
  }
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6' &&
      std::isspace(static_cast<unsigned char>(bytes[2])) != 0) {
    return PixelsOfPnm(bytes);
  }
  if (bytes.starts_with("BM")) {
    const auto height = static_cast<std::int32_t>(little.Number(22, 4));  // negative: top row first
    return little.Number(18, 4) * static_cast<std::uint64_t>(std::abs(std::int64_t{height}));
  }
  return std::nullopt;
}

/// Bytes of a pixel of four channels of 16 bits, the largest kind that is decoded.
constexpr std::uint64_t kLargestPixel = 8;

/// As OpenCV's imread. Errors: those of ReadFile; kIo: no image; kRefused: another kind of image, or
/// more pixels than kReadLimit has room for.
Result<cv::Mat> ReadImage(const std::filesystem::path& file, int flags) {
  const std::string name = file.string();
  if (!std::filesystem::is_regular_file(file)) {
    return Fail(ErrorCode::kIo, fmt::format("{}: no such image", name));
  }
  const auto bytes = ReadFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto pixels = PixelsOf(*bytes);
  if (!pixels) {
    return Fail(ErrorCode::kIo,
                fmt::format("{}: is not an image of PNG, PGM (or PPM), BMP or TIFF", name));
  }
  if (*pixels > kReadLimit / kLargestPixel) {
    return Fail(ErrorCode::kRefused, fmt::format("{}: has {} pixels; {} is the limit", name,
                                                 *pixels, kReadLimit / kLargestPixel));
  }
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes->size()), CV_8U,
                          const_cast<char*>(bytes->data()));
    image = cv::imdecode(encoded, flags);
  } catch (const std::exception& error) {  // OpenCV's, and those of decoders that run out of memory
    return Fail(ErrorCode::kIo, fmt::format("{}: {}", name, error.what()));
  }
  if (image.empty()) return Fail(ErrorCode::kIo, fmt::format("{}: is not an image", name));
  return image;
}

/// One value per pixel, row 0 north. Darkness p in [0, 1] (lightness with negate) above
/// occupied_threshold is occupied, below free_threshold free, between them unknown.
Result<OccupancyGrid> ReadMapImage(const MapHeader& header) {
  const Result<cv::Mat> read = ReadImage(header.image, cv::IMREAD_GRAYSCALE);
  if (!read) return tl::unexpected(read.error());
  const cv::Mat& image = *read;
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

struct LoadedMap {
  OccupancyGrid cells;
  MapHeader header;
};

/// How an image becomes cells, from its upper left corner on.
struct Raster {
  int rows = 0;
  int columns = 0;
  double cells_per_pixel = 1.0;

  /// Calls visit(pixel, cell) so that each cell gets all pixels whose middles it holds; one that
  /// holds none gets the pixel that holds its own middle.
  template <class Visit>
  void Each(int pixel_rows, int pixel_columns, Visit&& visit) const {
    const auto scaled = [](int index, double scale, int count) {
      return std::min(count - 1, static_cast<int>(std::floor((index + 0.5) * scale)));
    };
    const bool finer = cells_per_pixel > 1.0;
    const int many_rows = finer ? rows : pixel_rows;
    const int many_columns = finer ? columns : pixel_columns;
    for (int row = 0; row < many_rows; ++row) {
      for (int column = 0; column < many_columns; ++column) {
        const Cell one{row, column};
        if (finer) {
          visit(Cell{scaled(row, 1.0 / cells_per_pixel, pixel_rows),
                     scaled(column, 1.0 / cells_per_pixel, pixel_columns)},
                one);
        } else {
          visit(one,
                Cell{scaled(row, cells_per_pixel, rows), scaled(column, cells_per_pixel, columns)});
        }
      }
    }
  }
};

/// Errors: kOutOfRange (size in cells).
Result<Raster> MakeRaster(const std::string& file, int rows, int columns, double resolution_m,
                          double cell_size_m) {
  Raster raster;
  raster.cells_per_pixel = resolution_m / cell_size_m;
  // A sliver of less than a thousandth of a cell is a rounding error, not a row.
  const auto cells_of = [&](int count) { return std::ceil(count * raster.cells_per_pixel - 1e-3); };
  const double cell_rows = cells_of(rows);
  const double cell_columns = cells_of(columns);
  constexpr int kMinMapSide = 3;
  if (std::min(cell_rows, cell_columns) < kMinMapSide ||
      std::max(cell_rows, cell_columns) > kMaxMapSide) {
    return Fail(
        ErrorCode::kOutOfRange,
        fmt::format("{}: {} x {} pixels of {} m make {} x {} cells of {} m: not in [{}, {}]; "
                    "cell_size_m {:.3g} to {:.3g} would do",
                    file, rows, columns, resolution_m, cell_rows, cell_columns, cell_size_m,
                    kMinMapSide, kMaxMapSide, std::max(rows, columns) * resolution_m / kMaxMapSide,
                    std::min(rows, columns) * resolution_m / kMinMapSide));
  }
  raster.rows = static_cast<int>(cell_rows);
  raster.columns = static_cast<int>(cell_columns);
  return raster;
}

/// Counts each cell's pixels, and those of them that are not free.
OccupancyGrid Resample(const OccupancyGrid& pixels, const Raster& raster, double occupied_share) {
  Grid<int> count(raster.rows, raster.columns, 0);
  Grid<int> not_free(raster.rows, raster.columns, 0);
  raster.Each(pixels.rows(), pixels.columns(), [&](Cell pixel, Cell cell) {
    ++count[cell];
    not_free[cell] += pixels[pixel] == Occupancy::kFree ? 0 : 1;
  });
  OccupancyGrid cells(raster.rows, raster.columns, Occupancy::kFree);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool occupied = not_free.values()[i] > occupied_share * count.values()[i];
    if (occupied || count.values()[i] == 0 || cells.OnBorder(cells.CellAt(i))) {
      cells.values()[i] = Occupancy::kOccupied;
    }
  }
  return cells;
}

Result<LoadedMap> Load(const std::filesystem::path& file, const MapFileOptions& options) {
  Result<MapHeader> header = ReadMapHeader(file);
  if (!header) return tl::unexpected(header.error());
  const Result<OccupancyGrid> pixels = ReadMapImage(*header);
  if (!pixels) return tl::unexpected(pixels.error());
  const Result<Raster> raster = MakeRaster(file.string(), pixels->rows(), pixels->columns(),
                                           header->resolution_m, options.cell_size_m);
  if (!raster) return tl::unexpected(raster.error());
  return LoadedMap{Resample(*pixels, *raster, options.occupied_share), *std::move(header)};
}

bool SameOrigin(const MapHeader& a, const MapHeader& b, double tolerance_m) {
  return std::abs(a.origin[0] - b.origin[0]) <= tolerance_m &&
         std::abs(a.origin[1] - b.origin[1]) <= tolerance_m;
}

}  // namespace

Result<OccupancyGrid> LoadMapFile(const std::filesystem::path& file,
                                  const MapFileOptions& options) {
  return Load(file, options).map([](LoadedMap&& map) { return std::move(map.cells); });
}

Result<MapPair> LoadMapPair(const std::filesystem::path& truth, const std::filesystem::path& plan,
                            const MapFileOptions& options) {
  Result<LoadedMap> truth_map = Load(truth, options);
  if (!truth_map) return tl::unexpected(truth_map.error());
  Result<LoadedMap> plan_map = Load(plan, options);
  if (!plan_map) return tl::unexpected(plan_map.error());
  const OccupancyGrid& a = truth_map->cells;
  const OccupancyGrid& b = plan_map->cells;
  if (a.rows() != b.rows() || a.columns() != b.columns()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has {} x {} cells, {} has {} x {}: must be the same", plan.string(),
                            b.rows(), b.columns(), truth.string(), a.rows(), a.columns()));
  }
  if (!SameOrigin(truth_map->header, plan_map->header, options.cell_size_m / 10.0)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} has its origin at ({}, {}), {} at ({}, {}): must be the same",
                    plan.string(), plan_map->header.origin[0], plan_map->header.origin[1],
                    truth.string(), truth_map->header.origin[0], truth_map->header.origin[1]));
  }
  return MapPair{std::move(truth_map->cells), std::move(plan_map->cells)};
}

namespace {

/// One channel of 8 or 16 bits. Errors as LoadHeightMap.
Result<Grid<float>> ReadHeights(const std::filesystem::path& file) {
  const Result<cv::Mat> read = ReadImage(file, cv::IMREAD_UNCHANGED);
  if (!read) return tl::unexpected(read.error());
  const cv::Mat& image = *read;
  if (image.type() != CV_8UC1 && image.type() != CV_16UC1) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: has {} channels of {} bits{}; a height map has one of 8 or 16 bits",
                    file.string(), image.channels(), 8 * image.elemSize1(),
                    image.depth() >= CV_32F ? " (floating point)" : ""));
  }
  Grid<float> values(image.rows, image.cols);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      values[{row, column}] = image.depth() == CV_8U
                                  ? static_cast<float>(image.at<std::uint8_t>(row, column))
                                  : static_cast<float>(image.at<std::uint16_t>(row, column));
    }
  }
  return values;
}

}  // namespace

Result<HeightMap> LoadHeightMap(const HeightMapOptions& map, const MapFileOptions& options) {
  const std::string name = map.image.string();
  const Result<Grid<float>> values = ReadHeights(map.image);
  if (!values) return tl::unexpected(values.error());
  const auto level = static_cast<float>(map.water_level);
  const auto [lowest, highest] = std::ranges::minmax(values->values());
  if (lowest >= level || highest < level) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: a water level of {} leaves no {}: the pixels are {} to {}", name,
                            map.water_level, lowest >= level ? "water" : "land", lowest, highest));
  }
  const Result<Raster> raster =
      MakeRaster(name, values->rows(), values->columns(), map.resolution_m, options.cell_size_m);
  if (!raster) return tl::unexpected(raster.error());
  OccupancyGrid pixels(values->rows(), values->columns(), Occupancy::kFree);
  Grid<float> sum(raster->rows, raster->columns, 0.0F);
  Grid<int> count(raster->rows, raster->columns, 0);
  const float metres = static_cast<float>(kHighestLandM) / std::max(1.0F, highest - level);
  raster->Each(values->rows(), values->columns(), [&](Cell pixel, Cell cell) {
    if ((*values)[pixel] >= level) pixels[pixel] = Occupancy::kOccupied;
    sum[cell] += ((*values)[pixel] - level) * metres;
    ++count[cell];
  });
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum.values()[i] /= static_cast<float>(std::max(1, count.values()[i]));
  }
  return HeightMap{Resample(pixels, *raster, options.occupied_share), std::move(sum)};
}

}  // namespace conav::sim
