#include "common/service/service_main.h"
#include "operator/simulated/simulated_operator_service.h"

/// conav-simulated-operator: a synthetic person as a client of the operator service.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::operators::SimulatedOperatorConfig,
                               conav::operators::SimulatedOperatorService>(
      "simulated_operator",
      "A synthetic person: looks at the robots' pictures, corrects the map and draws paths, "
      "through the same\nrequests that the console uses.",
      argc, argv);
}
