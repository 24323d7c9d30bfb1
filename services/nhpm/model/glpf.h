#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/msg/planning.h"
#include "common/runtime/result.h"

namespace conav {
class ConfigReader;
}

namespace conav::nhpm {

/// Parameters of the GLPF. The defaults are synthetic: nobody fitted them to people. They are
/// chosen so that a wrong cell next to the camera is nearly always noticed (0.9), one seven cells
/// away half the time, and a picture with nothing wrong in it promises next to no edit.
struct GlpfParameters {
  double alpha_d = 0.1;  // decay of the stimulus per cell of distance
  double alpha_m = 0.5;  // stimulus in the middle of the logistic curve
  double beta = 24.0;    // steepness
  double rho = 1.0e-5;   // guess rate, per cell
  double lambda = 0.1;   // lapse rate
  /// The operator notices only what the picture shows; otherwise also walls of the belief on the
  /// robot's path.
  bool visible_only = false;
  /// One alpha for decay and midpoint (alpha_d), as the paper prints it.
  bool tie_alphas = false;

  void Visit(ConfigReader& reader);
};

/// The grid-based logistic psychometric function: predicts the operator's edits cell by cell.
///
///   stimulus  x(d) = exp(-alpha_d d)   where view or path show that the belief is wrong,
///             x    = 0                 elsewhere
///   P(edit)   P    = rho + (1 - rho - lambda) / (1 + exp(-beta (x - alpha_m)))
///   add            = P (1 - belief)    remove = P belief;   both 0 on the border
///
/// d is the Euclidean distance in cells between the cell and the camera's cell. A belief between 0
/// and 1 is a mixture: with probability `belief` the operator's map has a wall there, which is
/// wrong where the view shows a free cell; otherwise it has none, which is wrong where it shows a
/// wall.
///
/// Source:  paper section 6.1, with alpha (used twice there) split into alpha_d and alpha_m.
/// Errors:  kInvalidArgument, as CheckPerceptionQuery says. Never throws.
/// Threads: safe to call concurrently, has no state. Doubles until the answer is cast to float, so
/// equal queries give equal bits on every machine.
class Glpf final : public PerceptionModel {
 public:
  explicit Glpf(const GlpfParameters& parameters = {});

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  /// Checksum over alpha_d, alpha_m, beta, rho, lambda (as they are used) and visible_only.
  ModelIdentity identity() const override { return identity_; }

  /// P(edit) for a stimulus in [0, 1].
  double Response(double stimulus) const;
  double Stimulus(double distance_cells) const;

  /// Says with which parameters: equal versions give equal answers.
  std::string version() const;

 private:
  PerceptionAnswer Answer(const PerceptionQuery& query) const;

  GlpfParameters parameters_;
  ModelIdentity identity_;
  double unstimulated_ = 0.0;  // Response(0)
};

}  // namespace conav::nhpm
