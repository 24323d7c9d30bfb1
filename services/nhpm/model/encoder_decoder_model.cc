#include "nhpm/model/encoder_decoder_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include "nhpm/model/encoding.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kIdlePasses = 4;

/// An input changes answers 43 cells away at most: 1, 2, 4 or 8 for each of the 13 convolutions at its
/// scale, and 4 + 2 + 1 by upsampling.
constexpr int kReach = 43;
/// A window's layers are those of the whole raster if it begins where all scales do.
constexpr int kScale = 8;
/// Windows have few sizes, so that their passes can be kept.
constexpr int kSizeStep = 32;
constexpr int kLargestArea = 256;
constexpr std::size_t kKeptPasses = 6;  // of one raster

/// Rows or columns [begin, end).
struct Range {
  int begin = 0;
  int end = 0;

  int size() const { return end - begin; }
  bool is_empty() const { return begin >= end; }
  void Add(int i) {
    *this = is_empty() ? Range{i, i + 1} : Range{std::min(begin, i), std::max(end, i + 1)};
  }
  Range Grown(int by, int most) const {
    return {std::max(begin - by, 0), std::min(end + by, most)};
  }
};

struct Area {
  Range rows;
  Range columns;

  void Add(Cell cell) {
    rows.Add(cell.row);
    columns.Add(cell.column);
  }
};

/// What has to be computed so that the answers in `range`, of `most`, are those of the whole raster.
Range WindowFor(Range range, int most) {
  Range window = range.Grown(kReach, most);
  window.begin -= window.begin % kScale;
  const int steps = (window.size() + kSizeStep - 1) / kSizeStep;
  window.end = std::min(window.begin + steps * kSizeStep, most);
  return window;
}

bool Fits(const EncoderDecoderPass& pass, const BeliefGrid& belief) {
  return pass.rows() == belief.rows() && pass.columns() == belief.columns();
}

}  // namespace

/// Expected edits by windows of one raster, for one caller at a time. The base is a belief with a path,
/// without a view; a question differs from it in few cells.
class EncoderDecoderModel::Windows {
 public:
  Windows(const InputSelection& inputs, std::shared_ptr<const NetworkWeights> weights, int rows,
          int columns)
      : inputs_(inputs), weights_(std::move(weights)), rows_(rows), columns_(columns) {}

  bool IsFor(const BeliefGrid& belief) const {
    return rows_ == belief.rows() && columns_ == belief.columns();
  }
  bool Knows(const SharedBelief& belief) const { return belief == belief_; }

  /// The base is `belief` with the path of `view` from now on. False where an answer is not finite: then these windows
  /// are of no more use.
  bool MoveBase(const SharedBelief& belief, const ShownView& view) {
    std::vector<Cell> path = PathOf(view);
    Area changed;
    if (!belief_) {
      changed = {{0, rows_}, {0, columns_}};
      units_.assign(belief->size(), 0);
      input_.assign(belief->size() * kInputChannels, 0.0F);
    }
    for (std::size_t i = 0; i < belief->size(); ++i) {
      const float value = belief->values()[i];
      if (belief_ && belief_->values()[i] == value) continue;
      changed.Add(belief->CellAt(i));
      if (inputs_.belief) input_[i * kInputChannels] = value;
    }
    for (const Change& change : PathChanges(path)) {
      changed.Add(change.cell);
      input_[belief->IndexOf(change.cell) * kInputChannels + change.channel] = change.value;
    }
    belief_ = belief;
    path_ = std::move(path);
    return ForAnswers(changed, {}, [this](Cell cell, const float* logits) {
      const std::int64_t units = UnitsOf(cell, logits);
      all_units_ += units - std::exchange(units_[belief_->IndexOf(cell)], units);
    });
  }

  /// ExpectedEdits() of the answer; nothing where it is not finite. Requires a base of this belief.
  std::optional<double> Edits(const ShownView& view) {
    std::vector<Change> changes = PathChanges(PathOf(view));
    const InputSelection view_only{
        .belief = false, .path = false, .view = inputs_.view, .depth = inputs_.depth};
    EncodeShown(view, view_only, kRasterDepthRange,
                [&](Cell cell, std::size_t channel, float value) {
                  changes.push_back({cell, channel, value});
                });
    Area changed;
    for (const Change& change : changes) changed.Add(change.cell);
    std::int64_t units = all_units_;
    const bool is_finite = ForAnswers(changed, changes, [&](Cell cell, const float* logits) {
      units += UnitsOf(cell, logits) - units_[belief_->IndexOf(cell)];
    });
    return is_finite ? std::optional(EditsOf(units)) : std::nullopt;
  }

 private:
  /// Of the input.
  struct Change {
    Cell cell;
    std::size_t channel;
    float value;
  };

