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
  ModelIdentity identity() const override { return identity_; }

 private:
  std::unique_ptr<EncoderDecoderPass> TakePass(const BeliefGrid& belief);
  void KeepPass(std::unique_ptr<EncoderDecoderPass> pass);

  ModelIdentity identity_;
  InputSelection inputs_;
  std::shared_ptr<const NetworkWeights> weights_;
  std::mutex mutex_;                                       // guards idle_
  std::vector<std::unique_ptr<EncoderDecoderPass>> idle_;  // for the next calls
};

}  // namespace conav::nhpm
