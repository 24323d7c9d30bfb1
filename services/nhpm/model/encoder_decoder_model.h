#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "common/msg/perception_model.h"
#include "nhpm/engine/encoder_decoder.h"
#include "nhpm/model/weights_file.h"

// One user: load_model; why it is apart: the other network has a model of its own.

namespace conav::nhpm {

/// NHPM for rasters of any size: the trained encoder-decoder as a model.
///
/// Input:   EncodeInput with kRasterDepthRange. It learned from maze cells 8 to 12 pixels wide, and
///          paths as wide: a path should hold all pixels that the robot swept, not only a line.
/// Errors:  as PerceptionModel; kOutOfRange when weights, finite as they are, give an answer that is
///          not.
/// Threads: safe to call concurrently; a call computes on its own thread, one query after the other
///          (a batch of 8 is no faster a query), so answers do not depend on the batch. Equal bits
///          on processors with the same instruction set.
class EncoderDecoderModel final : public PerceptionModel {
 public:
  explicit EncoderDecoderModel(const NetworkModel& model);
  ~EncoderDecoderModel() override;

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  /// Costs what the views can reach, about 90 cells around them, but for the first call and one comparison
  /// of each new belief with the one before. Several views in one call are taken for those of the
  /// robot's place: later ones are compared with its path.
  [[nodiscard]] Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                                         std::span<const ShownView> views) override;
  ModelIdentity identity() const override { return identity_; }

 private:
  class Windows;

  std::unique_ptr<EncoderDecoderPass> TakePass(const BeliefGrid& belief);
  void KeepPass(std::unique_ptr<EncoderDecoderPass> pass);
  std::unique_ptr<Windows> TakeWindows(const SharedBelief& belief);
  void KeepWindows(std::unique_ptr<Windows> windows);
  Error NotFinite() const;

  ModelIdentity identity_;
  InputSelection inputs_;
  std::shared_ptr<const NetworkWeights> weights_;
  std::mutex mutex_;  // guards what is kept for the next calls:
  std::vector<std::unique_ptr<EncoderDecoderPass>> idle_;
  std::vector<std::unique_ptr<Windows>> idle_windows_;
};

}  // namespace conav::nhpm