  /// As a set, in order; none if the network does not see it.
  std::vector<Cell> PathOf(const ShownView& view) const {
    if (!inputs_.path) return {};
    std::vector<Cell> path(view.path);
    path.push_back(view.cell);
    std::sort(path.begin(), path.end());
    path.erase(std::unique(path.begin(), path.end()), path.end());
    return path;
  }

  std::vector<Change> PathChanges(const std::vector<Cell>& path) const {
    std::vector<Cell> cells;
    std::ranges::set_symmetric_difference(path, path_, std::back_inserter(cells));
    std::vector<Change> changes;
    for (const Cell cell : cells) {
      const bool is_new = std::ranges::binary_search(path, cell);
      changes.push_back({cell, 1, is_new ? 1.0F : 0.0F});
    }
    return changes;
  }

  std::int64_t UnitsOf(Cell cell, const float* logits) const {
    if (belief_->OnBorder(cell)) return 0;
    const auto [add, remove] = MaskedEdits((*belief_)[cell], logits);
    return EditUnits(add) + EditUnits(remove);
  }

  /// Calls `visit(cell, logits)` for each cell whose answer inputs in `changed` can change, with the
  /// base's input but for `changes`. False, and nothing more, where logits are not finite.
  template <class Visit>
  bool ForAnswers(const Area& changed, std::span<const Change> changes, Visit&& visit) {
    if (changed.rows.is_empty()) return true;
    const Range rows = changed.rows.Grown(kReach, rows_);
    const Range columns = changed.columns.Grown(kReach, columns_);
    for (int row = rows.begin; row < rows.end; row += kLargestArea) {
      for (int column = columns.begin; column < columns.end; column += kLargestArea) {
        const Area part{{row, std::min(row + kLargestArea, rows.end)},
                        {column, std::min(column + kLargestArea, columns.end)}};
        if (!ForAnswersOf(part, changes, visit)) return false;
      }
    }
    return true;
  }

  template <class Visit>
  bool ForAnswersOf(const Area& part, std::span<const Change> changes, Visit&& visit) {
    const Area window{WindowFor(part.rows, rows_), WindowFor(part.columns, columns_)};
    FillInput(window, changes);
    const std::span<const float> logits =
        PassFor(window.rows.size(), window.columns.size()).Forward(window_input_);
    for (int row = part.rows.begin; row < part.rows.end; ++row) {
      const std::size_t first = IndexIn(window, {row, part.columns.begin}) * kOutputChannels;
      const std::span of_row =
          logits.subspan(first, static_cast<std::size_t>(part.columns.size()) * kOutputChannels);
      if (!AreFinite(of_row)) return false;
      for (int column = 0; column < part.columns.size(); ++column) {
        visit(Cell{row, part.columns.begin + column},
              &of_row[static_cast<std::size_t>(column) * kOutputChannels]);
      }
    }
    return true;
  }

  static std::size_t IndexIn(const Area& window, Cell cell) {
    return static_cast<std::size_t>((cell.row - window.rows.begin) * window.columns.size() +
                                    cell.column - window.columns.begin);
  }

  void FillInput(const Area& window, std::span<const Change> changes) {
    const std::size_t row_size = static_cast<std::size_t>(window.columns.size()) * kInputChannels;
    window_input_.resize(static_cast<std::size_t>(window.rows.size()) * row_size);
    for (int row = window.rows.begin; row < window.rows.end; ++row) {
      const Cell first{row, window.columns.begin};
      std::copy_n(&input_[belief_->IndexOf(first) * kInputChannels], row_size,
                  &window_input_[IndexIn(window, first) * kInputChannels]);
    }
    const auto is_in = [](Range range, int i) { return range.begin <= i && i < range.end; };
    for (const Change& change : changes) {
      if (!is_in(window.rows, change.cell.row)) continue;
      if (!is_in(window.columns, change.cell.column)) continue;
      window_input_[IndexIn(window, change.cell) * kInputChannels + change.channel] = change.value;
    }
  }

  EncoderDecoderPass& PassFor(int rows, int columns) {
    const auto fits = [&](const auto& pass) {
      return pass->rows() == rows && pass->columns() == columns;
    };
    const auto kept = std::ranges::find_if(passes_, fits);
    if (kept != passes_.end()) {
      std::rotate(kept, std::next(kept), passes_.end());  // the newest last
      return *passes_.back();
    }
    if (passes_.size() == kKeptPasses) passes_.erase(passes_.begin());
    passes_.push_back(std::make_unique<EncoderDecoderPass>(weights_->shape, rows, columns,
                                                           EncoderDecoderPass::Use::kInference));
    passes_.back()->SetWeights(weights_);
    return *passes_.back();
  }

