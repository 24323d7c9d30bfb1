#include "nhpm/training/augmentation.h"

#include <algorithm>

#include "common/runtime/demand.h"

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

}  // namespace

GridSymmetries::GridSymmetries(int rows, int columns) : count_(rows == columns ? 8 : 4) {
  for (int element = 0; element < count_; ++element) {
    sources_[static_cast<std::size_t>(element)] = Sources(element, rows, columns);
  }
}

void GridSymmetries::Apply(int element, const Example& from, Example& to) const {
  DEMAND(element >= 0 && element < count_, element, count_);
  const std::vector<std::uint32_t>& sources = sources_[static_cast<std::size_t>(element)];
  Move(sources, from.input, to.input);
  Move(sources, from.labels, to.labels);
}

}  // namespace conav::nhpm
