#include "nhpm/training/augmentation.h"

#include <algorithm>

#include "common/runtime/result.h"

namespace conav::nhpm {
namespace {

constexpr int kMirrorRows = 1;
constexpr int kMirrorColumns = 2;
constexpr int kTranspose = 4;

std::vector<std::uint32_t> Sources(int element, int rows, int columns) {
  std::vector<std::uint32_t> sources;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      int from_row = (element & kTranspose) != 0 ? column : row;
      int from_column = (element & kTranspose) != 0 ? row : column;
      if ((element & kMirrorRows) != 0) from_row = rows - 1 - from_row;
      if ((element & kMirrorColumns) != 0) from_column = columns - 1 - from_column;
      sources.push_back(static_cast<std::uint32_t>(from_row * columns + from_column));
    }
  }
  return sources;
}

template <class T>
void Move(const std::vector<std::uint32_t>& sources, const std::vector<T>& from,
          std::vector<T>& to) {
  const std::size_t channels = from.size() / sources.size();
  to.resize(from.size());
  auto target = to.begin();
  for (const std::uint32_t source : sources) {
    target = std::copy_n(from.data() + source * channels, channels, target);
  }
}

constexpr std::uint64_t kFixedPlacements = 3;  // purpose of a seed

}  // namespace

GridSymmetries::GridSymmetries(int rows, int columns)
    : rows_(rows), columns_(columns), count_(rows == columns ? 8 : 4) {
  for (int element = 0; element < count_; ++element) {
    sources_[static_cast<std::size_t>(element)] = Sources(element, rows, columns);
  }
}

std::uint64_t GridSymmetries::Draw(Random& random) const {
  return static_cast<std::uint64_t>(random.Uniform(0, count_ - 1));
}

void GridSymmetries::Apply(std::uint64_t element, const Example& from, Example& to) const {
  DEMAND(element < static_cast<std::uint64_t>(count_), element, count_);
  const std::vector<std::uint32_t>& sources = sources_[element];
  Move(sources, from.input, to.input);
  Move(sources, from.labels, to.labels);
  to.camera = from.camera;
  to.heading_rad = from.heading_rad;
}

std::uint64_t CanvasAugmentation::FixedVariant(std::size_t index) const {
  return DeriveSeed(kFixedPlacements, index);
}

void CanvasAugmentation::Apply(std::uint64_t seed, const Example& from, Example& to) const {
  Random random(seed);
  const CanvasMap map(DrawPlacement(canvas_, map_rows_, map_columns_, from.camera, random),
                      map_rows_, map_columns_);
  to.camera = map.PixelOf(from.camera);
  to.heading_rad = map.HeadingOf(from.heading_rad);
  const NearnessInView nearness(to.camera, to.heading_rad, kRasterDepthRange);
  const Grid<std::uint8_t> canvas(canvas_, canvas_);
  to.input.assign(canvas.size() * kInputChannels, 0.0F);
  to.labels.assign(canvas.size() * kOutputChannels, OutputLabel::kMasked);
  for (std::size_t pixel = 0; pixel < canvas.size(); ++pixel) {
    float* input = &to.input[pixel * kInputChannels];
    const std::int32_t source = map.sources()[pixel];
    if (source < 0) {
      input[0] = 1.0F;  // a wall, as CanvasMap::Paste has it
      continue;
    }
    const auto cell = static_cast<std::size_t>(source);
    std::copy_n(&from.input[cell * kInputChannels], kInputChannels, input);
    for (int channel = 2; channel < kInputChannels; ++channel) {
      if (input[channel] > 0.0F) input[channel] = nearness.Of(canvas.CellAt(pixel));
    }
    if (canvas.OnBorder(canvas.CellAt(pixel))) continue;
    std::copy_n(&from.labels[cell * kOutputChannels], kOutputChannels,
                &to.labels[pixel * kOutputChannels]);
  }
  to.input[canvas.IndexOf(to.camera) * kInputChannels + 1] = 1.0F;
}

}  // namespace conav::nhpm
