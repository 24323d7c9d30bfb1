#include "nhpm/model/perception_network.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <optional>

#include "nhpm/engine/inference_pass.h"
#include "nhpm/model/encoding.h"

namespace conav::nhpm {
namespace {

/// A query whose belief and path differ from the base's in more cells than this is about something
/// else.
constexpr std::size_t kFewCells = 12;

}  // namespace

/// Memory for one caller at a time, with the base that its questions are compared to: a belief and a
/// path, without a view.
class PerceptionNetwork::Workspace {
 public:
  Workspace(PerceptionNetwork& network, int rows, int columns)
      : whole_passes_(network.whole_passes_),
        inputs_(network.inputs_),
        pass_(network.weights_, network.kernels_, rows, columns),
        input_(static_cast<std::size_t>(rows * columns) * kInputChannels) {}

  bool IsFor(const BeliefGrid& belief) const {
    return pass_.rows() == belief.rows() && pass_.columns() == belief.columns();
  }

  /// Whether the base is of this very belief.
  bool Knows(const SharedBelief& belief) const { return belief == belief_; }

  std::size_t bytes() const {
    const std::size_t floats = input_.size() + (belief_ ? belief_->size() : 0) + newest_.size();
    return pass_.bytes() + sizeof(float) * floats + sizeof(std::int64_t) * units_.size();
  }

  /// The second query about one belief makes it the base: a single one is cheaper computed whole.
  std::span<const float> Logits(const PerceptionQuery& query) {
    ReadPath(query);
    if (!pass_.has_base() || !IsNearBase(query.belief)) {
      if (!AreClose(query.belief.values(), newest_)) return Whole(query);
      SetBase(std::make_shared<const BeliefGrid>(query.belief));
    }
    ChangeBelief(query.belief);
    ChangePath();
    ChangeView(query);
    pass_.FromBase();
    return pass_.Logits();
  }

  /// ExpectedEdits() of the answer; nothing where it is not finite.
  std::optional<double> Edits(const SharedBelief& belief, const ShownView& view) {
    ReadPath(view);
    MoveBase(belief);
    ChangePath();
    ChangeView(view);
    std::int64_t units = all_units_;
    for (const InferencePass::Computed& cell : pass_.FromBase()) {
      if (!AreFinite({cell.logits, kOutputChannels})) return std::nullopt;
      units += UnitsOf(cell) - units_[belief_->IndexOf({cell.row, cell.column})];
    }
    return is_finite_ ? std::optional(EditsOf(units)) : std::nullopt;
  }

 private:
  /// The path of a question as a set, in order.
  template <class Shown>
  void ReadPath(const Shown& shown) {
    path_.assign(shown.path.begin(), shown.path.end());
    path_.push_back(shown.cell);
    std::sort(path_.begin(), path_.end());
    path_.erase(std::unique(path_.begin(), path_.end()), path_.end());
    path_changes_.clear();
    std::set_symmetric_difference(path_.begin(), path_.end(), base_path_.begin(), base_path_.end(),
                                  std::back_inserter(path_changes_));
  }

  static bool AreClose(std::span<const float> a, std::span<const float> b) {
    if (a.size() != b.size()) return false;
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i] ? 1 : 0;
    return different <= kFewCells;
  }
  bool IsNearBase(const BeliefGrid& belief) const {
    return path_changes_.size() <= kFewCells && AreClose(belief.values(), belief_->values());
  }

  std::span<const float> Whole(const PerceptionQuery& query) {
    const auto values = query.belief.values();
    newest_.assign(values.begin(), values.end());
    EncodeInput(query, inputs_, input_);
    ++whole_passes_;
    return pass_.Full(input_);
  }

  /// Computes `belief` with the newest path in full.
  void SetBase(const SharedBelief& belief) {
    belief_ = belief;
    EncodeInput({.belief = *belief, .path = path_, .cell = path_.front()}, inputs_, input_);
    ++whole_passes_;
    pass_.SetBase(input_);
    KeepPath();
    units_.clear();
  }
  void KeepPath() {
    base_path_ = path_;
    path_changes_.clear();
  }

