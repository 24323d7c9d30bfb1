#pragma once

/// How many robots one operator can serve, and how long they wait: the formulas of the literature.
/// Times in seconds; `neglect_s` (NT) is how long a robot does without the operator,
/// `interaction_s` (IT) how long the operator needs for it.
namespace conav::operators {

/// FO = NT / IT + 1: the robots that one operator keeps going (D. R. Olsen and M. A. Goodrich, "Metrics
/// for evaluating human-robot interactions", PERMIS 2003). 0 when interaction_s is 0: unknown.
double FanOut(double neglect_s, double interaction_s);

/// FO = NT / (IT + WT) + 1 with the waits per interaction, in the queue and for want of situation
/// awareness (M. L. Cummings and P. J. Mitchell, "Predicting controller capacity in supervisory
/// control of multiple UAVs", IEEE Trans. SMC-A 38(2), 2008). 0 when interaction_s is 0.
double FanOutWithWaits(double neglect_s, double interaction_s, double wait_s);

/// What the finite-source queue M/M/1//N predicts: N robots that each ask after an exponential time
/// of mean NT, one operator who needs an exponential time of mean IT (the machine repair model; for
/// example L. Kleinrock, "Queueing Systems" vol. 1, 1975, section 3.8; the operator as its server:
/// Cummings, Nehme and Crandall 2007).
struct FiniteSourcePrediction {
  double idle = 1.0;            // P0: nobody asks
  double utilisation = 0.0;     // 1 - P0
  double time_in_system = 0.0;  // W = N / (mu UT) - 1 / lambda, s
  double waiting_time = 0.0;    // W - 1 / mu, s
  double attended = 0.0;        // N - Lq: mean number of robots that do not wait
};

/// Without robots or without interactions (interaction_s 0) nobody waits. With neglect_s 0 all ask
/// at once.
FiniteSourcePrediction PredictFiniteSource(int robots, double neglect_s, double interaction_s);

}  // namespace conav::operators
