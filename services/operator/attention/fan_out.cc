#include "operator/attention/fan_out.h"

#include <algorithm>

namespace conav::operators {

double FanOut(double neglect_s, double interaction_s) {
  return FanOutWithWaits(neglect_s, interaction_s, 0.0);
}

double FanOutWithWaits(double neglect_s, double interaction_s, double wait_s) {
  return interaction_s > 0.0 ? neglect_s / (interaction_s + wait_s) + 1.0 : 0.0;
}

FiniteSourcePrediction PredictFiniteSource(int robots, double neglect_s, double interaction_s) {
  FiniteSourcePrediction prediction;
  prediction.attended = robots;
  if (robots <= 0 || interaction_s <= 0.0) return prediction;
  // P0 = 1 / sum_n N! / (N - n)! (lambda / mu)^n. Divided by its last term, the sum can neither
  // overflow nor need lambda: with x = mu / lambda it is sum_k x^k / k!, k = N - n, and P0 = x^N /
  // N! over it.
  const double x = neglect_s / interaction_s;
  double term = 1.0;  // x^k / k!
  double sum = 0.0;
  for (int k = 0; k < robots; ++k) {
    sum += term;
    term *= x / (k + 1);
  }
  sum += term;
  prediction.idle = term / sum;
  prediction.utilisation = 1.0 - prediction.idle;
  prediction.time_in_system = robots * interaction_s / prediction.utilisation - neglect_s;
  // One robot waits for nobody: what rounding leaves of that may be below 0.
  prediction.waiting_time = std::max(0.0, prediction.time_in_system - interaction_s);
  const double rate = prediction.utilisation / interaction_s;
  prediction.attended = robots - rate * prediction.waiting_time;
  return prediction;
}

}  // namespace conav::operators