  /// The base holds `belief`, and nearly the newest path.
  void MoveBase(const SharedBelief& belief) {
    if (!pass_.has_base()) SetBase(belief);
    if (belief == belief_ && path_changes_.size() <= kFewCells) return CountUnits();
    const bool has_other_masks = !inputs_.belief && *belief != *belief_;
    ChangeBelief(*belief);
    ChangePath();
    belief_ = belief;
    KeepPath();
    const auto moved = pass_.MoveBase();
    if (has_other_masks) units_.clear();
    if (units_.empty()) return CountUnits();
    for (const InferencePass::Computed& cell : moved) {
      is_finite_ = is_finite_ && AreFinite({cell.logits, kOutputChannels});
      std::int64_t& units = units_[belief_->IndexOf({cell.row, cell.column})];
      all_units_ += UnitsOf(cell) - units;
      units = UnitsOf(cell);
    }
  }

  /// Of all of the base, unless that was done.
  void CountUnits() {
    if (!units_.empty()) return;
    pass_.FromBase();
    const std::span<const float> logits = pass_.Logits();
    is_finite_ = AreFinite(logits);
    units_.resize(belief_->size());
    all_units_ = 0;
    for (std::size_t i = 0; i < units_.size(); ++i) {
      const Cell cell = belief_->CellAt(i);
      units_[i] = UnitsOf({cell.row, cell.column, &logits[i * kOutputChannels]});
      all_units_ += units_[i];
    }
  }

  std::int64_t UnitsOf(const InferencePass::Computed& computed) const {
    const Cell cell{computed.row, computed.column};
    if (belief_->OnBorder(cell)) return 0;
    const auto [add, remove] = MaskedEdits((*belief_)[cell], computed.logits);
    return EditUnits(add) + EditUnits(remove);
  }

  void ChangeBelief(const BeliefGrid& belief) {
    if (!inputs_.belief) return;
    const auto now = belief.values();
    const auto before = belief_->values();
    auto at = now.begin();
    for (;;) {
      at = std::mismatch(at, now.end(), before.begin() + (at - now.begin())).first;
      if (at == now.end()) return;
      const Cell cell = belief.CellAt(static_cast<std::size_t>(at - now.begin()));
      pass_.Change(cell.row, cell.column, 0, *at++);
    }
  }

  void ChangePath() {
    if (!inputs_.path) return;
    for (const Cell cell : path_changes_) {
      const bool is_new = std::binary_search(path_.begin(), path_.end(), cell);
      pass_.Change(cell.row, cell.column, 1, is_new ? 1.0F : 0.0F);
    }
  }

  template <class Shown>
  void ChangeView(const Shown& shown) {
    const InputSelection view_only{
        .belief = false, .path = false, .view = inputs_.view, .depth = inputs_.depth};
    EncodeShown(shown, view_only, kMazeDepthRange,
                [&](Cell cell, std::size_t channel, float value) {
                  pass_.Change(cell.row, cell.column, static_cast<int>(channel), value);
                });
  }

  std::atomic<std::uint64_t>& whole_passes_;  // of the network
  InputSelection inputs_;
  InferencePass pass_;
  std::vector<float> input_;
  SharedBelief belief_;              // of the base
  std::vector<Cell> base_path_;      // as path_
  std::vector<std::int64_t> units_;  // EditUnits of the base by cell; empty until they are needed
  std::int64_t all_units_ = 0;       // their sum
  bool is_finite_ = true;            // the base's logits
  std::vector<Cell> path_;           // of the question
  std::vector<Cell> path_changes_;   // in one of path_ and base_path_
  std::vector<float> newest_;        // belief that was computed whole
};

