#include "nhpm/model/perception_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nhpm/engine/inference_pass.h"
#include "nhpm/model/encoding.h"

namespace conav::nhpm {
namespace {

/// A query whose belief and path differ from the base's in more cells than this is about something
/// else.
constexpr int kFewCells = 12;

bool AreFinite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(),
                     [](float value) { return std::isfinite(value); });
}

}  // namespace

/// Memory for one caller at a time, with the base that its queries are compared to.
class PerceptionNetwork::Workspace {
 public:
  Workspace(const PerceptionNetwork& network, int rows, int columns)
      : inputs_(network.inputs_),
        pass_(network.weights_, network.kernels_, rows, columns),
        input_(static_cast<std::size_t>(rows * columns) * kInputChannels),
        without_view_(input_.size()),
        newest_(input_.size(), -1.0F) {}

  bool IsFor(const BeliefGrid& belief) const {
    return pass_.rows() == belief.rows() && pass_.columns() == belief.columns();
  }

  std::size_t bytes() const {
    return pass_.bytes() +
           sizeof(float) * (input_.size() + without_view_.size() + base_.size() + newest_.size());
  }

  /// The second query about one belief makes it the base: a single one is cheaper computed whole.
  std::span<const float> Logits(const PerceptionQuery& query) {
    EncodeInput(query, inputs_, input_);
    RemoveView();
    if (pass_.has_base() && AreClose(without_view_, base_)) {
      return pass_.FromBase(input_);
    }
    if (!AreClose(without_view_, newest_)) {
      newest_ = without_view_;
      return pass_.Full(input_);
    }
    base_ = without_view_;
    pass_.SetBase(base_);
    return pass_.FromBase(input_);
  }

 private:
  void RemoveView() {
    for (std::size_t i = 0; i < input_.size(); i += kInputChannels) {
      std::copy_n(&input_[i], 2, &without_view_[i]);  // channels 2 and 3 stay 0
    }
  }

  static bool AreClose(const std::vector<float>& a, const std::vector<float>& b) {
    int different = 0;
    for (std::size_t i = 0; i < a.size(); i += kInputChannels) {
      different += a[i] != b[i] || a[i + 1] != b[i + 1] ? 1 : 0;
    }
    return different <= kFewCells;
  }

  InputSelection inputs_;
  InferencePass pass_;
  std::vector<float> input_;
  std::vector<float> without_view_;
  std::vector<float> base_;
  std::vector<float> newest_;  // that was computed whole
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
    if (workspace_->bytes() > kIdleBytes) return;
    const std::lock_guard lock(network_.mutex_);
    network_.idle_.push_back(std::move(workspace_));
    while (network_.IdleBytesLocked() > kIdleBytes) network_.idle_.erase(network_.idle_.begin());
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

Result<void> PerceptionNetwork::Check(const PerceptionQuery& query) const {
  if (const auto checked = CheckPerceptionQuery(query); !checked) return checked;
  const bool any_size = rows_ == 0 && columns_ == 0;
  if (any_size || (query.belief.rows() == rows_ && query.belief.columns() == columns_)) return {};
  return Fail(
      ErrorCode::kUnavailable,
      fmt::format("belief is {} x {}, but model {} is for {} x {} only", query.belief.rows(),
                  query.belief.columns(), identity_.name, rows_, columns_));
}

Result<std::vector<PerceptionAnswer>> PerceptionNetwork::Predict(
    std::span<const PerceptionQuery> queries) {
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = Check(query); !checked) return tl::unexpected(checked.error());
  }
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (std::size_t i = 0; i < queries.size();) {
    const Lease workspace(*this, queries[i].belief);
    for (; i < queries.size() && workspace->IsFor(queries[i].belief); ++i) {
      const std::span<const float> logits = workspace->Logits(queries[i]);
      if (!AreFinite(logits)) {
        return Fail(ErrorCode::kOutOfRange,
                    fmt::format("model {}: its weights are too large, an answer is not finite",
                                identity_.name));
      }
      answers.push_back(MaskedAnswer(queries[i].belief, logits));
    }
  }
  return answers;
}

}  // namespace conav::nhpm