  InputSelection inputs_;
  std::shared_ptr<const NetworkWeights> weights_;
  int rows_;
  int columns_;
  std::vector<std::unique_ptr<EncoderDecoderPass>> passes_;
  // The base, if there is one:
  SharedBelief belief_;
  std::vector<Cell> path_;           // in order
  std::vector<float> input_;         // [rows][columns][kInputChannels]
  std::vector<std::int64_t> units_;  // EditUnits by cell
  std::int64_t all_units_ = 0;       // their sum
  std::vector<float> window_input_;  // of the newest window
};

EncoderDecoderModel::EncoderDecoderModel(const NetworkModel& model)
    : identity_{model.name, model.version, ChecksumOf(model)},
      inputs_(model.inputs),
      weights_(std::make_shared<const NetworkWeights>(model.weights)) {
  DEMAND(model.weights.shape.architecture == Architecture::kEncoderDecoder, model.name);
}

EncoderDecoderModel::~EncoderDecoderModel() = default;

std::unique_ptr<EncoderDecoderPass> EncoderDecoderModel::TakePass(const BeliefGrid& belief) {
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::ranges::find_if(idle_, [&](const auto& pass) { return Fits(*pass, belief); });
    if (found != idle_.end()) {
      auto pass = std::move(*found);
      idle_.erase(found);
      return pass;
    }
  }
  auto pass = std::make_unique<EncoderDecoderPass>(weights_->shape, belief.rows(), belief.columns(),
                                                   EncoderDecoderPass::Use::kInference);
  pass->SetWeights(weights_);
  return pass;
}

void EncoderDecoderModel::KeepPass(std::unique_ptr<EncoderDecoderPass> pass) {
  const std::lock_guard lock(mutex_);
  if (idle_.size() == kIdlePasses) idle_.erase(idle_.begin());
  idle_.push_back(std::move(pass));
}

Result<std::vector<PerceptionAnswer>> EncoderDecoderModel::Predict(
    std::span<const PerceptionQuery> queries) {
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  std::vector<float> input;
  std::unique_ptr<EncoderDecoderPass> pass;
  for (const PerceptionQuery& query : queries) {
    if (!pass || !Fits(*pass, query.belief)) {
      if (pass) KeepPass(std::move(pass));
      pass = TakePass(query.belief);
    }
    input.resize(query.belief.size() * kInputChannels);
    EncodeInput(query, inputs_, input, kRasterDepthRange);
    const std::span<const float> logits = pass->Forward(input);
    if (!AreFinite(logits)) return tl::unexpected(NotFinite());
    answers.push_back(MaskedAnswer(query.belief, logits));
  }
  if (pass) KeepPass(std::move(pass));
  return answers;
}

std::unique_ptr<EncoderDecoderModel::Windows> EncoderDecoderModel::TakeWindows(
    const SharedBelief& belief) {
  {
    const std::lock_guard lock(mutex_);
    auto found = std::ranges::find_if(idle_windows_,
                                      [&](const auto& windows) { return windows->Knows(belief); });
    if (found == idle_windows_.end()) {
      found = std::ranges::find_if(idle_windows_,
                                   [&](const auto& windows) { return windows->IsFor(*belief); });
    }
    if (found != idle_windows_.end()) {
      auto windows = std::move(*found);
      idle_windows_.erase(found);
      return windows;
    }
  }
  return std::make_unique<Windows>(inputs_, weights_, belief->rows(), belief->columns());
}

void EncoderDecoderModel::KeepWindows(std::unique_ptr<Windows> windows) {
  const std::lock_guard lock(mutex_);
  if (idle_windows_.size() == kIdlePasses) idle_windows_.erase(idle_windows_.begin());
  idle_windows_.push_back(std::move(windows));
}

Error EncoderDecoderModel::NotFinite() const {
  return {
      ErrorCode::kOutOfRange,
      fmt::format("model {}: its weights are too large, an answer is not finite", identity_.name)};
}

Result<std::vector<double>> EncoderDecoderModel::PredictEdits(const SharedBelief& belief,
                                                              std::span<const ShownView> views) {
  for (const ShownView& view : views) {
    if (const auto checked = CheckShownView(*belief, view); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  std::unique_ptr<Windows> windows = TakeWindows(belief);
  if (!windows->Knows(belief)) {
    if (const auto checked = CheckBelief(*belief); !checked) return tl::unexpected(checked.error());
  }
  std::vector<double> edits;
  if (!windows->Knows(belief) || views.size() > 1) {
    if (views.empty()) return edits;
    if (!windows->MoveBase(belief, views.front())) return tl::unexpected(NotFinite());
  }
  for (const ShownView& view : views) {
    const auto of_view = windows->Edits(view);
    if (!of_view) return tl::unexpected(NotFinite());
    edits.push_back(*of_view);
  }
  KeepWindows(std::move(windows));
  return edits;
}

}  // namespace conav::nhpm
