#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "nhpm/engine/training_pass.h"
#include "nhpm/training/example.h"

namespace conav::nhpm {

/// log(1 + exp(x)), with a relative error below 1e-15, of plain double operations: the same bits on
/// every machine, so that early stopping keeps the same weights everywhere.
double Softplus(double x);

/// Mean binary cross-entropy (MBCE) of one example over ALL its outputs; masked ones cost 0:
///
///   sum over unmasked of (softplus(logit) - y logit)  /  (rows columns kOutputChannels)
///
/// Source: paper Appendix B (BCE, no class weight).
double ExampleLoss(std::span<const float> logits, std::span<const OutputLabel> labels);

/// d ExampleLoss / d logit, times `factor`: factor (sigmoid(logit) - y) / outputs, 0 where masked.
void LossGradient(std::span<const float> logits, std::span<const OutputLabel> labels, float factor,
                  std::span<float> gradient);

/// The rotations and reflections that map a grid to itself: all 8 of the dihedral group D4 for a
/// square, 4 for other rectangles. A turned map is an equally valid example: its person would have
/// made the turned edits.
///
/// Element e: bit 0 mirrors the rows, bit 1 the columns, bit 2 transposes first; 0 is the identity.
/// Source: paper Appendix B, "rotation 0/90/180/270, flip".
class GridSymmetries {
 public:
  GridSymmetries(int rows, int columns);

  int count() const { return count_; }
  /// Transforms all channels and labels alike.
  void Apply(int element, const Example& from, Example& to) const;

 private:
  int count_ = 0;
  /// sources_[element][cell] = the source cell of its values.
  std::array<std::vector<std::uint32_t>, 8> sources_;
};

/// An example and its symmetry.
struct BatchItem {
  const Example* example = nullptr;
  int symmetry = 0;
};

/// Loss and gradient over batches, on several threads.
///
/// The bits do not depend on the number of threads: a batch is cut into kChunks runs of examples.
/// One thread adds up the gradient of a chunk in order; then the chunks are added in order.
class BatchPass {
 public:
  static constexpr int kChunks = 16;

  BatchPass(NetworkShape shape, int rows, int columns, int threads);
  ~BatchPass();

  /// Returns the sum of the items' losses; `gradient` becomes the gradient of their mean.
  double Gradient(const TrainingWeights& weights, std::span<const BatchItem> batch,
                  NetworkWeights& gradient);

  /// The loss of each example.
  std::vector<double> Losses(const TrainingWeights& weights, std::span<const Example> examples);
  /// Their mean. Requires at least one.
  double MeanLoss(const TrainingWeights& weights, std::span<const Example> examples);

 private:
  struct Worker;
  void AddExample(const TrainingWeights& weights, const BatchItem& item, float factor,
                  Worker& worker, NetworkWeights& gradient, double& loss);
  void SumChunks(NetworkWeights& gradient) const;

  GridSymmetries symmetries_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<NetworkWeights> chunk_gradients_;
};

}  // namespace conav::nhpm
