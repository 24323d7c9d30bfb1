#include "nhpm/evaluation/nelder_mead.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/runtime/demand.h"

namespace conav::nhpm {
namespace {

struct Corner {
  std::vector<double> position;
  double value = 0.0;
};

/// The corners of the simplex, best first.
class Simplex {
 public:
  using Function = std::function<double(std::span<const double>)>;

  Simplex(const Function& function, std::span<const double> start, double step)
      : function_(function) {
    corners_.push_back(At({start.begin(), start.end()}));
    for (std::size_t i = 0; i < start.size(); ++i) {
      std::vector<double> position(start.begin(), start.end());
      position[i] += step;
      corners_.push_back(At(std::move(position)));
    }
    Sort();
  }

  const Corner& best() const { return corners_.front(); }

  bool Converged(double tolerance) const {
    if (!(corners_.back().value - best().value < tolerance)) return false;
    const double reach = std::sqrt(tolerance);
    return std::ranges::all_of(corners_, [&](const Corner& corner) {
      return std::ranges::equal(corner.position, best().position,
                                [&](double a, double b) { return std::abs(a - b) < reach; });
    });
  }

  void Step() {
    Corner& worst = corners_.back();
    const Corner reflected = Along(-1.0);
    if (reflected.value < best().value) {
      const Corner expanded = Along(-2.0);
      worst = expanded.value < reflected.value ? expanded : reflected;
    } else if (reflected.value < corners_[corners_.size() - 2].value) {
      worst = reflected;
    } else {
      const bool outside = reflected.value < worst.value;
      const Corner contracted = Along(outside ? -0.5 : 0.5);
      if (contracted.value < std::min(reflected.value, worst.value)) {
        worst = contracted;
      } else {
        Shrink();
      }
    }
    Sort();
  }

 private:
  Corner At(std::vector<double> position) const {
    const double value = function_(position);
    return {std::move(position),
            std::isnan(value) ? std::numeric_limits<double>::infinity() : value};
  }

  /// On the line from the middle of all other corners (0) to the worst one (1).
  Corner Along(double share) const {
    const std::vector<double>& worst = corners_.back().position;
    std::vector<double> position(worst.size(), 0.0);
    for (std::size_t i = 0; i < worst.size(); ++i) {
      for (std::size_t corner = 0; corner + 1 < corners_.size(); ++corner) {
        position[i] += corners_[corner].position[i] / static_cast<double>(corners_.size() - 1);
      }
      position[i] += share * (worst[i] - position[i]);
    }
    return At(std::move(position));
  }

  void Shrink() {
    for (std::size_t corner = 1; corner < corners_.size(); ++corner) {
      std::vector<double> position = corners_[corner].position;
      for (std::size_t i = 0; i < position.size(); ++i) {
        position[i] = 0.5 * (position[i] + best().position[i]);
      }
      corners_[corner] = At(std::move(position));
    }
  }

  void Sort() {
    std::stable_sort(corners_.begin(), corners_.end(),
                     [](const Corner& a, const Corner& b) { return a.value < b.value; });
  }

  const Function& function_;
  std::vector<Corner> corners_;
};

}  // namespace

NelderMeadResult MinimiseNelderMead(const std::function<double(std::span<const double>)>& function,
                                    std::span<const double> start,
                                    const NelderMeadOptions& options) {
  DEMAND(!start.empty());
  Simplex simplex(function, start, options.first_step);
  NelderMeadResult result;
  while (result.iterations < options.iterations && !result.converged) {
    simplex.Step();
    ++result.iterations;
    result.converged = simplex.Converged(options.tolerance);
  }
  result.position = simplex.best().position;
  result.value = simplex.best().value;
  return result;
}

}  // namespace conav::nhpm