/// A workspace taken from the idle ones, and given back.
class PerceptionNetwork::Lease {
 public:
  Lease(PerceptionNetwork& network, const BeliefGrid& belief) : network_(network) {
    {
      const std::lock_guard lock(network_.mutex_);
      auto& idle = network_.idle_;
      const auto found = std::find_if(idle.rbegin(), idle.rend(),
                                      [&](const auto& one) { return one->IsFor(belief); });
      if (found != idle.rend()) {
        workspace_ = std::move(*found);
        idle.erase(std::next(found).base());
        return;
      }
    }
    workspace_ = std::make_unique<Workspace>(network_, belief.rows(), belief.columns());
  }
  ~Lease() {
    const std::lock_guard lock(network_.mutex_);
    auto& idle = network_.idle_;
    idle.push_back(std::move(workspace_));
    while (idle.size() > 1 && network_.IdleBytesLocked() > kIdleBytes) idle.erase(idle.begin());
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

  Workspace& operator*() const { return *workspace_; }
  Workspace* operator->() const { return workspace_.get(); }

 private:
  PerceptionNetwork& network_;
  std::unique_ptr<Workspace> workspace_;
};

PerceptionNetwork::PerceptionNetwork(const NetworkModel& model)
    : PerceptionNetwork(model, AvailableInstructionSets().front()) {}

PerceptionNetwork::PerceptionNetwork(const NetworkModel& model, InstructionSet set)
    : identity_{model.name, model.version, ChecksumOf(model)},
      inputs_(model.inputs),
      rows_(model.rows),
      columns_(model.columns),
      kernels_(KernelsFor(model.weights.shape.width, set)),
      weights_(
          std::make_shared<const PackedWeights>(model.weights, PackedWeights::Use::kInference)) {}

PerceptionNetwork::~PerceptionNetwork() = default;

std::size_t PerceptionNetwork::idle_bytes() const {
  const std::lock_guard lock(mutex_);
  return IdleBytesLocked();
}

std::size_t PerceptionNetwork::IdleBytesLocked() const {
  return std::transform_reduce(idle_.begin(), idle_.end(), std::size_t{0}, std::plus<>(),
                               [](const auto& workspace) { return workspace->bytes(); });
}

Result<void> PerceptionNetwork::CheckSize(const BeliefGrid& belief) const {
  const bool any_size = rows_ == 0 && columns_ == 0;
  if (any_size || (belief.rows() == rows_ && belief.columns() == columns_)) return {};
  return Fail(ErrorCode::kUnavailable,
              fmt::format("belief is {} x {}, but model {} is for {} x {} only", belief.rows(),
                          belief.columns(), identity_.name, rows_, columns_));
}

Error PerceptionNetwork::NotFinite() const {
  return {
      ErrorCode::kOutOfRange,
      fmt::format("model {}: its weights are too large, an answer is not finite", identity_.name)};
}

Result<std::vector<PerceptionAnswer>> PerceptionNetwork::Predict(
    std::span<const PerceptionQuery> queries) {
  for (const PerceptionQuery& query : queries) {
    const auto checked =
        CheckPerceptionQuery(query).and_then([&] { return CheckSize(query.belief); });
    if (!checked) return tl::unexpected(checked.error());
  }
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (std::size_t i = 0; i < queries.size();) {
    const Lease workspace(*this, queries[i].belief);
    for (; i < queries.size() && workspace->IsFor(queries[i].belief); ++i) {
      const std::span<const float> logits = workspace->Logits(queries[i]);
      if (!AreFinite(logits)) return tl::unexpected(NotFinite());
      answers.push_back(MaskedAnswer(queries[i].belief, logits));
    }
  }
  return answers;
}

Result<std::vector<double>> PerceptionNetwork::PredictEdits(const SharedBelief& belief,
                                                            std::span<const ShownView> views) {
  if (const auto checked = CheckSize(*belief); !checked) return tl::unexpected(checked.error());
  for (const ShownView& view : views) {
    if (const auto checked = CheckShownView(*belief, view); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  const Lease workspace(*this, *belief);
  if (!workspace->Knows(belief)) {
    if (const auto checked = CheckBelief(*belief); !checked) return tl::unexpected(checked.error());
  }
  std::vector<double> edits;
  for (const ShownView& view : views) {
    const auto of_view = workspace->Edits(belief, view);
    if (!of_view) return tl::unexpected(NotFinite());
    edits.push_back(*of_view);
  }
  return edits;
}

}  // namespace conav::nhpm
